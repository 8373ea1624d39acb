//! Materials, lights and the view.

use std::f32::consts::PI;

use glam::Vec3;
use rayflock_scene::{Background, Falloff, Fresnel, LightKind, Projection};

use super::{load, load_with_warnings, message};
use crate::tests::load_files;
use crate::texture::linear;

const TRIANGLE: &str = "p 3 0 0 0 1 0 0 0 1 0";
const VIEW: &str = "v from 1 2 3 at 1 2 -7 up 0 1 0 angle 40 hither 1 resolution 800 600\n";

#[test]
fn fills_become_materials() {
    let scene = load(&format!(
        "fm 0.1 0.2 0.3  0.4 0.5 0.6  0.7 0.8 0.9  20 0.25 1.5 {TRIANGLE}\n\
         f 1 0.5 0  0.5 0.25 300 0 0 {TRIANGLE}\n"
    ));
    let [extended, plain] = scene.materials.as_slice() else { panic!("two materials") };
    let shade = |r, g, b| Vec3::new(r, g, b).map(linear);
    assert_eq!(extended.ambient, shade(0.1, 0.2, 0.3));
    assert_eq!(extended.diffuse, shade(0.4, 0.5, 0.6));
    assert_eq!((extended.specular, extended.mirror), (shade(0.7, 0.8, 0.9), extended.specular));
    assert_eq!((extended.shininess, extended.ior), (80.0, 1.5));
    assert_eq!(
        (extended.transmission, extended.fresnel),
        (shade(0.25, 0.25, 0.25), Fresnel::Constant)
    );
    assert_eq!((plain.ambient, plain.diffuse), (Vec3::ZERO, shade(0.5, 0.25, 0.0)));
    assert_eq!((plain.specular, plain.mirror), (extended.transmission, plain.specular));
    assert_eq!((plain.shininess, plain.transmission, plain.ior), (1000.0, Vec3::ZERO, 1.0));
}

#[test]
fn shapes_before_any_fill_are_white_and_equal_fills_are_one() {
    let fill = "f 1 0 0 1 0 1 0 0";
    let scene = load(&format!("{TRIANGLE} {fill} {TRIANGLE} f 0 1 0 1 0 1 0 0 {fill} {TRIANGLE}"));
    assert_eq!(scene.materials.len(), 2);
    assert_eq!(scene.materials[0].diffuse, Vec3::ONE);
}

#[test]
fn lights_keep_their_intensity_and_are_white_without_a_colour() {
    let text = format!("l 1 2 3\nl 4 5 6 0.5 0.25 1\nla lamp 7 8 9 b 0 0 0 {TRIANGLE}");
    let (scene, warnings) = load_with_warnings(&text);
    assert!(warnings.len() == 1 && warnings[0].contains("no keys for lamp"), "{warnings:?}");
    let kinds: Vec<LightKind> = scene.lights.iter().map(|light| light.kind).collect();
    let point = |position, color: Vec3| LightKind::Point {
        position,
        intensity: PI * color,
        falloff: Falloff::Constant,
    };
    assert_eq!(kinds[0], point(Vec3::new(1.0, 2.0, 3.0), Vec3::ONE));
    assert_eq!(kinds[1], point(Vec3::new(4.0, 5.0, 6.0), Vec3::new(0.5, 0.25, 1.0)));
    assert_eq!(kinds[2], point(Vec3::ZERO, Vec3::ONE));
    assert_eq!(scene.lights[2].name, "lamp");
}

#[test]
fn the_rest_of_the_world_is_black_and_ambient_light_is_white() {
    let scene = load(TRIANGLE);
    assert_eq!(scene.background, Some(Background::Uniform(Vec3::ZERO)));
    assert_eq!(scene.ambient, Vec3::ONE);
    let scene = load(&format!("b 0.1 0.2 0.3 am 2 2 1 {TRIANGLE}"));
    assert_eq!(scene.background, Some(Background::Uniform(Vec3::new(0.1, 0.2, 0.3).map(linear))));
    assert_eq!(scene.ambient, Vec3::new(2.0, 2.0, 1.0));
}

