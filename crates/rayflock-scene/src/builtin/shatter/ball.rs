//! The steel ball that strikes the knot: straight on until it strikes, then a body in flight.

use glam::Vec3;
use rayflock_geom::{Mesh, Sphere};

use super::flight::Flight;
use super::{IMPACT, IMPACT_TIME};
use crate::builtin::keyed_path::translation_channel;
use crate::{Channel, NodeIdx};

const RADIUS: f32 = 0.3;
/// The ball's velocity until it strikes, in scene units per second.
pub(super) const VELOCITY: Vec3 = Vec3::new(2.6, -0.35, -1.15);
/// Its velocity after.
const SLOWED: Vec3 = Vec3::new(0.95, 0.3, -0.6);

/// The ball around the origin of its node.
pub(super) fn mesh() -> Mesh {
    Mesh::from_spheres(vec![Sphere::new(Vec3::ZERO, RADIUS)])
}

/// Where the ball is at `time`, in seconds.
pub(super) fn center(time: f32) -> Vec3 {
    if time < IMPACT_TIME {
        return IMPACT + (time - IMPACT_TIME) * VELOCITY;
    }
    let rest = Vec3::Y * RADIUS;
    let (start, velocity) = (IMPACT - rest, SLOWED);
    let flight = Flight { launch: IMPACT_TIME, start, velocity, axis: Vec3::Y, turn: 0.0 };
    flight.position(time) + rest
}

/// The channel that moves the ball's node.
pub(super) fn channel(node: NodeIdx, times: &[f32]) -> Channel {
    translation_channel(node, times, center)
}
