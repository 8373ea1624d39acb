//! Scenes that do not hang together: errors that say what is wrong, and never a panic.

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};
use proptest::prelude::*;
use rayflock_scene::{
    Camera, Channel, ChannelValues, Clip, Evaluator, Interpolation, Light, LightKind,
    LocalTransform, Material, MaterialIdx, MeshSequence, MorphTarget, NodeIdx, PrimMaterials,
    Projection, Scene, SceneError, Shape, Skin, SurfaceAttributes, TextureIdx, VertexInfluences,
    frame_bounds,
};

use crate::build::{clip, morphed, node, object, scene, slide, triangle, two_joints, weights};

fn message(scene: Scene) -> String {
    match Evaluator::new(Arc::new(scene), None) {
        Ok(mut evaluator) => evaluator.evaluate(0.0).expect_err("the scene is broken").to_string(),
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

/// Values that hurt: not finite, huge, zero.
fn value() -> impl Strategy<Value = f32> {
    prop_oneof![-2.0..2.0_f32, Just(f32::NAN), Just(f32::INFINITY), Just(f32::MAX), Just(0.0)]
}

/// A channel of one of three nodes, for one morph target, that hangs together.
fn channel() -> impl Strategy<Value = Channel> {
    let interpolation = prop_oneof![
        Just(Interpolation::Step),
        Just(Interpolation::Linear),
        Just(Interpolation::CubicSpline),
        Just(Interpolation::Squad)
    ];
    let times = prop::collection::vec(-2.0..2.0_f32, 1..4);
    let values = prop::collection::vec(prop::array::uniform4(value()), 9);
    (0..3_u32, times, interpolation, values, 0..5).prop_map(
        |(node, mut times, interpolation, mut values, kind)| {
            times.sort_by(f32::total_cmp);
            values.truncate(times.len() * interpolation.values_per_key());
            let vectors = || values.iter().map(|v| Vec3::from_slice(v)).collect();
            let values = match kind {
                0 => ChannelValues::Translation(vectors()),
                1 => ChannelValues::Scale(vectors()),
                2 => ChannelValues::Rotation(values.iter().map(|&v| Quat::from_array(v)).collect()),
                3 => ChannelValues::Visibility(times.iter().map(|&time| time < 0.0).collect()),
                _ => weights(1, &values.iter().map(|v| v[0]).collect::<Vec<_>>()),
            };
            Channel { node: NodeIdx(node), times, interpolation, values }
        },
    )
}

/// A scene of odd numbers that hangs together: three nodes, a mesh with a morph target and
/// perhaps a skin, a light and a camera.
fn odd_scene() -> impl Strategy<Value = Scene> {
    let numbers = prop::collection::vec(value(), 12);
    let channels = prop::collection::vec(channel(), 0..6);
    (numbers, channels, any::<bool>()).prop_map(|(numbers, channels, skinned)| {
        let vector = |i| Vec3::from_slice(&numbers[i..]);
        let matrix = Affine3A::from_cols_slice(&numbers);
        let mut nodes: Vec<_> =
            [None, Some(2), Some(0)].map(|parent| node(parent, vector(0))).into();
        nodes[2].rest = LocalTransform::Matrix(matrix);
        let skin = skinned.then(|| {
            let mut skin = two_joints(1, 2);
            skin.joints[1].1 = matrix;
            skin.influences[2].weights[0] = numbers[5];
            skin
        });
        let mut scene = scene(nodes, vec![object("any", Some(1), morphed(skin))]);
        scene.clips = vec![Clip { name: "any".to_owned(), channels }];
        let kind = LightKind::Directional { direction: vector(3), irradiance: vector(6) };
        scene.lights = vec![Light { name: String::new(), node: Some(NodeIdx(0)), kind }];
        scene.cameras = vec![Camera {
            name: String::new(),
            node: Some(NodeIdx(1)),
            node_from_camera: matrix,
            projection: Projection::Orthographic { height: numbers[9] },
        }];
        scene
    })
}

/// Breaks one thing in a scene, where there is that thing.
fn break_something(scene: &mut Scene, which: u32) {
    let far = NodeIdx(3 + which);
    let channel = scene.clips[0].channels.first_mut();
    let Shape::Deformed { rest, targets, skin } = &mut scene.objects[0].shape else { return };
    let skin = skin.as_mut().map(Arc::make_mut);
    match which {
        0 => scene.nodes[1].parent = Some(far),
        1 => scene.nodes[0].parent = Some(NodeIdx(1)),
        2 => scene.objects[0].node = Some(far),
        3 => scene.lights[0].node = Some(far),
        4 => scene.cameras[0].node = Some(far),
        5 => scene.materials.clear(),
        6 => rest.normals = vec![Vec3::Z].into(),
        7 => Arc::make_mut(targets)[0].normals.push(Vec3::X),
        8 => skin.into_iter().for_each(|skin| skin.joints[0].0 = far),
        9 => skin.into_iter().for_each(|skin| skin.influences.clear()),
        10 => skin.into_iter().for_each(|skin| skin.joints.clear()),
        11 => channel.into_iter().for_each(|channel| channel.node = far),
        12 => channel.into_iter().for_each(|channel| channel.times.clear()),
        13 => channel.into_iter().for_each(|channel| channel.times.push(f32::MAX)),
        14 => channel.into_iter().for_each(|channel| channel.times[0] = f32::NAN),
        _ => channel.into_iter().for_each(|channel| channel.values = weights(usize::MAX, &[0.0])),
    }
}

/// Evaluates a scene in every way.
fn evaluate(scene: Scene, time: f64) -> Result<(), SceneError> {
    let mut evaluator = Evaluator::new(Arc::new(scene), None)?;
    for time in [0.0, time, 0.5] {
        evaluator.evaluate(time)?;
    }
    evaluator.motion_kinds();
    evaluator.frame_count(time);
    frame_bounds(&evaluator.bounds_over_clip()?, time as f32);
    Ok(())
}

proptest! {
    #[test]
    fn odd_numbers_make_frames(scene in odd_scene(), time in prop::num::f64::ANY) {
        prop_assert_eq!(evaluate(scene, time), Ok(()));
    }

    #[test]
    fn what_is_broken_is_told_without_panic(mut scene in odd_scene(), which in 0..16_u32) {
        let before = format!("{scene:?}");
        break_something(&mut scene, which);
        let broken = format!("{scene:?}") != before;
        prop_assert_eq!(evaluate(scene, 0.5).is_err(), broken);
    }
}
