//! Limbs: closed tubes around a line, each ring carried by joints.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::skeleton::JOINT_COUNT;
use crate::VertexInfluences;

/// How much each joint carries.
pub(super) type Weights = [f32; JOINT_COUNT];

/// All weight on one joint.
pub(super) fn only(joint: usize) -> Weights {
    let mut weights = [0.0; JOINT_COUNT];
    weights[joint] = 1.0;
    weights
}

/// Between two sets of weights.
pub(super) fn mix(a: Weights, b: Weights, share: f32) -> Weights {
    std::array::from_fn(|joint| a[joint] + share * (b[joint] - a[joint]))
}

/// The entries of weights that are not zero. At most four joints meet in these bodies.
pub(super) fn influences(weights: &Weights) -> VertexInfluences {
    let mut influences = VertexInfluences::default();
    let carried = weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0);
    let slots = influences.joints.iter_mut().zip(&mut influences.weights);
    for ((joint, weight), (joint_slot, weight_slot)) in carried.zip(slots) {
        (*joint_slot, *weight_slot) = (joint as u16, *weight);
    }
    influences
}

/// A cross-section of a limb.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ring {
    /// The middle.
    pub(super) center: Vec3,
    /// Half the width along the limb's first and second axis.
    pub(super) radii: Vec2,
    /// The joints that carry the left and the right half.
    pub(super) weights: [Weights; 2],
}

/// A ring that one set of joints carries.
pub(super) fn ring(center: [f32; 3], radii: [f32; 2], weights: Weights) -> Ring {
    Ring { center: Vec3::from(center), radii: Vec2::from(radii), weights: [weights; 2] }
}

/// A limb: rings between two closed ends.
#[derive(Clone, Debug)]
pub(super) struct Tube<'a> {
    /// The rings, from one end to the other; at least two. The ends close with a point at the
    /// middle of the first and the last.
    pub(super) rings: &'a [Ring],
    /// The directions that the radii are along; the limb runs along their cross product
    /// reversed: with +X and +Z, upward.
    pub(super) axes: [Vec3; 2],
    /// Vertices around.
    pub(super) sides: u32,
    /// Rings that are made for each one given.
    pub(super) pieces: u32,
}

impl Tube<'_> {
    /// Number of rings that are made.
    pub(super) fn ring_count(&self) -> u32 {
        (self.rings.len() as u32 - 1) * self.pieces + 1
    }

    /// The ring at place `idx` of those made: on a smooth curve through those given.
    pub(super) fn ring_at(&self, idx: u32) -> Ring {
        let last = self.rings.len() - 1;
        let before = ((idx / self.pieces) as usize).min(last - 1);
        let share = idx as f32 / self.pieces as f32 - before as f32;
        let [a, b] = [self.rings[before], self.rings[before + 1]];
        let [first, fourth] =
            [self.rings[before.saturating_sub(1)], self.rings[(before + 2).min(last)]];
        let radii = catmull_rom([first, a, b, fourth].map(|ring| ring.radii.extend(0.0)), share);
        Ring {
            center: catmull_rom([first, a, b, fourth].map(|ring| ring.center), share),
            radii: radii.truncate().max(a.radii.min(b.radii)),
            weights: [0, 1].map(|side: usize| mix(a.weights[side], b.weights[side], share)),
        }
    }

    /// The place and weights of side `side` of a ring.
    pub(super) fn vertex(&self, ring: &Ring, side: u32) -> (Vec3, Weights) {
        let (sin, cos) = (TAU * side as f32 / self.sides as f32).sin_cos();
        let across = cos * ring.radii.x * self.axes[0] + sin * ring.radii.y * self.axes[1];
        let [left, right] = ring.weights;
        (ring.center + across, mix(right, left, 0.5 + 0.5 * cos))
    }
}

/// The curve of E. Catmull and R. Rom ("A Class of Local Interpolating Splines", 1974) between
/// the second and the third of four points.
fn catmull_rom([a, b, c, d]: [Vec3; 4], t: f32) -> Vec3 {
    let (tangent_b, tangent_c) = (0.5 * (c - a), 0.5 * (d - b));
    let (t2, t3) = (t * t, t * t * t);
    (2.0 * t3 - 3.0 * t2 + 1.0) * b
        + (t3 - 2.0 * t2 + t) * tangent_b
        + (3.0 * t2 - 2.0 * t3) * c
        + (t3 - t2) * tangent_c
}