#[test]
fn the_view_is_a_camera() {
    let scene = load(&format!("{VIEW}{TRIANGLE}"));
    let camera = &scene.cameras[0];
    let place = camera.node_from_camera;
    assert_eq!(Vec3::from(place.translation), Vec3::new(1.0, 2.0, 3.0));
    assert!(place.transform_vector3(Vec3::NEG_Z).abs_diff_eq(Vec3::NEG_Z, 1e-6));
    assert!(place.transform_vector3(Vec3::Y).abs_diff_eq(Vec3::Y, 1e-6));
    let vertical_fov = 40.0_f32.to_radians();
    assert_eq!(camera.projection, Projection::Perspective { vertical_fov });
    assert!(camera.node.is_none() && scene.frame_count.is_none());
}

#[test]
fn ppm_textures_are_read_with_their_top_row_first() {
    let ppm = b"P6 1 2 255\n\xff\xff\xff\x00\x00\x00";
    let text = format!("tt a.ppm 0 0 0 0 1  1 0 0 1 1  0 1 0 0 0\n{TRIANGLE}");
    let files: [(&str, &[u8]); 2] = [("a.aff", text.as_bytes()), ("a.ppm", ppm)];
    let (scene, warnings) = load_files("a.aff", &files).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!(scene.textures[0].texels[..], [[1.0; 3], [0.0; 3]]);
    let textured = |idx: usize| scene.materials[idx].diffuse_texture.is_some();
    assert!(scene.materials.len() == 2 && textured(0) && !textured(1));
}

#[test]
fn wrong_views_fills_and_lights_name_their_line() {
    let cases = [
        (VIEW.replace("40", "180"), "line 1: found a view with an angle of 180, expected an angle"),
        (VIEW.replace("-7", "3"), "expected two places, and an upward direction"),
        (VIEW.replace("up 0 1 0", "up 0 0 1"), "expected two places, and an upward direction"),
        (VIEW.replace("angle", "fov"), "found \"fov\", expected \"angle\" for \"v\" of line 1"),
        ("\nfm 1 1 1 1 1 1 1 1 1 1 1\n".into(), "line 3: found the end of the file"),
        ("l 1 2".into(), "found the end of the file, expected a finite number for \"l\""),
        ("l 1 2 3 0.5 b 1 1 1".into(), "found \"b\", expected a finite number for \"l\""),
        ("a 0 -1 5".into(), "found an animation from 0 to -1, expected an end after the start"),
        ("a 0 1 0".into(), "found an animation of 0 frames, expected at least one"),
        ("a 0 1 2.5".into(), "found \"2.5\", expected a whole number"),
    ];
    for (text, expected) in cases {
        let message = message(&text);
        assert!(message.contains(expected), "{text:?}: {message}");
    }
}

#[test]
fn unknown_commands_are_left_out_and_counted() {
    let text = format!("t old.ppm\nzoom 3 {{\n{TRIANGLE} 7 8\nzoom 4\n");
    let (scene, warnings) = load_with_warnings(&text);
    assert_eq!((scene.objects.len(), warnings.len()), (1, 2), "{warnings:?}");
    assert!(warnings[0].contains("3 are not known (t, zoom)"), "{warnings:?}");
    assert!(warnings[1].contains("2 belong to no command"), "{warnings:?}");
    let message = message("hello world\n");
    assert_eq!(message, "text: found only hello, expected commands such as v or p");
    assert!(super::message("1 2 3").contains("found only numbers"));
    assert!(super::message("v\0").contains("zero byte at offset 1"));
}

#[test]
fn small_polygons_are_ignored_and_empty_files_are_empty_scenes() {
    let (scene, warnings) = load_with_warnings(&format!("p 2 0 0 0 1 0 0 pp 0 {TRIANGLE}"));
    assert_eq!(scene.objects.len(), 1);
    assert!(warnings.len() == 1 && warnings[0].contains("2 have fewer"), "{warnings:?}");
    for text in ["", "# nothing\n", "% nothing"] {
        let (scene, warnings) = load_with_warnings(text);
        assert!(scene.objects.is_empty() && warnings.len() == 1, "{warnings:?}");
    }
}
