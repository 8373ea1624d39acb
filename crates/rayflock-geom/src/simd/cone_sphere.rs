//! Which of sixteen bounding spheres the rays of a sphere-cone may touch.
//!
//! See [`SphereCone`] for the test. Rejecting only: everything is enlarged by a slack that covers
//! the rounding of this test and of the accepting tests behind it, so a primitive that any ray of
//! the cone hits is never rejected.

use glam::Vec3;

use super::axes::{dot, load_axes, splat_axes, store_axes, subtract};
use super::ray_triangle::DEPTH_ERROR;
use super::{Lanes, Simd, SimdBase, SimdFloat, f32x16, mask32x16};
use crate::{Sphere, SphereCone};

/// The least slack relative to distances: [`PERTURBATION`](super::ray_triangle::PERTURBATION) for
/// what the accepting test may move sideways, and three times that for the distances measured
/// here. What its `t` may be off is relative to the radius:
/// [`DEPTH_ERROR`].
pub const SLACK: f32 = 4.0 * super::ray_triangle::PERTURBATION;

/// Sixteen bounding spheres as columns.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct SphereBlock {
    /// Centres by axis.
    pub center: [Lanes; 3],
    /// Radii; minus infinity for a lane that nothing may touch.
    pub radius: Lanes,
}

impl SphereBlock {
    /// Sixteen spheres that nothing touches.
    pub const EMPTY: Self = Self { center: [[0.0; 16]; 3], radius: [f32::NEG_INFINITY; 16] };

    /// Writes the sphere of one lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, sphere: &Sphere) {
        for (column, coordinate) in self.center.iter_mut().zip(sphere.center.to_array()) {
            column[lane] = coordinate;
        }
        self.radius[lane] = sphere.radius;
    }

    /// The sphere of one lane.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> Sphere {
        let [x, y, z] = &self.center;
        Sphere::new(Vec3::new(x[lane], y[lane], z[lane]), self.radius[lane])
    }

    /// The sixteen spheres as vectors.
    #[inline(always)]
    pub fn load<S: Simd>(&self, simd: S) -> SphereLanes<S> {
        SphereLanes {
            center: load_axes(simd, &self.center),
            radius: f32x16::from_slice(simd, &self.radius),
        }
    }
}

/// Sixteen bounding spheres in registers.
#[derive(Clone, Copy, Debug)]
pub struct SphereLanes<S: Simd> {
    /// Centres by axis.
    pub center: [f32x16<S>; 3],
    /// Radii; minus infinity for a lane that nothing may touch.
    pub radius: f32x16<S>,
}

impl<S: Simd> SphereLanes<S> {
    /// Writes all lanes of a block.
    #[inline(always)]
    pub fn store(&self, block: &mut SphereBlock) {
        store_axes(&self.center, &mut block.center);
        self.radius.store_slice(&mut block.radius);
    }
}

/// How far along its rays a cone reaches, as distances from their origins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// No ray accepts a hit nearer than this.
    pub near: f32,
    /// No ray accepts a hit farther than this.
    pub far: f32,
}

