//! Keys of blocks, lights and the camera, and animated triangles.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use rayflock_geom::ObjectChange;
use rayflock_scene::{Evaluator, LightKind, MotionKind, SceneFrame};

use super::{load, load_with_warnings, message};

const TRIANGLE: &str = "p 3 0 0 0 1 0 0 0 1 0";
const VIEW: &str = "v from 0 0 5 at 0 0 0 up 0 1 0 angle 40 hither 1 resolution 800 600\n";
/// Slides along X: at 10 + t for times from 10 to 12.
const SLIDE: &str = "transl 5\n9 -1 0 0 0 0 0\n10 0 0 0 0 0 0\n11 1 0 0 0 0 0\n12 2 0 0 0 0 0\n\
    13 3 0 0 0 0 0\n";

fn evaluator(text: &str) -> Evaluator {
    Evaluator::new(Arc::new(load(text)), None).unwrap()
}

fn frame(text: &str, time: f64) -> SceneFrame {
    evaluator(text).evaluate(time).cloned().unwrap()
}

#[test]
fn frames_go_from_the_start_to_the_end_of_the_interval() {
    let scene = load(&format!("a 10 12 5 x car {{ {TRIANGLE} }} k car {{ {SLIDE} }}"));
    assert_eq!((scene.frame_count, scene.frame_rate), (Some(5), Some(2.0)));
    let mut evaluator = Evaluator::new(Arc::new(scene), None).unwrap();
    assert_eq!(evaluator.time_range(), (0.0, 2.0));
    assert_eq!(evaluator.motion_kinds(), [MotionKind::Rigid]);
    let mut x = |frame: u32| {
        let frame = evaluator.evaluate(f64::from(frame) / 2.0).unwrap();
        frame.geometry.bounds().min.x
    };
    assert_eq!([0, 1, 2, 3, 4].map(&mut x), [0.0, 0.5, 1.0, 1.5, 2.0]);
    // There is no loop: behind the last frame, everything rests.
    assert_eq!(x(9), 2.0);
    let single = load(&format!("a 3 3 1 {TRIANGLE}"));
    assert_eq!((single.frame_count, single.frame_rate), (Some(1), None));
}

#[test]
fn keys_may_come_first_and_blocks_may_nest() {
    let turn = "rot 4  0 0 0 1 90 0 0 0  1 0 0 2 90 0 0 0  2 0 0 1 90 0 0 0  3 0 0 1 90 0 0 0";
    let grow = "scale 4  0 2 2 2 0 0 0  1 2 2 2 0 0 0  2 2 2 2 0 0 0  3 2 2 2 0 0 0";
    let text = format!(
        "k turn {{ {turn} }} k grow {{ {grow} }} a 0 4 5\n\
         xs 1 1 1 0 0 1 0 0 0 3 {{ x turn {{ xs 1 1 1 0 0 1 0 1 0 0 {{ x grow {{ {TRIANGLE} }} }}\n\
         {TRIANGLE} }} }}"
    );
    let frame = frame(&text, 0.5);
    let corner = |idx: usize, corner: Vec3| {
        frame.geometry.objects()[idx].world_from_object.unwrap().transform_point3(corner)
    };
    // Twice as large, one to the right, then turned upward, then forward.
    assert!(corner(0, Vec3::X).abs_diff_eq(Vec3::new(0.0, 3.0, 3.0), 1e-5));
    assert!(corner(1, Vec3::X).abs_diff_eq(Vec3::new(0.0, 1.0, 3.0), 1e-5));
}

#[test]
fn the_camera_and_lights_follow_their_keys() {
    let turn = "rot 4  9 0 1 0 90 0 0 0  10 0 1 0 90 0 0 0  12 0 1 0 90 0 0 0  13 0 1 0 90 0 0 0";
    let text = format!(
        "{VIEW}a 10 12 3 la lamp 7 7 7 1 1 1 k lamp {{ {SLIDE} }} {TRIANGLE}\n\
         k camera {{ {SLIDE} {turn} }}"
    );
    let frame = frame(&text, 2.0);
    let camera: Affine3A = frame.cameras[0];
    assert_eq!(Vec3::from(camera.translation), 2.0 * Vec3::X);
    assert!(camera.transform_vector3(Vec3::NEG_Z).abs_diff_eq(Vec3::NEG_X, 1e-6));
    let LightKind::Point { position, .. } = frame.lights[0] else { panic!("a point light") };
    assert_eq!(position, 2.0 * Vec3::X);
}

#[test]
fn a_camera_that_only_slides_goes_on_looking() {
    let frame = frame(&format!("{VIEW}a 10 12 3 {TRIANGLE} k camera {{ {SLIDE} }}"), 1.0);
    let camera = frame.cameras[0];
    assert_eq!(Vec3::from(camera.translation), Vec3::X);
    assert!(camera.transform_vector3(Vec3::NEG_Z).abs_diff_eq(Vec3::NEG_Z, 1e-6));
}

