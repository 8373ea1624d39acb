//! Frames do not depend on the frames before them, and what they say has changed is exact.

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};
use proptest::prelude::*;
use rayflock_geom::ObjectChange;
use rayflock_scene::{
    Channel, ChannelValues, Clip, Evaluator, Interpolation, NodeIdx, Scene, SceneFrame, Shape,
    VertexFrames, VertexKey,
};

use crate::build::{morphed, node, object, scene, triangle, two_joints};

fn channel(node: u32) -> impl Strategy<Value = Channel> {
    let key = prop::array::uniform4(-1.0..1.0_f32);
    (prop::collection::vec(key, 3), 0..4, any::<bool>()).prop_map(move |(keys, kind, step)| {
        let vectors = || keys.iter().map(|key| Vec3::from_slice(key)).collect();
        let rotations = || keys.iter().map(|&key| Quat::from_array(key).normalize()).collect();
        let values = match kind {
            0 => ChannelValues::Translation(vectors()),
            1 => ChannelValues::Scale(vectors()),
            2 => ChannelValues::Rotation(rotations()),
            _ => {
                let values = keys.iter().map(|key| key[0]).collect();
                ChannelValues::Weights { weights_per_key: 1, values }
            }
        };
        let interpolation = if step { Interpolation::Step } else { Interpolation::Linear };
        Channel { node: NodeIdx(node), times: vec![0.0, 0.75, 1.5], interpolation, values }
    })
}

fn moving_scene() -> impl Strategy<Value = Scene> {
    (channel(0), channel(1), channel(2)).prop_map(|(a, b, c)| {
        let nodes = vec![node(None, Vec3::X), node(Some(0), Vec3::Y), node(None, Vec3::ZERO)];
        let key = |time: f64| {
            let positions = vec![Vec3::splat(time as f32), Vec3::X, Vec3::Y];
            VertexKey { time, positions, normals: vec![Vec3::Z; 3] }
        };
        let cloth =
            VertexFrames::new(&triangle(), vec![key(0.5), key(1.0)]).expect("times increase");
        let objects = vec![
            object("rigid", Some(1), Shape::Fixed(triangle())),
            object("morphed", Some(2), morphed(None)),
            object("skinned", Some(2), morphed(Some(two_joints(0, 1)))),
            object("cloth", Some(0), Shape::Animated(Arc::new(cloth))),
        ];
        let mut scene = scene(nodes, objects);
        scene.clips = vec![Clip { name: String::new(), channels: vec![a, b, c] }];
        scene
    })
}

/// All that can be seen of one object.
fn look(frame: &SceneFrame, idx: usize) -> (Vec<Vec3>, Vec<Vec3>, Option<Affine3A>) {
    let (object, surface) = (&frame.geometry.objects()[idx], &frame.surfaces[idx]);
    assert!(Arc::ptr_eq(&object.shape, &surface.mesh));
    (surface.mesh.vertices().to_vec(), surface.normals.to_vec(), object.world_from_object)
}

fn check_change(before: &SceneFrame, now: &SceneFrame, idx: usize) -> Result<(), TestCaseError> {
    let id = now.geometry.objects()[idx].id;
    let (old, new) = (look(before, idx), look(now, idx));
    match now.changes.get(id) {
        ObjectChange::Unchanged => prop_assert_eq!(old, new),
        ObjectChange::Transformed => {
            prop_assert_eq!((old.0, old.1), (new.0, new.1));
            prop_assert_ne!(old.2, new.2);
        }
        ObjectChange::Deformed => {
            let meshes = [before, now].map(|frame| &frame.surfaces[idx].mesh);
            prop_assert!(meshes[1].has_topology_of(meshes[0]));
        }
        other => prop_assert!(false, "object {id:?} is {other:?}"),
    }
    Ok(())
}

proptest! {
    #[test]
    fn frames_are_the_same_whatever_came_before(
        scene in moving_scene(),
        // Quarters of seconds, so that the same time comes up often.
        quarters in prop::collection::vec(-3..12_i32, 2..12),
    ) {
        let scene = Arc::new(scene);
        let mut evaluator = Evaluator::new(Arc::clone(&scene), None).unwrap();
        let mut before: Option<SceneFrame> = None;
        for quarter in quarters {
            let time = 0.25 * f64::from(quarter);
            let frame = evaluator.evaluate(time).unwrap().clone();
            let mut fresh = Evaluator::new(Arc::clone(&scene), None).unwrap();
            let alone = fresh.evaluate(time).unwrap();
            for idx in 0..scene.objects.len() {
                prop_assert_eq!(look(&frame, idx), look(alone, idx));
                if let Some(before) = &before {
                    check_change(before, &frame, idx)?;
                }
            }
            before = Some(frame);
        }
    }
}
