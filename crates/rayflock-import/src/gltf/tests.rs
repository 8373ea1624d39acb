//! Tests on tiny documents, put together from JSON and a buffer.

use std::sync::Arc;

use base64::Engine;
use glam::{Quat, Vec2, Vec3};
use rayflock_scene::{
    ChannelValues, Fresnel, Interpolation, LightKind, LocalTransform, Projection, Scene, Shape,
};
use serde_json::{Value, json};

use crate::ImportError;
use crate::tests::{fixed_mesh, load_bytes, load_files};
use crate::texture::tests::png;

type Loaded = Result<(Scene, Vec<String>), ImportError>;

/// A document under construction; each column gets its own buffer view and accessor.
struct Document {
    json: Value,
    buffer: Vec<u8>,
}

impl Document {
    /// Without anything in it.
    fn new() -> Self {
        let json = json!({
            "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }],
            "nodes": [{ "mesh": 0 }], "meshes": [], "accessors": [], "bufferViews": [],
        });
        Self { json, buffer: Vec::new() }
    }

    /// With one triangle: accessor 0 holds its positions.
    fn triangle() -> Self {
        let mut document = Self::new();
        document.floats("VEC3", 3, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        document.json["accessors"][0]["min"] = json!([0, 0, 0]);
        document.json["accessors"][0]["max"] = json!([1, 1, 0]);
        document.json["meshes"] = json!([{
            "name": "body", "primitives": [{ "attributes": { "POSITION": 0 } }],
        }]);
        document
    }

    /// Adds an accessor and gives its index.
    fn column(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        let view =
            json!({ "buffer": 0, "byteOffset": self.buffer.len(), "byteLength": bytes.len() });
        self.buffer.extend(bytes);
        self.buffer.resize(self.buffer.len().next_multiple_of(4), 0);
        let views = self.json["bufferViews"].as_array_mut().unwrap();
        views.push(view);
        let view = views.len() - 1;
        let accessors = self.json["accessors"].as_array_mut().unwrap();
        accessors.push(json!({
            "bufferView": view, "componentType": component, "count": count, "type": kind,
        }));
        accessors.len() - 1
    }

    fn floats(&mut self, kind: &str, count: usize, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.column(kind, 5126, count, &bytes)
    }

    fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    fn material(mut self, material: &Value) -> Self {
        self.json["materials"] = json!([material]);
        self.primitive()["material"] = json!(0);
        self
    }

    /// The document with its buffer inside.
    fn text(&self) -> String {
        let mut json = self.json.clone();
        if json.get("buffers").is_none() {
            let data = base64::engine::general_purpose::STANDARD.encode(&self.buffer);
            let uri = format!("data:application/octet-stream;base64,{data}");
            json["buffers"] = json!([{ "byteLength": self.buffer.len(), "uri": uri }]);
        }
        json.to_string()
    }

    fn load(&self) -> Loaded {
        load_bytes("a.gltf", self.text().as_bytes())
    }

    /// Loads what must not load; gives the message.
    fn message(&self) -> String {
        self.load().unwrap_err().to_string()
    }

    fn glb(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"] = json!([{ "byteLength": self.buffer.len() }]);
        let mut json = json.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut bytes = b"glTF\x02\0\0\0".to_vec();
        bytes.extend((28 + json.len() as u32 + self.buffer.len() as u32).to_le_bytes());
        bytes.extend((json.len() as u32).to_le_bytes());
        bytes.extend(b"JSON");
        bytes.extend(json);
        bytes.extend((self.buffer.len() as u32).to_le_bytes());
        bytes.extend(b"BIN\0");
        bytes.extend(&self.buffer);
        bytes
    }
}

fn assert_has(message: &str, parts: &[&str]) {
    assert!(parts.iter().all(|part| message.contains(part)), "{message}\nlacks one of {parts:?}");
}

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
        (json!([{ "translation": [1e39, 0, 0] }]), "not finite"),
    ];
    for (nodes, expected) in cases {
        document.json["nodes"] = nodes;
        assert_has(&document.message(), &[expected]);
    }
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

/// A triangle whose vertices follow two joints, nodes 1 and 2.
fn skinned(joints: [u8; 12], weights: [f32; 12]) -> Document {
    let mut document = Document::triangle();
    let joints = document.column("VEC4", 5121, 3, &joints);
    let weights = document.floats("VEC4", 3, &weights);
    document.primitive()["attributes"]["JOINTS_0"] = json!(joints);
    document.primitive()["attributes"]["WEIGHTS_0"] = json!(weights);
    document.json["nodes"] = json!([{ "mesh": 0, "skin": 0 }, {}, {}]);
    document.json["skins"] = json!([{ "joints": [1, 2] }]);
    document
}

