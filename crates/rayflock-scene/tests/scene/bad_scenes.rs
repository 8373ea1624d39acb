//! Scenes that do not hang together: errors that say what is wrong, and never a panic.

use std::sync::Arc;

use glam::{Quat, Vec3};
use proptest::prelude::*;
use rayflock_scene::{
    Camera, Channel, ChannelValues, Clip, Evaluator, Interpolation, Light, LightKind, Material,
    MaterialIdx, MeshSequence, MorphTarget, NodeIdx, PrimMaterials, Projection, Scene, Shape, Skin,
    SurfaceAttributes, TextureIdx, VertexInfluences,
};

use crate::build::{clip, morphed, node, object, scene, slide, triangle, two_joints, weights};

fn message(scene: Scene) -> String {
    match Evaluator::new(Arc::new(scene), None) {
        Ok(mut evaluator) => evaluator.evaluate(0.0).unwrap_err().to_string(),
        Err(error) => error.to_string(),
    }
}

/// One object of this shape on one node, with these channels.
fn with_channels(shape: Shape, channels: Vec<(u32, ChannelValues)>) -> Scene {
    let mut scene = scene(vec![node(None, Vec3::ZERO)], vec![object("Body", Some(0), shape)]);
    scene.clips = vec![clip(channels)];
    scene
}

#[test]
fn names_of_things_that_are_not_there() {
    let fixed = || Shape::Fixed(triangle());
    let mut odd = scene(vec![node(Some(7), Vec3::ZERO)], vec![]);
    assert_eq!(message(odd), "node \"node\" names node 7, but the number of these is 1");
    odd = scene(vec![], vec![object("Body", Some(0), fixed())]);
    assert_eq!(message(odd), "object \"Body\" names node 0, but the number of these is 0");
    odd = Scene { materials: vec![], ..scene(vec![], vec![object("Body", None, fixed())]) };
    assert_eq!(message(odd), "object \"Body\" names material 0, but the number of these is 0");
    odd = scene(vec![], vec![]);
    odd.materials = vec![Material {
        name: "Fur".to_owned(),
        diffuse_texture: Some(TextureIdx(2)),
        ..Material::default()
    }];
    assert_eq!(message(odd), "material \"Fur\" names texture 2, but the number of these is 0");
    odd = with_channels(fixed(), vec![(3, slide(Vec3::ZERO, Vec3::X))]);
    let expected = "channel 0 of clip \"clip\" names node 3, but the number of these is 1";
    assert_eq!(message(odd), expected);
}

#[test]
fn columns_of_other_lengths() {
    let deformed = |targets: Vec<MorphTarget>, skin: Option<Skin>| Shape::Deformed {
        rest: triangle(),
        targets: targets.into(),
        skin: skin.map(Arc::new),
    };
    let short = MorphTarget { positions: vec![Vec3::X; 2], normals: vec![] };
    let odd = with_channels(deformed(vec![MorphTarget::default(), short], None), vec![]);
    let expected = "morph target 1 of object \"Body\" has 2 position offsets, expected 3";
    assert_eq!(message(odd), expected);

    let mut skin = two_joints(0, 0);
    skin.influences.pop();
    let odd = with_channels(deformed(vec![], Some(skin)), vec![]);
    let expected = "the skin of object \"Body\" has 2 influences of vertices, expected 3";
    assert_eq!(message(odd), expected);

    let mut skin = two_joints(0, 0);
    skin.influences[1] = VertexInfluences::new([(9, 1.0)]);
    let odd = with_channels(deformed(vec![], Some(skin)), vec![]);
    let expected = "the skin of object \"Body\" names joint 9, but the number of these is 2";
    assert_eq!(message(odd), expected);

    let odd = with_channels(morphed(None), vec![(0, weights(2, &[0.0; 4]))]);
    let expected = "channel 0 of clip \"clip\" for object \"Body\" has 2 weights a key, expected 1";
    assert_eq!(message(odd), expected);

    let values = ChannelValues::Rotation(vec![Quat::IDENTITY; 3]);
    let odd = with_channels(morphed(None), vec![(0, values)]);
    assert_eq!(message(odd), "channel 0 of clip \"clip\" has 3 values, expected 2");
}

#[test]
fn key_times_that_are_missing_or_go_back() {
    let timed = |times: &[f32]| {
        let mut scene = with_channels(morphed(None), vec![(0, slide(Vec3::ZERO, Vec3::X))]);
        scene.clips[0].channels[0].times = times.to_vec();
        message(scene)
    };
    assert_eq!(timed(&[]), "channel 0 of clip \"clip\" has no keys");
    let expected = "channel 0 of clip \"clip\": key 1 has the time 1, expected a time not before \
                    that of the key before";
    assert_eq!(timed(&[2.0, 1.0]), expected);
    let expected = "channel 0 of clip \"clip\": key 0 has the time NaN, expected a finite number";
    assert_eq!(timed(&[f32::NAN, 1.0]), expected);
}

