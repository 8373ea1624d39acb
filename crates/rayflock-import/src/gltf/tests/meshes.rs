//! Vertices, triangles and what is wrong with accessors.

use glam::Vec3;
use serde_json::{Value, json};

use super::document::{Document, assert_has};
use crate::tests::{fixed_mesh, load_bytes};

#[test]
fn a_triangle_without_indices_loads_from_gltf_and_glb() {
    let document = Document::triangle();
    for loaded in [document.load(), load_bytes("a.glb", &document.glb())] {
        let (scene, warnings) = loaded.unwrap();
        assert_eq!(fixed_mesh(&scene, 0).mesh.corners(0), [Vec3::ZERO, Vec3::X, Vec3::Y]);
        assert!(warnings.is_empty() && scene.materials.len() == 1);
        assert_eq!(scene.objects[0].name, "body");
    }
}

#[test]
fn strips_turn_every_other_triangle_and_fans_go_around() {
    let mut document = Document::triangle();
    let indices = document.column("SCALAR", 5121, 5, &[0, 1, 2, 0, 1]);
    document.primitive()["indices"] = json!(indices);
    for (mode, expected) in
        [(5, [[0, 1, 2], [1, 0, 2], [2, 0, 1]]), (6, [[1, 2, 0], [2, 0, 0], [0, 1, 0]])]
    {
        document.primitive()["mode"] = json!(mode);
        let (scene, _) = document.load().unwrap();
        assert_eq!(fixed_mesh(&scene, 0).mesh.triangles(), expected, "mode {mode}");
    }
    document.primitive()["mode"] = json!(1);
    let (scene, warnings) = document.load().unwrap();
    assert!(scene.objects.is_empty() && warnings[0].contains("not drawn"), "{warnings:?}");
}

#[test]
fn accessors_are_checked_before_they_are_read() {
    let cases: [(&str, Value, &[&str]); 9] = [
        ("/accessors/0/count", json!(4), &["POSITION accessor 0", "4 elements", "36 bytes"]),
        ("/accessors/0/count", json!(u64::MAX), &["accessor 0"]),
        ("/accessors/0/byteOffset", json!(u64::MAX), &["accessor 0"]),
        ("/accessors/0/type", json!("VEC2"), &["mesh 0 \"body\" primitive 0", "found Vec2"]),
        ("/accessors/0/componentType", json!(5123), &["found Vec3 of U16", "of [F32]"]),
        ("/bufferViews/0/byteStride", json!(4), &["a stride of 4", "at least 12"]),
        ("/bufferViews/0/byteLength", json!(1_000_000), &["buffer view 0", "36 bytes"]),
        ("/bufferViews/0/byteOffset", json!(u64::MAX), &["buffer view 0"]),
        ("/bufferViews/0/buffer", json!(3), &["bufferViews[0].buffer", "out of range"]),
    ];
    for (pointer, value, expected) in cases {
        let mut document = Document::triangle();
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        document.json.pointer_mut(parent).unwrap()[key] = value;
        assert_has(&document.message(), expected);
    }
    // The crate's own validation would index out of bounds here.
    let mut document = Document::triangle();
    document.primitive()["attributes"]["POSITION"] = json!(99);
    assert_has(&document.message(), &["POSITION", "found accessor 99", "one of 1 accessors"]);
    let mut document = Document::triangle();
    let indices = document.column("SCALAR", 5125, 3, &[0, 0, 0, 0, 1, 0, 0, 0, 3, 0, 0, 0]);
    document.primitive()["indices"] = json!(indices);
    assert_has(&document.message(), &["triangle 0 names vertex 3", "3 vertices"]);
}

#[test]
fn bytes_cannot_be_read_over_and_over_without_end() {
    let mut document = Document::triangle();
    let many = document.column("VEC3", 5126, 100_000, &vec![0; 1_200_000]);
    let primitive = json!({ "attributes": { "POSITION": many } });
    let bounds = json!([0, 0, 0]);
    document.json["accessors"][many]["min"] = bounds.clone();
    document.json["accessors"][many]["max"] = bounds;
    document.json["meshes"] = json!([{ "primitives": vec![primitive; 100] }]);
    assert_has(&document.message(), &["mesh 0 primitive", "over and over"]);
}

#[test]
fn sparse_accessors_replace_elements() {
    let mut document = Document::triangle();
    document.column("SCALAR", 5121, 1, &[1]);
    document.floats("VEC3", 1, &[9.0, 8.0, 7.0]);
    document.json["accessors"][0]["sparse"] = json!({ "count": 1, "indices": { "bufferView": 1, "componentType": 5121 },
                "values": { "bufferView": 2 } });
    let (scene, _) = document.load().unwrap();
    let expected = [Vec3::ZERO, Vec3::new(9.0, 8.0, 7.0), Vec3::Y];
    assert_eq!(fixed_mesh(&scene, 0).mesh.vertices(), expected);

    document.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    let (scene, _) = document.load().unwrap();
    assert_eq!(fixed_mesh(&scene, 0).mesh.vertices()[2], Vec3::ZERO);

    document.json["accessors"][0]["count"] = json!(1_000_000_000_000_u64);
    assert_has(&document.message(), &["1000000000000 elements without a buffer view"]);
    document.json["accessors"][0]["count"] = json!(1);
    assert_has(&document.message(), &["a sparse index of 1", "less than the count of 1"]);
    document.json["accessors"][0]["sparse"]["count"] = json!(77);
    assert_has(&document.message(), &["77 elements"]);
}
