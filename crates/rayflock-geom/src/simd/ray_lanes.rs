//! Sixteen consecutive rays of a batch as columns.

use super::axes::{Axes, absolute, largest, load_axes};
use super::{LANES, Lanes, Select, Simd, SimdBase, SimdMask, f32x16, mask32x16};
use crate::RayBatch;

/// Sixteen rays as columns, as they were asked.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct RayLanes {
    /// Origins by axis.
    pub origin: [Lanes; 3],
    /// Directions by axis.
    pub direction: [Lanes; 3],
    /// Smallest accepted `t`.
    pub t_min: Lanes,
    /// Largest accepted `t`.
    pub t_max: Lanes,
}

impl RayLanes {
    /// Rays without a direction.
    pub const EMPTY: Self = Self {
        origin: [[0.0; LANES]; 3],
        direction: [[0.0; LANES]; 3],
        t_min: [0.0; LANES],
        t_max: [0.0; LANES],
    };

    /// Sixteen rays of a batch from `first_ray` on; the last one again where there are no more.
    #[inline(always)]
    pub fn load<S: Simd>(simd: S, batch: &RayBatch<'_>, first_ray: usize) -> Self {
        let [ox, oy, oz] = batch.origin().axes(simd, first_ray);
        let [dx, dy, dz] = batch.direction().axes(simd, first_ray);
        Self {
            origin: [*ox, *oy, *oz],
            direction: [*dx, *dy, *dz],
            t_min: *batch.t_min().vector(simd, first_ray),
            t_max: *batch.t_max().vector(simd, first_ray),
        }
    }

    /// Makes rays look no farther than `t_bounds` tell, from the first lane on.
    #[inline(always)]
    pub fn bound<S: Simd>(&mut self, simd: S, t_bounds: &[f32]) {
        let Some(t_bounds) = t_bounds.first_chunk::<LANES>() else {
            for (t_max, &t_bound) in self.t_max.iter_mut().zip(t_bounds) {
                *t_max = t_max.min(t_bound);
            }
            return;
        };
        let load = f32x16::from_slice;
        let (t_bound, t_max) = (load(simd, t_bounds), load(simd, &self.t_max));
        t_bound.simd_lt(t_max).select(t_bound, t_max).store_slice(&mut self.t_max);
    }

    /// Which rays are active and which invalid, one bit a lane, as [`Ray::state`](crate::Ray::state)
    /// tells.
    #[inline(always)]
    pub fn states<S: Simd>(&self, simd: S) -> (u64, u64) {
        let infinity = f32x16::splat(simd, f32::INFINITY);
        let (origin, direction) = (load_axes(simd, &self.origin), load_axes(simd, &self.direction));
        let largest = largest(absolute(direction));
        let finite = are_finite(origin, infinity) & are_finite(direction, infinity);
        let (t_min, t_max) =
            (f32x16::from_slice(simd, &self.t_min), f32x16::from_slice(simd, &self.t_max));
        let numbers = t_min.simd_eq(t_min) & t_max.simd_eq(t_max);
        let valid = finite & largest.simd_gt(f32x16::splat(simd, 0.0)) & numbers;
        let active = valid & t_min.simd_le(t_max);
        (active.to_bitmask(), (!valid).to_bitmask())
    }
}

/// Where all coordinates are finite.
#[inline(always)]
fn are_finite<S: Simd>([x, y, z]: Axes<S>, infinity: f32x16<S>) -> mask32x16<S> {
    x.abs().simd_lt(infinity) & y.abs().simd_lt(infinity) & z.abs().simd_lt(infinity)
}
