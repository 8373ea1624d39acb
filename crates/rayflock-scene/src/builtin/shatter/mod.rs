//! `shatter`: a porcelain knot is struck by a steel ball, and every triangle flies off on its own.
//!
//! Nothing that was near a triangle stays near it, so bounds over the whole knot, refitted from
//! frame to frame, soon enclose everything: the scene for which Rayflock was made.
//!
//! The ball strikes at [`IMPACT_TIME`], a quarter into the animation. A crack runs through the
//! knot at constant speed and lets each triangle go; from there on it is a body of its own (see
//! [`flight`]). Time is slow, as gravity tells.
//!
//! **Invariants.** Before the strike the knot is closed and does not change; at no time is a
//! vertex below the floor; at the end all lies still.

mod ball;
mod flight;
mod fragments;
mod knot;
mod stage;

use std::sync::Arc;

use glam::Vec3;

use super::keyed_path::key_times;
use super::{matte, node, object, polished};
use crate::{
    Clip, Fresnel, Material, MaterialIdx, NodeIdx, Scene, SceneObject, Shape, SurfaceMesh,
};

/// Frames of the animation.
pub(super) const FRAME_COUNT: usize = 240;
const FRAME_RATE: f32 = 24.0;
/// Length of the animation in seconds.
const DURATION: f32 = FRAME_COUNT as f32 / FRAME_RATE;

/// When the ball strikes, in seconds, and where.
const IMPACT_TIME: f32 = 2.5;
const IMPACT: Vec3 = Vec3::new(-0.72, 2.0, 0.35);
/// Downward acceleration, in scene units per square second: slow motion.
const GRAVITY: f32 = 1.1;

const PORCELAIN: MaterialIdx = MaterialIdx(0);
const COBALT: MaterialIdx = MaterialIdx(1);
const GOLD: MaterialIdx = MaterialIdx(2);
const STEEL: MaterialIdx = MaterialIdx(3);
const STAGE: MaterialIdx = MaterialIdx(4);

const CAMERA_NODE: NodeIdx = NodeIdx(0);
const BALL_NODE: NodeIdx = NodeIdx(1);

/// The scene.
pub(super) fn build() -> Scene {
    let times = key_times(DURATION, FRAME_COUNT);
    let mut channels = stage::camera_channels(CAMERA_NODE, &times);
    channels.push(ball::channel(BALL_NODE, &times));
    let knot = SceneObject {
        name: "knot".to_owned(),
        node: None,
        mask: u32::MAX,
        shape: Shape::Animated(Arc::new(fragments::Fragments::new(knot::surface()))),
    };
    Scene {
        name: "shatter".to_owned(),
        nodes: vec![node("camera", None, Vec3::ZERO), node("ball", None, ball::center(0.0))],
        objects: vec![
            object("stage", None, stage::surface()),
            object("ball", Some(BALL_NODE), SurfaceMesh::new(ball::mesh(), STEEL)),
            knot,
        ],
        materials: materials(),
        lights: stage::lights(),
        cameras: vec![stage::camera(CAMERA_NODE)],
        clips: vec![Clip { name: "strike".to_owned(), channels }],
        ambient: Vec3::new(0.16, 0.17, 0.20),
        background: Some(stage::background()),
        frame_rate: Some(f64::from(FRAME_RATE)),
        ..Scene::default()
    }
}

fn materials() -> Vec<Material> {
    vec![
        glazed("porcelain", Vec3::new(0.80, 0.77, 0.70)),
        glazed("cobalt", Vec3::new(0.03, 0.08, 0.38)),
        Material {
            mirror: Vec3::new(0.75, 0.55, 0.25),
            ..polished("gold", Vec3::new(0.30, 0.19, 0.05), 0.5)
        },
        Material {
            fresnel: Fresnel::Constant,
            ..polished("steel", Vec3::new(0.05, 0.05, 0.06), 0.7)
        },
        matte("stage", Vec3::new(0.22, 0.22, 0.24)),
    ]
}

/// Glaze shines, but mirrors nothing: twenty thousand little mirrors would send rays everywhere for
/// a glimmer that the highlight gives as well.
fn glazed(name: &str, color: Vec3) -> Material {
    Material { specular: Vec3::splat(0.35), shininess: 60.0, ..matte(name, color) }
}

#[cfg(test)]
mod tests {
    use crate::{AnimatedMesh, Shape};

    use super::*;

    fn vertices_at(scene: &Scene, time: f32) -> Vec<Vec3> {
        let Shape::Animated(knot) = &scene.objects[2].shape else {
            panic!("the knot is animated");
        };
        let knot: &dyn AnimatedMesh = knot.as_ref();
        knot.at(f64::from(time)).unwrap().mesh.vertices().to_vec()
    }

    #[test]
    fn nothing_passes_through_the_floor_or_leaves_the_stage() {
        let scene = build();
        for frame in (0..=FRAME_COUNT).step_by(8) {
            for vertex in vertices_at(&scene, frame as f32 / FRAME_RATE) {
                assert!(vertex.y >= 0.0, "frame {frame}: {vertex}");
                assert!(
                    vertex.with_y(0.0).length() < stage::FLOOR_RADIUS,
                    "frame {frame}: {vertex}"
                );
            }
        }
    }

    #[test]
    fn all_lies_still_on_the_floor_at_the_end() {
        let scene = build();
        let end = vertices_at(&scene, DURATION);
        assert_eq!(end, vertices_at(&scene, DURATION - 1.0 / FRAME_RATE));
        assert!(end.iter().all(|vertex| vertex.y < 0.1));
    }

    #[test]
    fn no_triangle_jumps() {
        let scene = build();
        let step = 1.0 / 96.0;
        for frame in 60..140 {
            let time = frame as f32 / FRAME_RATE;
            let pairs = vertices_at(&scene, time).into_iter().zip(vertices_at(&scene, time + step));
            let farthest = pairs.map(|(a, b)| a.distance(b)).fold(0.0, f32::max);
            assert!(farthest < 8.0 * step, "frame {frame}: {farthest}");
        }
    }
}
