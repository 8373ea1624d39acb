//! What one frame holds.

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};
use rayflock_geom::{Aabb, ObjectId};
use rayflock_scene::{
    Camera, ChannelValues, Falloff, Light, LightKind, LocalTransform, MeshSequence, MotionKind,
    NodeIdx, Projection, Scene, Shape,
};

use crate::build::{
    clip, evaluator, morphed, node, object, scene, slide, triangle, two_joints, weights,
};

#[test]
fn an_empty_scene_makes_empty_frames() {
    let mut evaluator = evaluator(Scene::default());
    let frame = evaluator.evaluate(1.0).unwrap();
    assert!(frame.geometry.objects().is_empty() && frame.changes.iter().next().is_none());
    assert!(evaluator.bounds_over_clip().unwrap().is_empty());
    assert_eq!((evaluator.time_range(), evaluator.frame_count(24.0)), ((0.0, 0.0), 1));
}

#[test]
fn instances_share_their_mesh() {
    let rest = triangle();
    let fixed = Shape::Fixed(rest.clone());
    let unbent = Shape::Deformed { rest, targets: Arc::default(), skin: None };
    let nodes = vec![node(None, Vec3::X), node(None, Vec3::Y)];
    let objects = vec![
        object("a", Some(0), fixed.clone()),
        object("b", Some(1), fixed),
        object("c", None, unbent),
    ];
    let mut evaluator = evaluator(scene(nodes, objects));
    let frame = evaluator.evaluate(0.0).unwrap();
    let [a, b, c] = [0, 1, 2].map(|id| frame.geometry.object(ObjectId(id)).unwrap());
    assert!(Arc::ptr_eq(&a.shape, &b.shape) && Arc::ptr_eq(&a.shape, &c.shape));
    assert_eq!(a.world_from_object, Some(Affine3A::from_translation(Vec3::X)));
    assert_eq!(b.world_from_object, Some(Affine3A::from_translation(Vec3::Y)));
}

#[test]
fn only_what_is_at_the_origin_for_ever_is_in_world_space() {
    let fixed = || Shape::Fixed(triangle());
    let nodes = vec![node(None, Vec3::ZERO), node(None, Vec3::ZERO)];
    let objects = vec![
        object("no node", None, fixed()),
        object("still", Some(0), fixed()),
        object("moves", Some(1), fixed()),
    ];
    let mut scene = scene(nodes, objects);
    scene.clips = vec![clip(vec![(1, slide(Vec3::ZERO, Vec3::X))])];
    let mut evaluator = evaluator(scene);
    let geometry = &evaluator.evaluate(0.0).unwrap().geometry;
    let places = [0, 1, 2].map(|id| geometry.object(ObjectId(id)).unwrap().world_from_object);
    assert_eq!(places, [None, None, Some(Affine3A::IDENTITY)]);
}

#[test]
fn lights_and_cameras_ride_on_their_nodes() {
    let mut turned = node(None, Vec3::X);
    turned.rest = LocalTransform::Parts {
        translation: Vec3::X,
        rotation: Quat::from_rotation_y(std::f32::consts::FRAC_PI_2),
        scale: Vec3::new(2.0, -3.0, 4.0),
    };
    let mut scene = scene(vec![turned], vec![]);
    let spot = LightKind::Spot {
        position: Vec3::ZERO,
        direction: Vec3::NEG_Z,
        intensity: Vec3::ONE,
        cos_inner: 0.9,
        cos_outer: 0.8,
    };
    let point = LightKind::Point {
        position: Vec3::Z,
        intensity: Vec3::ONE,
        falloff: Falloff::InverseSquare,
    };
    let light = |node, kind| Light { name: String::new(), node, kind };
    scene.lights = vec![light(Some(NodeIdx(0)), spot), light(None, point)];
    scene.cameras = vec![Camera {
        name: "main".to_owned(),
        node: Some(NodeIdx(0)),
        node_from_camera: Affine3A::IDENTITY,
        projection: Projection::Perspective { vertical_fov: 1.0 },
    }];
    let mut evaluator = evaluator(scene);
    let frame = evaluator.evaluate(0.0).unwrap();

    let LightKind::Spot { position, direction, .. } = frame.lights[0] else { panic!() };
    assert_eq!(position, Vec3::X);
    assert!(direction.distance(Vec3::NEG_X) < 1e-6);
    assert_eq!(frame.lights[1], point);
    // The camera looks the same way, neither scaled nor mirrored.
    let camera = frame.cameras[0];
    assert!((camera.matrix3.determinant() - 1.0).abs() < 1e-5);
    assert!(camera.transform_vector3(Vec3::NEG_Z).distance(Vec3::NEG_X) < 1e-6);
}

