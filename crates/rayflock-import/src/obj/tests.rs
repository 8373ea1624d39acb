//! Tests on tiny files.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use rayflock_scene::{Fresnel, MaterialIdx, PrimMaterials};

use crate::tests::{fixed_mesh, load_bytes, load_files};
use crate::texture::tests::png;

const QUAD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn polygons_become_fans_and_negative_indices_count_back() {
    let text = format!("{QUAD}f 1 2 3 4\nf -4 -3 -2\n");
    let (scene, warnings) = load_bytes("a.obj", text.as_bytes()).unwrap();
    assert_eq!(fixed_mesh(&scene, 0).mesh.triangles(), [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    assert!(warnings.is_empty() && scene.materials.len() == 1);
    assert_eq!(scene.objects[0].name, "a");
}

#[test]
fn vertices_keep_the_order_of_the_file_and_seams_come_last() {
    let text = format!(
        "{QUAD}v 9 9 9\nvt 0 0\nvt 1 0.25\nvn 0 0 2\nf 4/1/1 3/1/1 2/1/1\nf 4/2/1 2/1/1 1/1/1\n"
    );
    let (scene, _) = load_bytes("a.obj", text.as_bytes()).unwrap();
    let mesh = fixed_mesh(&scene, 0);
    assert_eq!(mesh.mesh.vertices(), [Vec3::ZERO, Vec3::X, Vec3::ONE - Vec3::Z, Vec3::Y, Vec3::Y]);
    assert_eq!(mesh.mesh.triangles(), [[3, 2, 1], [4, 1, 0]]);
    assert_eq!(*mesh.normals, [Vec3::Z; 5]);
    // Flipped, as our origin is at the top left.
    assert_eq!(mesh.attributes.uvs[3..], [Vec2::new(0.0, 1.0), Vec2::new(1.0, 0.75)]);
}

#[test]
fn files_of_one_topology_have_one_vertex_order() {
    let faces = "f 1/1 2/2 3/3\nf 3/1 2/2 1/3\n";
    let uvs = "vt 0 0\nvt 1 0\nvt 1 1\n";
    let shape = |positions: &str| {
        let text = format!("{positions}{uvs}{faces}");
        let (scene, _) = load_bytes("a.obj", text.as_bytes()).unwrap();
        Arc::clone(&fixed_mesh(&scene, 0).mesh)
    };
    let neutral = shape("v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    // Two positions fall together here, which must not weld them.
    let other = shape("v 0 0 0\nv 0 0 0\nv 0 1 5\n");
    assert_eq!(neutral.triangles(), other.triangles());
    assert_eq!(neutral.vertices().len(), other.vertices().len());
}

#[test]
fn groups_are_objects_and_faces_have_their_materials() {
    let mtl = "newmtl red\nKd 1 0 0\nnewmtl glass\nillum 7\nNi 1.4\nKd 0 0 0\nTf 1 1 0.5\n\
        newmtl chrome\nKd 0.1\nKs 0.9 0.9 0.9\nNs 90\nillum 3\nnewmtl lamp\nKe 5 5 5\nd 0.25\n";
    let obj = format!(
        "mtllib a.mtl\n{QUAD}g one\nusemtl red\nf 1 2 3\nusemtl glass\nf 1 3 4\ng two\n\
         usemtl chrome\nf 1 2 3\ng one\nusemtl lamp\nf 1 2 4\n"
    );
    let files = [("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())];
    let (scene, warnings) = load_files("a.obj", &files).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    let names: Vec<_> = scene.objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["one", "two"]);
    let expected = PrimMaterials::PerPrim([0, 1, 3].map(MaterialIdx).to_vec());
    assert_eq!(fixed_mesh(&scene, 0).attributes.materials, expected);
    let [red, glass, chrome, lamp] = scene.materials.as_slice() else { panic!("four") };
    assert_eq!(red.diffuse, Vec3::X);
    assert_eq!((glass.fresnel, glass.ior), (Fresnel::Dielectric, 1.4));
    assert_eq!(glass.transmission, Vec3::new(1.0, 1.0, 0.5));
    assert_eq!((chrome.mirror, chrome.shininess), (Vec3::splat(0.9), 90.0));
    assert_eq!(chrome.diffuse, Vec3::splat(0.1));
    assert_eq!((lamp.emission, lamp.transmission), (Vec3::splat(5.0), Vec3::splat(0.75)));
}

#[test]
fn textures_load_and_missing_ones_are_warnings() {
    let mtl = "newmtl a\nmap_Kd -s 1 1 1 -clamp on pic.png\nnewmtl b\nmap_Kd gone.png\n\
        newmtl c\nmap_Kd ../pic.png\nKd 1 1\n";
    let obj =
        format!("mtllib a.mtl\n{QUAD}usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3");
    let picture = png(1, 1, [255; 3]);
    let files: [(&str, &[u8]); 3] =
        [("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes()), ("pic.png", &picture)];
    let (scene, warnings) = load_files("a.obj", &files).unwrap();
    assert_eq!(scene.textures.len(), 1);
    assert!(scene.materials[0].diffuse_texture.is_some());
    assert_eq!(warnings.len(), 3, "{warnings:?}");
    assert!(warnings[0].contains("a.mtl line 7") && warnings[1].contains("gone.png"));
    assert!(warnings[2].contains("leads out"));
}

#[test]
fn a_damaged_mtl_does_not_drown_other_warnings() {
    let mtl = format!("newmtl a\n{}", "Kd x\n".repeat(30));
    let obj = format!("mtllib a.mtl\n{QUAD}usemtl a\nf 1 2 3\n");
    let files = [("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())];
    let (_, warnings) = load_files("a.obj", &files).unwrap();
    assert_eq!(warnings.len(), 9);
    assert!(warnings[8].contains("22 more statements are not understood"), "{}", warnings[8]);
}

#[test]
fn a_missing_mtl_is_one_warning() {
    let obj = format!("mtllib a.mtl\n{QUAD}usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3");
    let (scene, warnings) = load_bytes("a.obj", obj.as_bytes()).unwrap();
    assert_eq!((scene.materials.len(), warnings.len()), (2, 1), "{warnings:?}");
    assert!(warnings[0].contains("a.mtl"));
}

#[test]
fn vertex_colors_and_a_fourth_coordinate_are_told_apart() {
    let text = "v 0 0 0 0.5\nv 1 0 0 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let (scene, _) = load_bytes("a.obj", text.as_bytes()).unwrap();
    let mesh = fixed_mesh(&scene, 0);
    assert_eq!(mesh.attributes.colors, [Vec3::ONE, Vec3::X, Vec3::ONE]);
    assert_eq!(mesh.mesh.vertices()[0], Vec3::ZERO);
}

#[test]
fn damage_names_its_line() {
    let cases = [
        ("v 1 2\n", "line 1"),
        ("v 1 2 x\n", "line 1"),
        ("v 0 0 0\nf 1 1 2\n", "line 2: found v 2, expected at most 1"),
        ("v 0 0 0\n\nf 1 1 0\n", "line 3"),
        ("v 0 0 0\nf 1 1 -2\n", "line 2"),
        ("v 0 0 0\nf 1/1 1/1 1/1\n", "line 2: found vt 1"),
        ("v 0 0 0\nf 1//9 1//1 1//1\n", "line 2: found vn 9"),
        ("v 0 0 0\nf 1/1/1/1 1 1\n", "line 2"),
        ("v 0 0 0\nf 99999999999999999999 1 1\n", "line 2"),
        ("v 0 0 0\nf 4294967295 1 1\n", "line 2"),
        ("hello world\n", "found only hello"),
        ("v 0 0 0\0", "zero byte"),
    ];
    for (text, expected) in cases {
        let message = load_bytes("a.obj", text.as_bytes()).unwrap_err().to_string();
        assert!(message.contains(expected), "{text:?}: {message}");
    }
}

#[test]
fn faces_may_come_before_vertices_and_files_may_be_empty() {
    let (scene, _) = load_bytes("a.obj", format!("f 1 2 3\n{QUAD}").as_bytes()).unwrap();
    assert_eq!(scene.objects.len(), 1);
    for text in ["", "# nothing\n", "o a\n"] {
        let (scene, warnings) = load_bytes("a.obj", text.as_bytes()).unwrap();
        assert!(scene.objects.is_empty() && warnings.is_empty());
    }
    let (_, warnings) =
        load_bytes("a.obj", format!("{QUAD}l 1 2\nf 1 2\nvp 1\n").as_bytes()).unwrap();
    assert_eq!(warnings.len(), 4, "{warnings:?}");
}
