//! Nodes, scenes, and the files that a document consists of.

use std::sync::Arc;

use glam::Vec3;
use rayflock_scene::LocalTransform;
use serde_json::json;

use super::document::{Document, assert_has};
use crate::tests::{fixed_mesh, load_bytes, load_files};

#[test]
fn nodes_with_one_mesh_share_it_and_other_scenes_stay_out() {
    let mut document = Document::triangle();
    document.json["nodes"] = json!([
        { "children": [1], "translation": [1, 2, 3] },
        { "mesh": 0, "name": "left", "rotation": [0, 0, 0, 2] },
        { "mesh": 0, "matrix": [2,0,0,0, 0,2,0,0, 0,0,2,0, 5,0,0,1] },
        { "mesh": 0 },
    ]);
    document.json["scenes"] = json!([{ "nodes": [0, 2] }, { "nodes": [3] }]);
    let (scene, _) = document.load().unwrap();
    assert_eq!((scene.objects.len(), scene.nodes.len()), (2, 4));
    assert!(Arc::ptr_eq(&fixed_mesh(&scene, 0).mesh, &fixed_mesh(&scene, 1).mesh));
    assert_eq!(scene.objects[0].name, "left");
    assert_eq!(scene.nodes[1].parent.unwrap().0, 0);
    let turned = LocalTransform::IDENTITY;
    assert_eq!(scene.nodes[1].rest, turned, "rotations get unit length");
    assert_eq!(scene.nodes[2].rest.to_affine().transform_point3(Vec3::X), Vec3::new(7.0, 0.0, 0.0));
}

#[test]
fn node_graphs_must_be_trees() {
    let mut document = Document::triangle();
    let cases = [
        (json!([{ "children": [1] }, { "children": [0] }]), "own ancestor"),
        (json!([{ "children": [0] }]), "own ancestor"),
        (json!([{ "children": [1] }, { "children": [2] }, { "children": [1] }]), "node 1"),
        (json!([{ "children": [2] }, { "children": [2] }, {}]), "at most one parent"),
        (json!([{ "children": [9] }]), "out of range"),
        // Where serde_json reads numbers to the last bit, it refuses this one before we do.
        (json!([{ "translation": [1e39, 0, 0] }]), "number out of range"),
    ];
    for (nodes, expected) in cases {
        document.json["nodes"] = nodes;
        assert_has(&document.message(), &[expected]);
    }
}

#[test]
fn buffers_come_from_the_folder_only() {
    let mut document = Document::triangle();
    let buffer = document.buffer.clone();
    document.json["buffers"] = json!([{ "byteLength": 36, "uri": "the%20data.bin" }]);
    let text = document.text();
    let files: [(&str, &[u8]); 2] = [("a.gltf", text.as_bytes()), ("the data.bin", &buffer)];
    assert!(load_files("a.gltf", &files).is_ok());
    assert_has(&document.message(), &["buffer 0", "the data.bin", "cannot be read"]);
    for uri in ["../b.bin", "/b.bin", "http://a/b.bin", "data:;base64,%", "data:x", "%2e%2e/b"] {
        document.json["buffers"] = json!([{ "byteLength": 36, "uri": uri }]);
        assert_has(&document.message(), &["buffer 0: found"]);
    }
    document.json["buffers"] = json!([{ "byteLength": 37, "uri": "the data.bin" }]);
    let text = document.text();
    let files: [(&str, &[u8]); 2] = [("a.gltf", text.as_bytes()), ("the data.bin", &buffer)];
    assert_has(&load_files("a.gltf", &files).unwrap_err().to_string(), &["36 bytes", "37"]);
    document.json["buffers"] = json!([{ "byteLength": 36 }]);
    assert_has(&document.message(), &["neither a URI nor a binary chunk"]);
}

#[test]
fn glb_headers_are_checked() {
    let whole = Document::triangle().glb();
    for cut in [0, 4, 11, 12, 19, 20, 100, whole.len() - 1] {
        assert!(load_bytes("a.glb", &whole[..cut]).is_err(), "{cut}");
    }
    for length in [0, 11, u32::MAX] {
        let mut bytes = whole.clone();
        bytes[8..12].copy_from_slice(&length.to_le_bytes());
        assert_has(&load_bytes("a.glb", &bytes).unwrap_err().to_string(), &["GLB header"]);
    }
    for (at, length) in [(12, u32::MAX), (12, 3)] {
        let mut bytes = whole.clone();
        bytes[at..at + 4].copy_from_slice(&length.to_le_bytes());
        assert!(load_bytes("a.glb", &bytes).is_err());
    }
    let mut tail = whole;
    tail.extend([1, 2, 3]);
    assert_has(&load_bytes("a.glb", &tail).unwrap().1[0], &["3 bytes follow"]);
}

#[test]
fn versions_and_required_extensions_that_are_not_read_are_errors() {
    let mut document = Document::triangle();
    document.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    assert_has(&document.message(), &["KHR_draco_mesh_compression", "not supported"]);
    let mut document = Document::triangle();
    document.json["asset"]["version"] = json!("1.0");
    assert_has(&document.message(), &["version \"1.0\"", "version 2.0"]);
    assert_has(&load_bytes("a.gltf", b"{}").unwrap_err().to_string(), &["JSON", "asset"]);
}