#[test]
fn meshes_of_sequences_are_checked_when_they_come_up() {
    let mut odd = triangle();
    odd.attributes = Arc::new(SurfaceAttributes {
        materials: PrimMaterials::PerPrim(vec![MaterialIdx(0), MaterialIdx(0)]),
        ..SurfaceAttributes::default()
    });
    let sequence = MeshSequence::new(vec![(0.0, odd)]).unwrap();
    let shape = Shape::Animated(Arc::new(sequence));
    let odd = scene(vec![], vec![object("Sea", None, shape)]);
    assert_eq!(message(odd), "object \"Sea\" has 2 materials of primitives, expected 1");
}

#[test]
fn clips_that_are_not_played_may_be_wrong() {
    let mut scene = with_channels(morphed(None), vec![(9, slide(Vec3::ZERO, Vec3::X))]);
    scene.clips.push(Clip { name: "good".to_owned(), channels: vec![] });
    let scene = Arc::new(scene);
    assert!(Evaluator::new(Arc::clone(&scene), None).is_err());
    assert!(Evaluator::new(scene, Some("good")).is_ok());
}

fn channel() -> impl Strategy<Value = Channel> {
    let interpolation = prop_oneof![
        Just(Interpolation::Step),
        Just(Interpolation::Linear),
        Just(Interpolation::CubicSpline)
    ];
    let value = prop_oneof![-2.0..2.0_f32, Just(f32::NAN), Just(f32::MAX), Just(0.0_f32)];
    let values = prop::collection::vec(value.clone(), 0..8);
    let times = prop::collection::vec(value, 0..3);
    (0..4_u32, times, interpolation, values, 0..6_usize).prop_map(
        |(node, times, interpolation, values, kind)| {
            let vectors = || values.iter().map(|&v| Vec3::splat(v)).collect();
            let values = match kind {
                0 => ChannelValues::Translation(vectors()),
                1 => ChannelValues::Scale(vectors()),
                2 => ChannelValues::Rotation(
                    values.iter().map(|&v| Quat::from_array([v; 4])).collect(),
                ),
                count => ChannelValues::Weights { weights_per_key: count - 3, values },
            };
            Channel { node: NodeIdx(node), times, interpolation, values }
        },
    )
}

/// A scene whose numbers, lengths and positions fit together by chance only.
fn any_scene() -> impl Strategy<Value = Scene> {
    let parent = prop::option::weighted(0.4, 0..3_u32);
    let nodes = prop::collection::vec(parent, 1..4);
    let channels = prop::collection::vec(channel(), 0..3);
    let target = (0..2_usize, 0..2_usize);
    let targets = prop::collection::vec(target, 0..3);
    let skin = prop::option::of((prop::collection::vec(0..4_u32, 0..3), 2..4_usize, 0..3_u16));
    (nodes, channels, targets, skin, 0..2_u32, 0..4_u32).prop_map(
        |(nodes, channels, targets, skin, material, carrier)| {
            let offsets = |some| vec![Vec3::X; 3 * some];
            let targets = targets.into_iter().map(|(positions, normals)| MorphTarget {
                positions: offsets(positions),
                normals: offsets(normals),
            });
            let skin = skin.map(|(joints, count, joint)| {
                let influences = vec![VertexInfluences::new([(joint, 1.0), (0, 0.5)]); count];
                let joints = joints.into_iter().map(NodeIdx).map(|j| (j, glam::Affine3A::NAN));
                Arc::new(Skin { joints: joints.collect(), influences })
            });
            let mut rest = triangle();
            rest.attributes = Arc::new(SurfaceAttributes {
                materials: PrimMaterials::PerPrim(vec![MaterialIdx(material)]),
                ..SurfaceAttributes::default()
            });
            let shape = Shape::Deformed { rest, targets: targets.collect(), skin };
            let nodes = nodes.into_iter().map(|parent| node(parent, Vec3::MAX)).collect();
            let mut scene = scene(nodes, vec![object("any", Some(carrier), shape)]);
            scene.clips = vec![Clip { name: "any".to_owned(), channels }];
            scene.lights = vec![Light {
                name: String::new(),
                node: Some(NodeIdx(carrier)),
                kind: LightKind::Directional { direction: Vec3::ZERO, irradiance: Vec3::ONE },
            }];
            scene.cameras = vec![Camera {
                name: String::new(),
                node: Some(NodeIdx(material)),
                node_from_camera: glam::Affine3A::ZERO,
                projection: Projection::Orthographic { height: 0.0 },
            }];
            scene
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn no_scene_makes_it_panic(scene in any_scene(), time in prop::num::f64::ANY) {
        let scene = Arc::new(scene);
        let found = Evaluator::new(Arc::clone(&scene), None);
        if let Ok(mut evaluator) = found {
            for time in [0.0, time, 0.5] {
                let frame = evaluator.evaluate(time);
                prop_assert!(frame.is_ok(), "{frame:?}");
            }
            evaluator.motion_kinds();
            evaluator.frame_count(time);
            prop_assert!(evaluator.bounds_over_clip().is_ok());
        }
    }
}
