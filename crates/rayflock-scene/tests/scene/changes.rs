//! What frames say has changed since the frame before.

use std::sync::Arc;

use glam::Vec3;
use rayflock_geom::ObjectChange::{self, Added, Deformed, Retopologised, Transformed, Unchanged};
use rayflock_scene::{
    AnimatedMesh, Evaluator, MeshSequence, Scene, SceneError, Shape, SurfaceMesh, VertexFrames,
    VertexKey,
};

use crate::build::{
    clip, evaluator, morphed, node, object, scene, slide, triangle, two_joints, weights,
};

fn changes(evaluator: &mut Evaluator, time: f64) -> Vec<ObjectChange> {
    evaluator
        .evaluate(time)
        .expect("the scene can be evaluated")
        .changes
        .iter()
        .map(|(_, change)| change)
        .collect()
}

/// Objects of every kind: fixed, rigid, morphed, skinned.
fn mixed() -> Scene {
    let nodes = vec![node(None, Vec3::ZERO), node(None, Vec3::X), node(None, Vec3::Y)];
    let objects = vec![
        object("fixed", Some(1), Shape::Fixed(triangle())),
        object("rigid", Some(0), Shape::Fixed(triangle())),
        object("morphed", Some(2), morphed(None)),
        object("skinned", None, morphed(Some(two_joints(0, 1)))),
    ];
    let mut scene = scene(nodes, objects);
    let mut rests_at_last =
        clip(vec![(0, slide(Vec3::ZERO, Vec3::X)), (2, weights(1, &[0.0, 1.0]))]);
    // Everything moves for two seconds, then rests until second four.
    let mut rest = rests_at_last.channels[0].clone();
    rest.node = rayflock_scene::NodeIdx(1);
    rest.times = vec![0.0, 4.0];
    rest.values = slide(Vec3::X, Vec3::X);
    rests_at_last.channels.push(rest);
    scene.clips = vec![rests_at_last];
    scene
}

#[test]
fn each_frame_says_what_moved_how() {
    let mut evaluator = evaluator(mixed());
    assert_eq!(changes(&mut evaluator, 0.0), [Added; 4]);
    assert_eq!(changes(&mut evaluator, 0.0), [Unchanged; 4]);
    assert_eq!(changes(&mut evaluator, 0.5), [Unchanged, Transformed, Deformed, Deformed]);
    assert_eq!(changes(&mut evaluator, 2.0), [Unchanged, Transformed, Deformed, Deformed]);
    assert_eq!(changes(&mut evaluator, 3.0), [Unchanged; 4]);
    assert_eq!(changes(&mut evaluator, 4.0), [Unchanged, Transformed, Deformed, Deformed]);
}

#[test]
fn sequences_say_what_they_share() {
    let first = triangle();
    let mut moved = first.clone();
    Arc::make_mut(&mut moved.mesh).vertices_mut()[0] = Vec3::Z;
    let keys = vec![(0.0, first.clone()), (1.0, moved), (2.0, triangle())];
    let sequence = MeshSequence::new(keys).unwrap();
    let key = |time, x: f32| VertexKey { time, positions: vec![Vec3::X * x; 3], normals: vec![] };
    let cloth = VertexFrames::new(&first, vec![key(1.0, 1.0), key(2.0, 2.0)]).unwrap();
    let objects = vec![
        object("sequence", None, Shape::Animated(Arc::new(sequence))),
        object("cloth", None, Shape::Animated(Arc::new(cloth))),
    ];
    let mut evaluator = evaluator(scene(vec![], objects));
    assert_eq!(changes(&mut evaluator, -5.0), [Added; 2]);
    assert_eq!(changes(&mut evaluator, 0.9), [Unchanged, Unchanged]);
    assert_eq!(changes(&mut evaluator, 1.5), [Deformed, Deformed]);
    assert_eq!(changes(&mut evaluator, 1.75), [Unchanged, Deformed]);
    assert_eq!(changes(&mut evaluator, 2.0), [Retopologised, Deformed]);
    assert_eq!(changes(&mut evaluator, 99.0), [Unchanged, Unchanged]);
}

#[test]
fn meshes_that_somebody_holds_are_not_written_over() {
    let mut evaluator = evaluator(mixed());
    let mut held = Vec::new();
    for step in 0..8 {
        let frame = evaluator.evaluate(0.2 * f64::from(step)).unwrap();
        let mesh = Arc::clone(&frame.surfaces[3].mesh);
        held.push((mesh.vertices().to_vec(), mesh));
    }
    for (vertices, mesh) in &held {
        assert_eq!(mesh.vertices(), vertices);
    }
}

#[test]
fn memory_goes_around_once_nobody_holds_it() {
    let mut evaluator = evaluator(mixed());
    let mut addresses = Vec::new();
    for step in 0..20 {
        let frame = evaluator.evaluate(0.1 * f64::from(step)).unwrap();
        addresses.push(Arc::as_ptr(&frame.surfaces[2].mesh));
    }
    addresses.sort();
    addresses.dedup();
    assert_eq!(addresses.len(), 2);
}

/// Fails at odd seconds.
#[derive(Debug)]
struct Flaky;

impl AnimatedMesh for Flaky {
    fn time_range(&self) -> (f64, f64) {
        (f64::NEG_INFINITY, f64::INFINITY)
    }

    fn at(&self, time: f64) -> Result<SurfaceMesh, String> {
        if time % 2.0 == 1.0 { Err("file gone".to_owned()) } else { Ok(triangle()) }
    }
}

#[test]
fn a_frame_that_fails_leaves_the_one_before() {
    let objects = vec![
        object("flaky", None, Shape::Animated(Arc::new(Flaky))),
        object("fixed", None, Shape::Fixed(triangle())),
    ];
    let mut evaluator = evaluator(scene(vec![], objects));
    assert_eq!(changes(&mut evaluator, 0.0), [Added; 2]);
    let error = evaluator.evaluate(1.0).unwrap_err();
    assert!(matches!(error, SceneError::AnimatedMesh { .. }));
    assert_eq!(error.to_string(), "object \"flaky\" at 1 s: file gone");
    assert_eq!(changes(&mut evaluator, 2.0), [Retopologised, Unchanged]);
}