#[test]
fn cameras_and_clips_are_chosen_by_name() {
    let mut scene = scene(vec![], vec![]);
    assert_eq!(scene.camera_idx(None), Ok(None));
    let message = scene.camera_idx(Some("main")).unwrap_err().to_string();
    assert_eq!(message, "no camera is called \"main\"; there are: none");
    for name in ["front", "side"] {
        scene.cameras.push(Camera {
            name: name.to_owned(),
            node: None,
            node_from_camera: Affine3A::IDENTITY,
            projection: Projection::Orthographic { height: 1.0 },
        });
    }
    assert_eq!(scene.camera_idx(Some("side")), Ok(Some(1)));
    assert_eq!(scene.camera_idx(None), Ok(Some(0)));
    let message = scene.camera_idx(Some("top")).unwrap_err().to_string();
    assert_eq!(message, "no camera is called \"top\"; there are: \"front\", \"side\"");
    let message = scene.clip_idx(Some("run")).unwrap_err().to_string();
    assert_eq!(message, "no clip is called \"run\"; there are: none");
}

#[test]
fn the_rate_is_that_of_the_source_if_it_makes_sense() {
    for (stated, expected) in [(None, 24.0), (Some(30.0), 30.0), (Some(0.0), 24.0)] {
        let scene = Scene { frame_rate: stated, ..Scene::default() };
        assert_eq!(scene.default_frame_rate(), expected);
    }
    let scene = Scene { frame_rate: Some(f64::NAN), ..Scene::default() };
    assert_eq!(scene.default_frame_rate(), 24.0);
}

#[test]
fn objects_move_in_kinds() {
    let fixed = || Shape::Fixed(triangle());
    let sequence = vec![(0.0, triangle()), (1.0, triangle())];
    let sequence = MeshSequence::new(sequence).unwrap();
    let nodes = vec![node(None, Vec3::ZERO), node(None, Vec3::ZERO), node(Some(0), Vec3::ZERO)];
    let objects = vec![
        object("static", Some(1), fixed()),
        object("rigid", Some(2), fixed()),
        object("morphed", Some(1), morphed(None)),
        object(
            "carried",
            Some(0),
            Shape::Deformed { rest: triangle(), targets: Arc::default(), skin: None },
        ),
        object(
            "skinned by what rests",
            Some(0),
            Shape::Deformed {
                rest: triangle(),
                targets: Arc::default(),
                skin: Some(Arc::new(two_joints(1, 1))),
            },
        ),
        object("skinned", None, morphed(Some(two_joints(0, 1)))),
        object("sequence", Some(0), Shape::Animated(Arc::new(sequence))),
    ];
    let mut scene = scene(nodes, objects);
    scene.clips = vec![clip(vec![
        (0, slide(Vec3::ZERO, Vec3::X)),
        (1, slide(Vec3::X, Vec3::X)),
        (1, weights(1, &[0.0, 1.0])),
    ])];
    use MotionKind::{Deforming, Rigid, Static, Topology};
    let kinds = evaluator(scene).motion_kinds();
    assert_eq!(kinds, [Static, Rigid, Deforming, Rigid, Static, Deforming, Topology]);
}

