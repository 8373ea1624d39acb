//! Where the vertices of bent meshes are, against values found by hand.

use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};
use rayflock_scene::{ChannelValues, Evaluator, Shape};

use crate::build::{
    clip, evaluator, morphed, node, object, scene, slide, triangle, two_joints, weights,
};

/// Positions and normals of object 0, and whether it has a transform.
fn posed(evaluator: &mut Evaluator, time: f64) -> (Vec<Vec3>, Vec<Vec3>, Option<Affine3A>) {
    let frame = evaluator.evaluate(time).expect("the scene can be evaluated");
    let surface = &frame.surfaces[0];
    let place = frame.geometry.objects()[0].world_from_object;
    (surface.mesh.vertices().to_vec(), surface.normals.to_vec(), place)
}

fn assert_close(found: &[Vec3], expected: &[Vec3]) {
    let close = found.iter().zip(expected).all(|(a, b)| a.abs_diff_eq(*b, 1e-5));
    assert!(close && found.len() == expected.len(), "{found:?}, expected {expected:?}");
}

#[test]
fn two_joints_carry_their_vertices_into_world_space() {
    // The second joint hangs on the first, which stands at X; it makes a quarter turn about Z.
    let nodes = vec![node(None, Vec3::X), node(Some(0), Vec3::ZERO), node(None, 50.0 * Vec3::ONE)];
    let shape = Shape::Deformed {
        rest: triangle(),
        targets: Arc::default(),
        skin: Some(Arc::new(two_joints(0, 1))),
    };
    // The object's own node, far away, has no effect.
    let mut scene = scene(nodes, vec![object("skinned", Some(2), shape)]);
    let turns = [Quat::IDENTITY, Quat::from_rotation_z(2.0 * FRAC_PI_2 * 0.999)];
    scene.clips = vec![clip(vec![(1, ChannelValues::Rotation(turns.to_vec()))])];
    let mut evaluator = evaluator(scene);
    let (at_rest, _, place) = posed(&mut evaluator, 0.0);
    assert_close(&at_rest, &[Vec3::X, 2.0 * Vec3::X, Vec3::X + Vec3::Y]);
    assert_eq!(place, None);

    // At one second, the turn is 0.999 quarters. The third corner lies midway between Y and its
    // turned image, -X.
    let (turned, normals, _) = posed(&mut evaluator, 1.0);
    let image = |p: Vec3| Quat::from_rotation_z(FRAC_PI_2 * 0.999) * p;
    let midway = 0.5 * (Vec3::Y + image(Vec3::Y));
    assert_close(&turned, &[Vec3::X, Vec3::X + image(Vec3::X), Vec3::X + midway]);
    assert_close(&normals, &[Vec3::Z; 3]);
}

#[test]
fn the_bind_matrix_comes_first() {
    let mut skin = two_joints(0, 0);
    for (_, joint_from_rest) in &mut skin.joints {
        *joint_from_rest = Affine3A::from_translation(-Vec3::X);
    }
    let mut turned = node(None, Vec3::X);
    turned.rest = rayflock_scene::LocalTransform::Matrix(Affine3A::from_rotation_translation(
        Quat::from_rotation_z(FRAC_PI_2),
        Vec3::X,
    ));
    let shape =
        Shape::Deformed { rest: triangle(), targets: Arc::default(), skin: Some(Arc::new(skin)) };
    let mut evaluator = evaluator(scene(vec![turned], vec![object("bound", None, shape)]));
    // A quarter turn about the point X.
    let (positions, _, _) = posed(&mut evaluator, 0.0);
    assert_close(&positions, &[Vec3::X - Vec3::Y, Vec3::X, -Vec3::Y]);
}

#[test]
fn morphs_follow_weights_of_the_clip_then_joints() {
    let nodes = vec![node(None, Vec3::ZERO), node(None, 3.0 * Vec3::Y)];
    let objects = vec![object("both", Some(0), morphed(Some(two_joints(0, 1))))];
    let mut scene = scene(nodes, objects);
    scene.clips = vec![clip(vec![(0, weights(1, &[0.0, 1.0]))])];
    let (positions, _, _) = posed(&mut evaluator(scene), 0.5);
    // Corner 1 is lifted by a quarter, then carried by the second joint; corner 2 goes halfway.
    let expected = [Vec3::ZERO, Vec3::new(1.0, 3.0, 0.25), Vec3::new(0.0, 2.5, 0.0)];
    assert_close(&positions, &expected);
}

#[test]
fn without_a_clip_weights_are_those_at_rest() {
    let mut carrier = node(None, Vec3::X);
    carrier.rest_weights = vec![0.5];
    let objects =
        vec![object("morphed", Some(0), morphed(None)), object("bare", None, morphed(None))];
    let mut evaluator = evaluator(scene(vec![carrier], objects));
    let (positions, _, place) = posed(&mut evaluator, 7.0);
    assert_close(&positions, &[Vec3::ZERO, Vec3::new(1.0, 0.0, 0.5), Vec3::Y]);
    assert_eq!(place, Some(Affine3A::from_translation(Vec3::X)));
    // An object without node has no weights.
    let bare = &evaluator.evaluate(7.0).unwrap().surfaces[1];
    assert_eq!(bare.mesh.vertices(), triangle().mesh.vertices());
}

#[test]
fn clips_repeat() {
    let objects = vec![object("slides", Some(0), Shape::Fixed(triangle()))];
    let mut scene = scene(vec![node(None, Vec3::ZERO)], objects);
    scene.clips = vec![clip(vec![(0, slide(Vec3::ZERO, Vec3::X))])];
    let mut evaluator = evaluator(scene);
    let mut x = |time| posed(&mut evaluator, time).2.unwrap().translation.x;
    assert_eq!([0.5, 2.5, -1.5, 200.5].map(&mut x), [0.25; 4]);
    assert_eq!((x(2.0), x(2.0_f64.next_down())), (0.0, 1.0));
}
