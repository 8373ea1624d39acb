//! Which of sixteen boxes one ray may cross: the rejecting test of a tree of boxes.
//!
//! ```text
//!   middle = (c - o) / d      reach = (h + m) / |d|      for each axis; box: c - h .. c + h
//!   near   = max over the axes of middle - reach,  and t_min
//!   far    = min over the axes of middle + reach,  and t_max          crossed unless near > far
//! ```
//!
//! **Source.** T. Kay, J. Kajiya, "Ray Tracing Complex Scenes", SIGGRAPH 1986 (slabs); T. Ize,
//! "Robust BVH Ray Traversal", JCGT 2(2), 2013 (what rounding costs).
//!
//! **Departures.** Boxes are centre and half size, so that near and far need no choice by the
//! sign of the direction. The margin `m` is one length a ray, a part of the largest coordinate by
//! which anything in the boxes can lie from its origin (`farthest`), instead of ulps a box.
//! Directions are divided by their largest coordinate, so that tiny and huge ones do not overflow.
//!
//! **Invariants.** Let a hit be accepted at `t`, on a primitive whose box has been enlarged as in
//! [`triangle_boxes`](super::triangle_boxes). Then the ray's exact point at `t` lies within
//! `PERTURBATION * farthest` of the box: 16 rounding units (2^-24) of `farthest`. Rounding adds at
//! most 4 units for the box's centre and half size, 6 for the two planes, one each for the
//! direction and `t`; a direction's coordinate below `THINNEST` is replaced by that, which moves
//! a point by a fraction of a unit. The margin is [`SLACK`](super::cone_sphere::SLACK): 64 units.
//! A ray for which all this could overflow gets an infinite margin and crosses everything, NaN
//! included.
//!
//! **Cost.** 28 operations for sixteen boxes.

use glam::Vec3;

use super::axes::load_ordered_axes;
use super::{Lanes, Simd, SimdBase, f32x16, mask32x16};

/// Coordinates of a scaled direction below this are taken for it, so that quotients are finite.
pub(super) const THINNEST: f32 = 1.0 / (1 << 30) as f32;

/// Rays from which something is farther away than this cross every box: 2^30 times it is still
/// finite.
pub(super) const LARGEST_DISTANCE: f32 = 1e27;

/// Rays with directions smaller than this cross every box: 2^-30 times it has all its digits.
pub(super) const SMALLEST_SIZE: f32 = 1e-28;

/// More than twice what products can lose to underflow.
pub(super) const UNDERFLOW: f32 = 2e-36;

/// Directions that are larger can lose more, to the rounding of a `t` so small that it has fewer
/// digits: half of `UNDERFLOW` times this, 1e-44, is more than that, for each unit of their size. A
/// product with 1e-44 itself would have fewer digits too, and take long.
pub(super) const COARSEST_T: f32 = 1e-8;

/// More than the rounding of a sum, relative to it.
pub(super) const CORNER_ERROR: f32 = 2.0 * f32::EPSILON;

/// Sixteen boxes as columns, in world space; all coordinates finite.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct BoxBlock {
    /// Centres by axis.
    pub center: [Lanes; 3],
    /// Half the edge lengths by axis.
    pub half_size: [Lanes; 3],
}

impl BoxBlock {
    /// Sixteen boxes that are the origin.
    pub const ZERO: Self = Self { center: [[0.0; 16]; 3], half_size: [[0.0; 16]; 3] };

    /// Writes the box of one lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, bounds: &BoxBounds) {
        for axis in 0..3 {
            self.center[axis][lane] = bounds.center[axis];
            self.half_size[axis][lane] = bounds.half_size[axis];
        }
    }

    /// Fills the lanes from `count` on with the first box.
    pub fn pad(&mut self, count: usize) {
        for column in self.center.iter_mut().chain(&mut self.half_size) {
            let first = column[0];
            column[count..].fill(first);
        }
    }

    /// The centre of one lane's box.
    #[inline(always)]
    pub fn center_of(&self, lane: usize) -> Vec3 {
        Vec3::new(self.center[0][lane], self.center[1][lane], self.center[2][lane])
    }

    /// The sixteen boxes as vectors, for rays that have their coordinates in the order of `axes`.
    #[inline(always)]
    pub fn load<S: Simd>(&self, simd: S, axes: [usize; 3]) -> BoxLanes<S> {
        BoxLanes {
            center: load_ordered_axes(simd, &self.center, axes),
            half_size: load_ordered_axes(simd, &self.half_size, axes),
        }
    }

    /// The box around all sixteen.
    #[inline(always)]
    pub fn around<S: Simd>(&self, simd: S) -> BoxBounds {
        let BoxLanes { center: c, half_size: h } = self.load(simd, [0, 1, 2]);
        let min = [c[0] - h[0], c[1] - h[1], c[2] - h[2]];
        let max = [c[0] + h[0], c[1] + h[1], c[2] + h[2]];
        BoxBounds::around_lanes(min, max)
    }
}