#[test]
fn skins_bind_vertices_to_joints() {
    let joints = [0, 1, 0, 0, 1, 0, 0, 0, 1, 77, 0, 0];
    let weights = [1.0, 3.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let (scene, warnings) = skinned(joints, weights).load().unwrap();
    let Shape::Deformed { skin: Some(skin), .. } = &scene.objects[0].shape else {
        panic!("skinned")
    };
    assert_eq!(skin.joints.len(), 2);
    assert_eq!(skin.influences[0].weights[..2], [0.25, 0.75]);
    assert_eq!(skin.influences[0].joints[..2], [0, 1]);
    assert_eq!((skin.influences[2].joints[0], skin.influences[2].weights[0]), (0, 1.0));
    assert!(warnings.len() == 1 && warnings[0].contains("1 vertices follow no joint"));
}

#[test]
fn wrong_skins_are_errors() {
    let weights = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    let document = skinned([0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0], weights);
    assert_has(&document.message(), &["vertex 1", "found joint 2", "2 joints of skin 0"]);
    for bad in [f32::NAN, -1.0, f32::INFINITY] {
        let mut weights = weights;
        weights[5] = bad;
        assert_has(&skinned([0; 12], weights).message(), &["WEIGHTS vertex 1"]);
    }
    let mut document = skinned([0; 12], weights);
    let one = document.floats("MAT4", 1, &[1.0; 16]);
    document.json["skins"][0]["inverseBindMatrices"] = json!(one);
    assert_has(&document.message(), &["skin 0 inverseBindMatrices", "1 matrices", "2 joints"]);
    let nan = document.floats("MAT4", 2, &[f32::NAN; 32]);
    document.json["skins"][0]["inverseBindMatrices"] = json!(nan);
    assert_has(&document.message(), &["matrix 0", "finite"]);
}

#[test]
fn morph_targets_and_their_weights_load() {
    let mut document = Document::triangle();
    let offsets = document.floats("VEC3", 3, &[0.5; 9]);
    document.primitive()["targets"] = json!([{ "POSITION": offsets }, { "NORMAL": offsets }]);
    document.json["meshes"][0]["weights"] = json!([0.25]);
    let times = document.floats("SCALAR", 2, &[0.0, 1.0]);
    let weights = document.floats("SCALAR", 4, &[0.0, 1.0, 1.0, 0.0]);
    document.json["animations"] = json!([{
        "samplers": [{ "input": times, "output": weights }],
        "channels": [{ "sampler": 0, "target": { "node": 0, "path": "weights" } }],
    }]);
    let (scene, _) = document.load().unwrap();
    let Shape::Deformed { targets, skin: None, .. } = &scene.objects[0].shape else {
        panic!("morphed")
    };
    assert_eq!(targets[0].positions, [Vec3::splat(0.5); 3]);
    assert!(targets[1].normals.is_empty(), "the mesh at rest has no normals to change");
    assert_eq!(scene.nodes[0].rest_weights, [0.25, 0.0]);
    let ChannelValues::Weights { weights_per_key, values } = &scene.clips[0].channels[0].values
    else {
        panic!("weights")
    };
    assert_eq!((*weights_per_key, values.len()), (2, 4));
    assert_eq!(scene.clips[0].name, "clip0");

    document.json["accessors"][offsets]["count"] = json!(2);
    assert_has(&document.message(), &["target 0 POSITION", "a count of 2", "a count of 3"]);
}

/// A clip that turns node 0 with these keys.
fn turning(times: &[f32], rotations: &[f32], interpolation: &str) -> Document {
    let mut document = Document::triangle();
    let input = document.floats("SCALAR", times.len(), times);
    let output = document.floats("VEC4", rotations.len() / 4, rotations);
    document.json["animations"] = json!([{
        "name": "turn",
        "samplers": [{ "input": input, "output": output, "interpolation": interpolation }],
        "channels": [{ "sampler": 0, "target": { "node": 0, "path": "rotation" } }],
    }]);
    document
}

#[test]
fn clips_keep_order_unit_rotations_and_interpolation() {
    let keys = [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let (scene, warnings) = turning(&[0.0, 1.0, 1.0], &keys, "STEP").load().unwrap();
    let channel = &scene.clips[0].channels[0];
    assert_eq!(
        (channel.times.as_slice(), channel.interpolation),
        (&[0.0, 1.0][..], Interpolation::Step)
    );
    let expected = [Quat::IDENTITY, Quat::from_xyzw(0.0, 0.0, 1.0, 0.0)];
    assert_eq!(channel.values, ChannelValues::Rotation(expected.to_vec()));
    assert!(warnings.len() == 1 && warnings[0].contains("1 keys"), "{warnings:?}");

    let (scene, _) = turning(&[0.5], &keys, "CUBICSPLINE").load().unwrap();
    let ChannelValues::Rotation(values) = &scene.clips[0].channels[0].values else {
        panic!("rotations")
    };
    assert_eq!(values[0].w, 2.0, "tangents stay as they are");
    assert_eq!((values[1].z, scene.clips[0].duration()), (1.0, 0.5));
}

#[test]
fn wrong_clips_are_errors_or_left_out() {
    let still = [0.0, 0.0, 0.0, 1.0];
    assert_has(&turning(&[0.0, 1.0], &still, "LINEAR").message(), &["a count of 1", "of 2"]);
    assert_has(&turning(&[f32::NAN], &still, "LINEAR").message(), &["the time NaN"]);
    assert_has(&turning(&[0.0], &[0.0; 4], "LINEAR").message(), &["unit length"]);
    assert_has(&turning(&[0.0], &[f32::NAN; 4], "LINEAR").message(), &["not finite"]);
    assert_has(&turning(&[0.0], &still, "WRONG").message(), &["interpolation"]);
    for (key, value) in [("path", json!("colour")), ("node", json!(9))] {
        let mut document = turning(&[0.0], &still, "LINEAR");
        document.json["animations"][0]["channels"][0]["target"][key] = value;
        match document.load() {
            Ok((scene, warnings)) => {
                assert!(key == "path" && scene.clips[0].channels.is_empty());
                assert_has(&warnings[0], &["left out"]);
            }
            Err(error) => assert_has(&error.to_string(), &["found node 9", "one of 1 nodes"]),
        }
    }
    let mut document = turning(&[0.0], &still, "LINEAR");
    document.json["nodes"][0]["matrix"] = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 0, 0, 1]);
    let (scene, warnings) = document.load().unwrap();
    assert!(matches!(scene.nodes[0].rest, LocalTransform::Parts { .. }));
    assert_has(&warnings[0], &["taken apart"]);
}