/// Which spheres the cone may touch within its reach, and for each a lower bound on the distance
/// from any ray's origin at which that happens (negative when an origin may lie inside).
///
/// Only rays that look forward are bounded by a cone: `reach.near` must not be negative.
/// `slack` is relative to the distances at hand, at least [`SLACK`].
#[inline(always)]
pub fn touches<S: Simd>(
    simd: S,
    cone: &SphereCone,
    reach: Reach,
    slack: f32,
    spheres: &SphereLanes<S>,
) -> (mask32x16<S>, f32x16<S>) {
    let splat = f32x16::splat;
    let axis = splat_axes(simd, cone.axis);
    let v = subtract(spheres.center, splat_axes(simd, cone.origin.center));
    let radius = spheres.radius * splat(simd, 1.0 + DEPTH_ERROR) + splat(simd, cone.origin.radius);
    let along = dot(v, axis);
    let across = subtract(v, [along * axis[0], along * axis[1], along * axis[2]]);
    let distance = dot(v, v).sqrt();
    let enlarged = radius + splat(simd, slack) * (distance + radius);

    // Comparisons are negated so that an overflow to NaN keeps the sphere.
    let outside =
        dot(across, across).sqrt() * splat(simd, cone.cos) - along * splat(simd, cone.sin);
    let beside = outside.simd_gt(enlarged);
    let forward = splat(simd, if cone.cos > 0.0 { 1.0 } else { 0.0 });
    let behind = (along * forward).simd_lt(-enlarged);
    let nearest = distance - enlarged;
    let beyond = nearest.simd_gt(splat(simd, reach.far));
    let before = (distance + enlarged).simd_lt(splat(simd, reach.near));
    (!(beside | behind | beyond | before), nearest)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::{SimdLevel, SimdMask, dispatch};
    use super::*;

    fn vector(scale: f32) -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-1.0..1.0_f32).prop_map(move |v| scale * Vec3::from(v))
    }

    /// Whether the sphere is kept, and the distance bound, at every level.
    fn outcomes(cone: &SphereCone, reach: Reach, sphere: &Sphere) -> Vec<(bool, f32)> {
        let mut block = SphereBlock::EMPTY;
        block.set(7, sphere);
        let at_level = |level: SimdLevel| {
            dispatch!(level.level(), simd => {
                let (kept, nearest) = touches(simd, cone, reach, SLACK, &block.load(simd));
                assert_eq!(kept.to_bitmask() & !(1 << 7), 0, "empty lanes are rejected");
                (kept.test(7), nearest[7])
            })
        };
        SimdLevel::available().into_iter().map(at_level).collect()
    }

    const FORWARD: Reach = Reach { near: 0.0, far: f32::INFINITY };

    proptest! {
        /// A sphere around a point of a ray is never rejected, and the bound holds.
        #[test]
        fn no_touched_sphere_is_rejected(
            rays in prop::collection::vec((vector(1.0), vector(1.0)), 1..8),
            main in vector(1.0), spread in prop_oneof![Just(0.0_f32), Just(1e-3), Just(0.3), Just(2.0)],
            shift in prop_oneof![Just(0.0_f32), Just(1e3), Just(1e6)],
            pick in 0..8_usize, t in 0.0..100.0_f32, beside in vector(1.0), radius in 1e-6..10.0_f32,
        ) {
            let rays: Vec<_> = rays
                .into_iter()
                .map(|(origin, noise)| {
                    (Vec3::splat(shift) + origin, (main + spread * noise).normalize_or(Vec3::X))
                })
                .collect();
            let cone = SphereCone::around_rays(rays.iter().copied());
            let (origin, direction) = rays[pick % rays.len()];
            let center = origin + t * direction + 0.999 * radius * beside.normalize_or(Vec3::X);
            let sphere = Sphere::new(center, radius + 1e-6 * center.length());
            for (kept, nearest) in outcomes(&cone, FORWARD, &sphere) {
                prop_assert!(kept, "{sphere:?} was rejected by {cone:?}");
                prop_assert!(nearest <= t * (1.0 + 1e-6), "{nearest} > {t}");
            }
        }
    }

    #[test]
    fn spheres_beside_behind_and_out_of_reach_are_rejected() {
        let cone = SphereCone::around_rays([(Vec3::ZERO, Vec3::Z)].into_iter());
        let kept = |reach, x: f32, z: f32| {
            let all = outcomes(&cone, reach, &Sphere::new(Vec3::new(x, 0.0, z), 1.0));
            assert!(all.windows(2).all(|pair| pair[0].0 == pair[1].0));
            all[0].0
        };
        assert!(kept(FORWARD, 0.9, 10.0));
        assert!(!kept(FORWARD, 1.1, 10.0));
        assert!(!kept(FORWARD, 0.0, -1.1));
        assert!(!kept(Reach { near: 0.0, far: 8.9 }, 0.0, 10.0));
        assert!(!kept(Reach { near: 11.1, far: 20.0 }, 0.0, 10.0));
        assert!(kept(Reach { near: 10.9, far: 20.0 }, 0.0, 10.0));
    }

    #[test]
    fn overflow_keeps_the_sphere() {
        let cone = SphereCone::around_rays([(Vec3::ZERO, Vec3::Z)].into_iter());
        let far = Sphere::new(Vec3::new(0.0, 0.0, 1e30), 1.0);
        assert!(outcomes(&cone, FORWARD, &far).iter().all(|outcome| outcome.0));
    }
}
