//! How much of a light comes past a flat wall to each of sixteen points.
//!
//! A wall is a parallelogram; the segments from the points to the light are cut with its plane.
//!
//! **Invariants.** Without fused multiply-add: the same bits at every level. A segment with both
//! ends on one side of the plane is not dimmed.
//!
//! **Cost.** About 35 operations and a division for sixteen points.

use glam::Vec3;

use super::axes::{dot, load_axes, splat_axes, subtract};
use super::segment_spheres::PointBlock;
use super::{Select, Simd, SimdBase, f32x16};

/// A parallelogram that dims what goes through it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    corner: Vec3,
    /// Of unit length.
    normal: Vec3,
    /// Products of these and an offset from the corner are its coordinates: from 0 to 1 within.
    axes: [Vec3; 2],
    /// The share of light that it takes away.
    opacity: f32,
}

impl Wall {
    /// The wall between a corner and two edges from there; `None` without area. The normal is that
    /// of the first edge turned to the second.
    pub fn new(corner: Vec3, [first, second]: [Vec3; 2], opacity: f32) -> Option<Self> {
        let across = first.cross(second);
        let (normal, squared) = (across.try_normalize()?, across.length_squared());
        let axes = [second.cross(across) / squared, across.cross(first) / squared];
        axes.iter().all(|axis| axis.is_finite()).then_some(Self { corner, normal, axes, opacity })
    }

    /// The corner.
    pub const fn corner(&self) -> Vec3 {
        self.corner
    }

    /// Across the wall, of unit length.
    pub const fn normal(&self) -> Vec3 {
        self.normal
    }

    /// Products of these and an offset from the corner are its coordinates along both edges: from 0
    /// to 1 within.
    pub const fn axes(&self) -> [Vec3; 2] {
        self.axes
    }

    /// The share of light that the wall takes away.
    pub const fn opacity(&self) -> f32 {
        self.opacity
    }

    /// How far a point lies above the plane, on the side of the normal.
    #[inline]
    pub fn height(&self, point: Vec3) -> f32 {
        self.normal.dot(point - self.corner)
    }
}

/// The share of light from `light` that comes past a wall to each of sixteen points.
#[inline(always)]
pub fn past_wall<S: Simd>(simd: S, points: &PointBlock, light: Vec3, wall: &Wall) -> f32x16<S> {
    let splat = f32x16::splat;
    let (zero, one) = (splat(simd, 0.0), splat(simd, 1.0));
    let to_light = light - wall.corner;
    let offset = subtract(load_axes(simd, &points.position), splat_axes(simd, wall.corner));

    // Where on its way each segment meets the plane, if it does.
    let height = dot(offset, splat_axes(simd, wall.normal));
    let light_height = splat(simd, wall.normal.dot(to_light));
    let mut is_hit = (height * light_height).simd_lt(zero);
    let share = height / (height - light_height);
    for axis in wall.axes {
        let from = dot(offset, splat_axes(simd, axis));
        let at = from + share * (splat(simd, axis.dot(to_light)) - from);
        is_hit = is_hit & at.simd_ge(zero) & at.simd_le(one);
    }
    is_hit.select(splat(simd, 1.0 - wall.opacity), one)
}

#[cfg(test)]
mod tests {
    use super::super::{LANES, Lanes, SimdLevel, dispatch};
    use super::*;

    #[test]
    fn a_wall_hides_what_is_behind_it_and_within_its_edges() {
        let edges = [4.0 * Vec3::X, Vec3::new(1.0, 0.0, -2.0)];
        let wall = Wall::new(Vec3::ZERO, edges, 0.75).unwrap();
        assert!((wall.height(Vec3::new(9.0, 3.0, 1.0)) - 3.0).abs() < 1e-6);
        let light = Vec3::new(2.0, -1.0, -1.0);
        let mut points = PointBlock::splat(Vec3::ZERO, Vec3::Y);
        let at = [
            // Through the middle, beside either edge, below the plane, at the light.
            (Vec3::new(2.0, 1.0, -1.0), 0.25),
            (Vec3::new(2.0, 1.0, 1.5), 1.0),
            (Vec3::new(9.0, 1.0, -1.0), 1.0),
            (Vec3::new(2.0, -0.5, -1.0), 1.0),
            (light, 1.0),
        ];
        for (lane, (point, _)) in at.iter().enumerate() {
            points.set(lane, *point, Vec3::Y);
        }
        let at_level = |level: SimdLevel| -> Lanes {
            dispatch!(level.level(), simd => *past_wall(simd, &points, light, &wall))
        };
        let found: Vec<Lanes> = SimdLevel::available().into_iter().map(at_level).collect();
        for (lane, (_, expected)) in at.iter().enumerate() {
            assert!(found.iter().all(|lanes| lanes[lane] == *expected), "{lane}: {found:?}");
        }
        assert_eq!(found[0].len(), LANES);
        assert_eq!(Wall::new(Vec3::ZERO, [Vec3::X, 2.0 * Vec3::X], 1.0), None);
    }
}