/// Sixteen boxes in registers.
#[derive(Clone, Copy, Debug)]
pub struct BoxLanes<S: Simd> {
    pub(super) center: [f32x16<S>; 3],
    pub(super) half_size: [f32x16<S>; 3],
}

/// A box.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BoxBounds {
    /// The centre.
    pub center: Vec3,
    /// Half the edge lengths.
    pub half_size: Vec3,
}

impl BoxBounds {
    /// The box between two corners, which may be off by a rounding unit of their coordinates each
    /// and infinite: sides are moved outward by more, and kept finite.
    pub fn between(min: Vec3, max: Vec3) -> Self {
        let min = (min - CORNER_ERROR * min.abs()).max(Vec3::MIN);
        let max = (max + CORNER_ERROR * max.abs()).min(Vec3::MAX);
        let center = 0.5 * min + 0.5 * max;
        // No box is smaller than it should be: rounding must not add up from level to level.
        let half_size = (max - center).max(center - min) * (1.0 + f32::EPSILON);
        Self { center, half_size: half_size.min(Vec3::MAX) }
    }

    /// The box around sixteen boxes, given by their corners.
    #[inline(always)]
    pub(super) fn around_lanes<S: Simd>(min: [f32x16<S>; 3], max: [f32x16<S>; 3]) -> Self {
        let min = Vec3::new(min[0].reduce_min(), min[1].reduce_min(), min[2].reduce_min());
        let max = Vec3::new(max[0].reduce_max(), max[1].reduce_max(), max[2].reduce_max());
        Self::between(min, max)
    }

    /// Half its surface.
    pub fn half_area(&self) -> f32 {
        let Vec3 { x, y, z } = self.half_size;
        4.0 * (x * y + y * z + z * x)
    }

    /// The box around both.
    pub fn union(&self, other: &Self) -> Self {
        let min = (self.center - self.half_size).min(other.center - other.half_size);
        let max = (self.center + self.half_size).max(other.center + other.half_size);
        Self::between(min, max)
    }
}

/// What the test needs to know about one ray, beside its origin; made by
/// [`AlignedRays`](super::aligned_rays::AlignedRays).
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct BoxRay {
    /// One by each coordinate of the direction, scaled.
    pub(super) inverse: [f32; 3],
    /// By how much half sizes are enlarged.
    pub(super) margin: f32,
    /// Smallest distance, in multiples of the scaled direction.
    pub(super) t_min: f32,
    /// Largest distance, likewise.
    pub(super) t_max: f32,
}

impl BoxRay {
    /// A ray that crosses nothing.
    pub const EMPTY: Self =
        Self { inverse: [1.0; 3], margin: 0.0, t_min: f32::INFINITY, t_max: f32::NEG_INFINITY };

    /// Makes `t`, in multiples of the ray's own direction, the end of the interval; `size` is the
    /// largest coordinate of the direction, without its sign.
    #[inline(always)]
    pub fn set_t_max(&mut self, t: f32, size: f32) {
        self.t_max = t * size;
    }
}

/// Which of the boxes the ray may cross within its interval.
#[inline(always)]
pub fn crosses<S: Simd>(simd: S, origin: Vec3, ray: &BoxRay, boxes: &BoxLanes<S>) -> mask32x16<S> {
    let [x_near, x_far] = slab(simd, origin, ray, boxes, 0);
    let [y_near, y_far] = slab(simd, origin, ray, boxes, 1);
    let [z_near, z_far] = slab(simd, origin, ray, boxes, 2);
    let near = x_near.max(y_near).max(z_near.max(f32x16::splat(simd, ray.t_min)));
    let far = x_far.min(y_far).min(z_far.min(f32x16::splat(simd, ray.t_max)));
    !near.simd_gt(far)
}

/// Where the ray enters and leaves the boxes' slabs across one axis.
#[inline(always)]
fn slab<S: Simd>(
    simd: S,
    origin: Vec3,
    ray: &BoxRay,
    boxes: &BoxLanes<S>,
    axis: usize,
) -> [f32x16<S>; 2] {
    let inverse = f32x16::splat(simd, ray.inverse[axis]);
    let middle = (boxes.center[axis] - f32x16::splat(simd, origin[axis])) * inverse;
    let half_size = boxes.half_size[axis] + f32x16::splat(simd, ray.margin);
    // Multiply once and add: multiply-adds wait for the same units as minima and maxima.
    let reach = half_size * inverse.abs();
    [middle - reach, middle + reach]
}

#[cfg(test)]
#[path = "ray_boxes_tests.rs"]
mod tests;
