//! Where the liquid is: below waves or in a drop, and in the tank.
//!
//! A field is negative inside, positive outside, and near the surface about the distance to it.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};
use rayflock_geom::Sphere;

use super::{DURATION, TANK};

/// Height of the liquid at rest.
const LEVEL: f32 = 0.46;
/// The liquid stays this far from the panes and from the bottom.
const GAP: f32 = 0.015;
/// Surfaces nearer than this flow together.
const BLEND: f32 = 0.11;

/// A standing wave: half waves along the tank's width and depth, height, rounds in an animation,
/// and where in a round it begins.
const WAVES: [([f32; 2], f32, f32, f32); 5] = [
    ([1.0, 0.0], 0.110, 5.0, 0.00),
    ([2.0, 0.0], 0.045, 7.0, 0.30),
    ([0.0, 1.0], 0.040, 7.0, 0.10),
    ([3.0, 1.0], 0.022, 9.0, 0.55),
    ([4.0, 2.0], 0.012, 12.0, 0.80),
];

/// The liquid at one time.
#[derive(Debug)]
pub(super) struct Field {
    /// The height of each of [`WAVES`] now.
    swings: [f32; WAVES.len()],
    drops: Vec<Sphere>,
}

impl Field {
    /// The field at `time` in seconds, with these drops in the air.
    pub(super) fn new(time: f32, drops: Vec<Sphere>) -> Self {
        let swing = |(_, height, rounds, start): ([f32; 2], f32, f32, f32)| {
            height * (TAU * (rounds * time / DURATION + start)).cos()
        };
        Self { swings: WAVES.map(swing), drops }
    }

    /// The height of the waves at `x` and `z`.
    pub(super) fn wave_height(&self, place: Vec2) -> f32 {
        let across = PI * (place + Vec2::new(TANK.x, TANK.z)) / (2.0 * Vec2::new(TANK.x, TANK.z));
        let waves = WAVES.iter().zip(self.swings);
        let heights = waves.map(|(([along_x, along_z], ..), swing)| {
            swing * (along_x * across.x).cos() * (along_z * across.y).cos()
        });
        LEVEL + heights.sum::<f32>()
    }

    /// The field at `point`, above or below which the waves have `wave_height`.
    pub(super) fn at(&self, point: Vec3, wave_height: f32) -> f32 {
        let waves = point.y - wave_height;
        let liquid = self.drops.iter().fold(waves, |nearest, drop| {
            joined(nearest, point.distance(drop.center) - drop.radius)
        });
        liquid.max(outside_tank(point))
    }
}

/// The union of two fields, rounded where they meet.
fn joined(a: f32, b: f32) -> f32 {
    let overlap = (1.0 - (a - b).abs() / BLEND).max(0.0);
    a.min(b) - 0.25 * BLEND * overlap * overlap
}

/// How far a point is outside of the room for the liquid.
fn outside_tank(point: Vec3) -> f32 {
    let beside = point.abs() - (TANK - GAP);
    beside.x.max(beside.z).max(beside.y).max(GAP - point.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drops_and_waves_are_inside_and_the_air_is_not() {
        let drop = Sphere::new(Vec3::new(0.3, 1.0, 0.1), 0.05);
        let field = Field::new(1.3, vec![drop]);
        let at = |point: Vec3| field.at(point, field.wave_height(Vec2::new(point.x, point.z)));
        assert!(at(drop.center) < 0.0 && at(Vec3::new(0.5, 0.1, -0.2)) < 0.0);
        assert!(at(drop.center + Vec3::Y * 0.07) > 0.0);
        assert!(at(Vec3::new(TANK.x, 0.1, 0.0)) > 0.0 && at(Vec3::ZERO) > 0.0);
    }

    #[test]
    fn near_surfaces_flow_together() {
        assert_eq!(joined(0.5, 0.1), 0.1);
        assert!(joined(0.02, 0.02) < 0.0);
    }
}