#[test]
fn bounds_hold_the_whole_clip_and_leave_the_frame_alone() {
    let objects = vec![object("slides", Some(0), Shape::Fixed(triangle()))];
    let mut scene = scene(vec![node(None, Vec3::ZERO)], objects);
    scene.clips = vec![clip(vec![(0, slide(Vec3::ZERO, 10.0 * Vec3::X))])];
    let mut evaluator = evaluator(scene);
    let before = evaluator.evaluate(0.0).unwrap().clone();
    let bounds = evaluator.bounds_over_clip().unwrap();
    assert_eq!(bounds, Aabb { min: Vec3::ZERO, max: Vec3::new(11.0, 1.0, 0.0) });
    let after = evaluator.evaluate(0.0).unwrap();
    let unchanged = after.changes.iter().all(|(_, c)| c == rayflock_geom::ObjectChange::Unchanged);
    assert!(unchanged && after.geometry.bounds() == before.geometry.bounds());
}

#[test]
fn hidden_nodes_hide_what_hangs_on_them() {
    let nodes = vec![node(None, Vec3::ZERO), node(Some(0), Vec3::ZERO), node(None, Vec3::ZERO)];
    let fixed = || Shape::Fixed(triangle());
    let objects = vec![object("hidden", Some(1), fixed()), object("stays", Some(2), fixed())];
    let mut scene = scene(nodes, objects);
    let values = ChannelValues::Visibility(vec![true, false, true]);
    let mut clip = clip(vec![(0, values)]);
    clip.channels[0].times = vec![0.0, 1.0, 3.0];
    scene.clips = vec![clip];
    let mut evaluator = evaluator(scene);
    assert_eq!(evaluator.motion_kinds(), [MotionKind::Topology, MotionKind::Static]);
    let mut counts = |time| {
        let objects = evaluator.evaluate(time).unwrap().geometry.objects().to_vec();
        [0, 1].map(|idx| objects[idx].shape.prim_count())
    };
    assert_eq!([0.0, 1.0, 2.9].map(&mut counts), [[1, 1], [0, 1], [0, 1]]);
    assert_eq!(counts(3.5), [1, 1]);
}

#[test]
fn clips_of_finite_scenes_rest_before_and_after() {
    let objects = vec![object("slides", Some(0), Shape::Fixed(triangle()))];
    let mut scene = scene(vec![node(None, Vec3::ZERO)], objects);
    scene.clips = vec![clip(vec![(0, slide(Vec3::ZERO, Vec3::X))])];
    for (frame_count, expected) in [(None, [0.5, 0.5, 0.0]), (Some(49), [0.0, 0.5, 1.0])] {
        scene.frame_count = frame_count;
        let mut evaluator = evaluator(scene.clone());
        let at = |time| evaluator.evaluate(time).unwrap().geometry.bounds().min.x;
        assert_eq!([-1.0, 1.0, 2.0].map(at), expected);
    }
}

#[test]
fn time_ranges_and_frame_counts() {
    let meshes = vec![triangle(); 61];
    let sequence = Arc::new(MeshSequence::at_frame_rate(meshes, 24.0).unwrap());
    let objects = vec![object("sequence", None, Shape::Animated(sequence))];
    let mut scene = scene(vec![node(None, Vec3::ZERO)], objects);
    assert_eq!(evaluator(scene.clone()).time_range(), (0.0, 2.5));
    assert_eq!(evaluator(scene.clone()).frame_count(24.0), 61);
    scene.clips = vec![clip(vec![(0, slide(Vec3::ZERO, Vec3::X))])];
    assert_eq!(evaluator(scene.clone()).frame_count(24.0), 61);
    assert_eq!(evaluator(scene.clone()).frame_count(2.0), 6);
    scene.frame_count = Some(25);
    assert_eq!(evaluator(scene.clone()).time_range(), (0.0, 1.0));
    assert_eq!(evaluator(scene).frame_count(2.0), 25);
}
