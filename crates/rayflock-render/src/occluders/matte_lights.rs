//! How much of a light on a matte surface, or of one that shines evenly, comes to each of sixteen
//! points, were nothing in the way.
//!
//! ```text
//!   cosine at the point . (cosine at the light + evenness) / distance^2
//! ```
//!
//! each cosine at least 0. That is the geometry term, which is bounded so that no light is too
//! bright. Times the intensity along the normal of the light, it is irradiance.
//!
//! **Invariants.** Without fused multiply-add: the same bits at every level. Finite for finite
//! input, and 0 for a point at the light.
//!
//! **Cost.** About 30 operations, a root and a division for sixteen points.

use glam::Vec3;
use rayflock_geom::simd::segment_spheres::PointBlock;
use rayflock_geom::simd::{Simd, SimdBase, SimdFloat, f32x16};

/// A light without a direction that it prefers, but for the normal of its surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MatteLight {
    /// Where it is.
    pub position: Vec3,
    /// Of unit length; zero where it has no surface.
    pub normal: Vec3,
    /// Added to the cosine: 0 for a surface, 1 for a point that shines evenly.
    pub evenness: f32,
}

/// The geometry term for each point, unbounded.
#[inline(always)]
pub(super) fn geometry_terms<S: Simd>(
    simd: S,
    points: &PointBlock,
    light: &MatteLight,
) -> f32x16<S> {
    let (splat, load) = (f32x16::splat, f32x16::from_slice);
    let zero = splat(simd, 0.0);
    let (mut squared, mut at_point, mut facing) = (zero, zero, zero);
    for axis in 0..3 {
        let offset = splat(simd, light.position[axis]) - load(simd, &points.position[axis]);
        squared += offset * offset;
        at_point += offset * load(simd, &points.normal[axis]);
        facing -= offset * splat(simd, light.normal[axis]);
    }
    let evenly = squared.sqrt() * splat(simd, light.evenness);
    let at_light = (facing + evenly).max(zero);
    // Both cosines are times the distance.
    let divisor = (squared * squared).max(splat(simd, f32::MIN_POSITIVE));
    at_point.max(zero) * at_light / divisor
}

#[cfg(test)]
mod tests {
    use rayflock_geom::simd::{LANES, Lanes, SimdLevel, dispatch};

    use super::*;

    fn at_every_level(points: &PointBlock, light: &MatteLight) -> Lanes {
        let at_level = |level: SimdLevel| -> Lanes {
            dispatch!(level.level(), simd => *geometry_terms(simd, points, light))
        };
        let found: Vec<_> = SimdLevel::available().into_iter().map(at_level).collect();
        for lanes in &found {
            assert_eq!(lanes.map(f32::to_bits), found[0].map(f32::to_bits));
        }
        found[0]
    }

    #[test]
    fn terms_are_cosines_over_the_squared_distance() {
        let light = MatteLight { position: 2.0 * Vec3::Y, normal: Vec3::NEG_Y, evenness: 0.0 };
        let mut points = PointBlock::splat(Vec3::ZERO, Vec3::Y);
        points.set(1, 2.0 * Vec3::X, Vec3::Y);
        points.set(2, Vec3::ZERO, Vec3::NEG_Y);
        points.set(3, 3.0 * Vec3::Y, Vec3::NEG_Y);
        points.set(4, 1.9 * Vec3::Y, Vec3::Y);
        points.set(5, light.position, Vec3::Y);
        let found = at_every_level(&points, &light);
        // Straight below, at 45 degrees, facing away, behind the light, near, at the light.
        let expected = [0.25, 0.5 / 8.0, 0.0, 0.0, 100.0, 0.0];
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() <= 1e-4 * expected, "{found} is not {expected}");
        }
        assert_eq!(found[LANES - 1], found[0]);
    }

    #[test]
    fn a_light_without_surface_shines_evenly() {
        let light = MatteLight { position: 2.0 * Vec3::Y, normal: Vec3::ZERO, evenness: 1.0 };
        let mut points = PointBlock::splat(Vec3::ZERO, Vec3::Y);
        points.set(1, 4.0 * Vec3::Y, Vec3::NEG_Y);
        let found = at_every_level(&points, &light);
        assert!((found[0] - 0.25).abs() < 1e-6 && (found[1] - 0.25).abs() < 1e-6);
    }
}