#[test]
fn materials_are_mapped_as_documented() {
    let document = Document::triangle().material(&json!({ "pbrMetallicRoughness": {
        "baseColorFactor": [1.0, 0.5, 0.0, 1.0], "metallicFactor": 1.0, "roughnessFactor": 0.0 } }));
    let (scene, _) = document.load().unwrap();
    let gold = &scene.materials[0];
    assert_eq!((gold.mirror, gold.diffuse), (Vec3::new(1.0, 0.5, 0.0), Vec3::ZERO));
    assert_eq!((gold.fresnel, gold.shininess), (Fresnel::Schlick, 1000.0));

    let document = Document::triangle().material(&json!({ "pbrMetallicRoughness": {
        "baseColorFactor": [1.0, 0.5, 0.0, 1.0] } }));
    let (scene, _) = document.load().unwrap();
    let rough = &scene.materials[0];
    assert_eq!((rough.mirror, rough.diffuse), (Vec3::ZERO, Vec3::new(1.0, 0.5, 0.0)));

    let document = Document::triangle().material(&json!({
        "emissiveFactor": [1, 1, 0], "alphaMode": "BLEND",
        "pbrMetallicRoughness": { "metallicFactor": 0, "baseColorFactor": [1, 1, 1, 0.25] },
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 4.0 } } }));
    let (scene, _) = document.load().unwrap();
    let lamp = &scene.materials[0];
    assert_eq!((lamp.emission, lamp.transmission), (Vec3::new(4.0, 4.0, 0.0), Vec3::splat(0.75)));

    let document = Document::triangle().material(&json!({
        "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 0 },
        "extensions": { "KHR_materials_transmission": { "transmissionFactor": 1.0 },
            "KHR_materials_ior": { "ior": 1.25 },
            "KHR_materials_volume": { "attenuationDistance": 2.0,
                "attenuationColor": [1.0, 0.5, 0.25] } } }));
    let (scene, _) = document.load().unwrap();
    let glass = &scene.materials[0];
    assert_eq!((glass.fresnel, glass.ior), (Fresnel::Dielectric, 1.25));
    assert_eq!((glass.transmission, glass.diffuse), (Vec3::ONE, Vec3::ZERO));
    assert!((glass.absorption.y - 0.5 * 2.0_f32.ln()).abs() < 1e-6);
}

