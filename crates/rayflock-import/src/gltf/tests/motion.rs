//! Skins, morph targets and clips.

use glam::{Quat, Vec3};
use rayflock_scene::{ChannelValues, Interpolation, LocalTransform, Shape};
use serde_json::json;

use super::document::{Document, assert_has};

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