#[test]
fn visibility_keys_hide_a_block() {
    let text = format!(
        "a 0 4 5 x a {{ x b {{ {TRIANGLE} }} }} k a {{ visibility 2  1 0  3 1 }}\n\
         k b {{ visibility 1  3.5 0 }}"
    );
    let mut evaluator = evaluator(&text);
    assert_eq!(evaluator.motion_kinds(), [MotionKind::Topology]);
    let mut count = |time| evaluator.evaluate(time).unwrap().geometry.prim_count();
    assert_eq!([-9.0, 0.5, 1.0, 2.9, 3.0, 3.5, 9.0].map(&mut count), [1, 1, 0, 0, 1, 0, 0]);
}

#[test]
fn animated_triangles_go_straight_and_rest_at_their_ends() {
    let key = |time: f64, x: f64| format!("{time} {x} 0 0 0 0 2  {x} 1 0 0 0 1  {x} 0 1 0 0 1 ");
    let far = key(11.0, 5.0);
    let text = format!(
        "a 10 14 5 xs 2 2 2 0 0 0 0 0 0 0 {{ tpa 2 {}{far} tpa 2 {}{far} tpa 1 {far} }}",
        key(10.0, 1.0),
        key(10.0, 3.0)
    );
    let mut evaluator = evaluator(&text);
    assert_eq!(evaluator.scene().objects.len(), 2);
    let mut x = |time| {
        let frame = evaluator.evaluate(time).unwrap();
        let vertices = frame.geometry.objects()[0].shape.vertices();
        (vertices[0].x, vertices[3].x)
    };
    assert_eq!(x(-1.0), (2.0, 6.0));
    assert_eq!(x(0.5), (6.0, 8.0));
    assert_eq!(x(3.0), (10.0, 10.0));
    let frame = evaluator.evaluate(0.5).unwrap();
    let changes: Vec<ObjectChange> = frame.changes.iter().map(|(_, change)| change).collect();
    assert_eq!(changes, [ObjectChange::Deformed, ObjectChange::Unchanged]);
    assert_eq!(frame.surfaces[0].normals[0], Vec3::Z);
}

#[test]
fn names_that_meet_nothing_are_warnings() {
    let text = format!(
        "a 10 12 3 x car {{ {TRIANGLE} }} k bus {{ visibility 0 }} k bus {{ {SLIDE} }}\n\
         k bus {{ {SLIDE} }}"
    );
    let (scene, warnings) = load_with_warnings(&text);
    assert_eq!((scene.clips.len(), warnings.len()), (0, 3), "{warnings:?}");
    assert!(warnings[0].contains("keys for \"bus\" already"), "{warnings:?}");
    assert!(warnings[1].contains("the keys for bus move nothing"), "{warnings:?}");
    assert!(warnings[2].contains("no keys for car"), "{warnings:?}");
    let (scene, warnings) =
        load_with_warnings(&format!("x car {{ {TRIANGLE} }} k car {{ {SLIDE} }}"));
    assert!(scene.frame_count.is_none() && scene.clips.len() == 1);
    assert!(warnings.len() == 1 && warnings[0].contains("motion repeats"), "{warnings:?}");
}

#[test]
fn keys_that_go_back_in_time_are_left_out() {
    let text = "a 0 4 5 x a { s 0 0 0 1 } k a { visibility 4  1 0  3 1  2 0  3.5 0\n\
        transl 6 0 0 0 0 0 0 0  1 1 0 0 0 0 0  0.5 9 9 9 0 0 0  2 2 0 0 0 0 0  3 3 0 0 0 0 0\n\
        4 4 0 0 0 0 0 }";
    let (scene, warnings) = load_with_warnings(text);
    assert!(warnings.len() == 1 && warnings[0].contains("2 keys of \"a\" go back"), "{warnings:?}");
    let mut evaluator = Evaluator::new(Arc::new(scene), None).unwrap();
    let mut bounds = |time| evaluator.evaluate(time).unwrap().geometry.bounds();
    assert!((bounds(3.0).max.x - 4.0).abs() < 1e-6 && bounds(2.0).is_empty());
}

#[test]
fn wrong_keys_name_their_line() {
    let cases = [
        ("k a\nx", "line 2: found \"x\", expected \"{\" for \"k\" of line 1"),
        ("k a { jump 1 }", "found \"jump\", expected \"transl\", \"rot\", "),
        ("k a { transl 3 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 }", "found a spline of 3 keys"),
        ("k a { transl 9999 0", "found 9999 keys, expected at most 0"),
        ("k a { visibility 1 5 1", "found the end of the file, expected \"transl\""),
        ("k a { visibility 1 5 }", "found \"}\", expected a finite number"),
        ("tpa 99 0", "found 99 keys, expected at most 0"),
        ("x {", "found \"{\", expected the name of a transform"),
        ("x a b", "found \"b\", expected \"{\" for \"x\""),
        ("x a {\n\n", "line 1: found a block without an end, expected a \"}\" in the same file"),
        ("s 0 0 0 1 }", "line 1: found \"}\", expected a block that it ends"),
        ("xs 1 1 1 0 0 1 90 0 0 {", "found \"{\", expected a finite number for \"xs\""),
    ];
    for (text, expected) in cases {
        let message = message(text);
        assert!(message.contains(expected), "{text:?}: {message}");
    }
    let key = "0 0 0 0 0 0 1 0 1 0 0 0 1 0 0 1 0 0 1 ";
    let message = message(&format!("tpa 2 {key}{key}"));
    assert!(message.contains("a key at 0 after one at 0, expected times that increase"));
}