#[test]
fn colour_textures_load_with_their_coordinates_and_means_stand_for_data() {
    let mut document = Document::triangle().material(&json!({ "pbrMetallicRoughness": {
        "baseColorTexture": { "index": 0, "texCoord": 1, "extensions": { "KHR_texture_transform":
            { "offset": [0.5, 0.0], "scale": [2.0, 1.0] } } },
        "metallicRoughnessTexture": { "index": 1 } } }));
    let uvs = document.floats("VEC2", 3, &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    document.primitive()["attributes"]["TEXCOORD_1"] = json!(uvs);
    let colors = document.column("VEC4", 5121, 3, &[255; 12]);
    document.primitive()["attributes"]["COLOR_0"] = json!(colors);
    let view = document.json["bufferViews"].as_array().unwrap().len();
    document.column("SCALAR", 5121, 0, &png(2, 2, [0, 51, 255]));
    document.json["images"] = json!([
        { "bufferView": view, "mimeType": "image/png" }, { "uri": "data.png" },
    ]);
    document.json["textures"] = json!([{ "source": 0 }, { "source": 1 }]);
    let text = document.text();
    let data = png(1, 1, [0, 51, 255]);
    let files: [(&str, &[u8]); 2] = [("a.gltf", text.as_bytes()), ("data.png", &data)];
    let (scene, warnings) = load_files("a.gltf", &files).unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    assert_eq!((scene.textures[0].width, scene.textures[0].texels[0][2]), (2, 1.0));
    assert!(scene.materials[0].diffuse_texture.is_some());
    let gloss = 0.8_f32.powi(2);
    assert!((scene.materials[0].mirror.x - gloss).abs() < 1e-5, "metal of roughness 0.2");
    let attributes = &fixed_mesh(&scene, 0).attributes;
    let expected = [Vec2::new(0.5, 0.0), Vec2::new(2.5, 0.0), Vec2::new(0.5, 1.0)];
    assert_eq!((attributes.uvs.as_slice(), attributes.colors.len()), (&expected[..], 3));

    // Without the data, the default of full metalness would be wrong.
    let (scene, warnings) = document.load().unwrap();
    assert_eq!((scene.materials[0].mirror, warnings.len()), (Vec3::ZERO, 1));
    assert_has(&warnings[0], &["image 1", "data.png", "do without it"]);
}

#[test]
fn unreadable_images_are_warnings() {
    for image in [
        json!({ "uri": "data:image/png;base64,AAAA" }),
        json!({ "uri": "https://host/a.png" }),
        json!({ "bufferView": 0 }),
        json!({}),
    ] {
        let mut document = Document::triangle().material(&json!({ "pbrMetallicRoughness": {
            "baseColorTexture": { "index": 0 } } }));
        document.json["images"] = json!([image]);
        document.json["textures"] = json!([{ "source": 0 }]);
        let (scene, warnings) = document.load().unwrap();
        assert!(scene.textures.is_empty() && warnings.len() == 1, "{warnings:?}");
        assert_eq!(scene.materials[0].diffuse, Vec3::splat(0.5), "neither white nor metal");
        document.json["textures"] = json!([{}]);
        assert_eq!(document.load().unwrap().1.len(), 1);
    }
}

#[test]
fn cameras_and_lights_hang_on_their_nodes() {
    let mut document = Document::triangle();
    document.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "spot", "intensity": 3.0, "color": [1, 0, 0], "spot": {} },
        { "type": "point", "name": "bulb" }, { "type": "directional" } ] } });
    let light = |idx: usize| json!({ "extensions": { "KHR_lights_punctual": { "light": idx } } });
    document.json["cameras"] = json!([
        { "type": "perspective", "perspective": { "yfov": 0.5, "znear": 0.1 } },
        { "type": "orthographic", "name": "top",
          "orthographic": { "xmag": 1.0, "ymag": 2.0, "znear": 0.0, "zfar": 9.0 } } ]);
    document.json["nodes"] =
        json!([light(0), light(1), light(2), { "camera": 0, "name": "eye" }, { "camera": 1 }]);
    document.json["scenes"] = json!([{ "nodes": [0, 1, 2, 3, 4] }]);
    let (scene, _) = document.load().unwrap();
    let LightKind::Spot { intensity, cos_inner, .. } = scene.lights[0].kind else { panic!("spot") };
    assert_eq!((intensity, cos_inner), (Vec3::new(3.0, 0.0, 0.0), 1.0));
    assert_eq!((scene.lights[1].name.as_str(), scene.lights[2].node.unwrap().0), ("bulb", 2));
    assert_eq!((scene.cameras[0].name.as_str(), scene.cameras[1].name.as_str()), ("eye", "top"));
    assert_eq!(scene.cameras[0].projection, Projection::Perspective { vertical_fov: 0.5 });
    assert_eq!(scene.cameras[1].projection, Projection::Orthographic { height: 4.0 });

    document.json["cameras"][0]["perspective"]["yfov"] = json!(0);
    assert_has(&document.message(), &["camera 0", "yfov of 0"]);
    document.json["cameras"][0] = json!({ "type": "perspective", "orthographic": document.json["cameras"][1]["orthographic"] });
    assert_has(&document.message(), &["camera 0", "no projection of the stated type"]);
    document.json["cameras"] = json!([]);
    assert_has(&document.message(), &["camera", "out of range"]);
    document.json["nodes"] = json!([light(9), {}, {}, {}, {}]);
    assert_has(&document.message(), &["light", "out of range"]);
}
