//! Which of sixteen boxes one ray may cross: the rejecting test of a tree of boxes.
//!
//! ```text
//!   near = max over the axes of min((lo - m - o) / d, (hi + m - o) / d),  and t_min
//!   far  = min over the axes of max((lo - m - o) / d, (hi + m - o) / d),  and t_max
//!   crossed where near <= far
//! ```
//!
//! The margin `m` is folded into the ray: `(lo - m - o) / d` is one multiply-add of `lo`. Boxes
//! and origins are relative to the middle of all boxes, so that far from the world's origin
//! neither loses digits; directions are divided by their largest coordinate, so that tiny and huge
//! ones do not overflow.
//!
//! **Source.** T. Kay, J. Kajiya, "Ray Tracing Complex Scenes", SIGGRAPH 1986 (slabs); T. Ize,
//! "Robust BVH Ray Traversal", JCGT 2(2), 2013 (what rounding costs).
//!
//! **Departures.** The margin is one length a ray, a part of the largest coordinate by which
//! anything in the boxes can lie from the origin (`reach`), instead of ulps a box.
//!
//! **Invariants.** Let a hit be accepted at `t`, on a primitive whose box has been enlarged as in
//! [`triangle_boxes`](super::triangle_boxes). Then the ray's exact point at `t` lies within
//! `PERTURBATION * reach` of the box: 16 rounding units (2^-24) of `reach`. Rounding adds at most
//! 3 units for moving origin and boxes to the middle, 11 for the planes, one each for the
//! direction and `t`; a direction's coordinate below [`THINNEST`] is replaced by that, which moves
//! a point by a fraction of a unit. The margin is [`SLACK`](super::cone_sphere::SLACK): 64 units.
//! A ray whose reach is too large for these products, or not finite, crosses everything.
//!
//! **Cost.** 6 multiply-adds, 12 minima and maxima and one comparison for sixteen boxes.

use glam::Vec3;

use super::axes::load_axes;
use super::{Lanes, Simd, SimdBase, SimdFloat, f32x16, mask32x16};
use crate::Ray;

/// Coordinates of a scaled direction below this are taken for it, so that quotients are finite.
const THINNEST: f32 = 1.0 / (1 << 30) as f32;

/// Rays with a larger reach than this cross every box: 2^30 times it is still finite.
const LARGEST_REACH: f32 = 1e27;

/// More than what products can lose to underflow.
const UNDERFLOW: f32 = 1e-36;

/// More than the rounding of a `t` so small that it has fewer digits.
const COARSEST_T: f32 = 1e-44;

/// Sixteen boxes as columns, relative to the middle of a [`BoxSpace`]; all coordinates finite.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct BoxBlock {
    /// Smallest corners by axis.
    pub min: [Lanes; 3],
    /// Largest corners by axis.
    pub max: [Lanes; 3],
}

impl BoxBlock {
    /// Sixteen boxes that are the middle of their space.
    pub const ZERO: Self = Self { min: [[0.0; 16]; 3], max: [[0.0; 16]; 3] };

    /// Writes the box of one lane, corners relative to the middle.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, min: Vec3, max: Vec3) {
        for axis in 0..3 {
            self.min[axis][lane] = min[axis];
            self.max[axis][lane] = max[axis];
        }
    }

    /// Fills the lanes from `count` on with the first box.
    pub fn pad(&mut self, count: usize) {
        for column in self.min.iter_mut().chain(&mut self.max) {
            let first = column[0];
            column[count..].fill(first);
        }
    }

    /// The sixteen boxes as vectors.
    #[inline(always)]
    pub fn load<S: Simd>(&self, simd: S) -> BoxLanes<S> {
        BoxLanes { min: load_axes(simd, &self.min), max: load_axes(simd, &self.max) }
    }
}

/// Sixteen boxes in registers.
#[derive(Clone, Copy, Debug)]
pub struct BoxLanes<S: Simd> {
    /// Smallest corners by axis.
    pub min: [f32x16<S>; 3],
    /// Largest corners by axis.
    pub max: [f32x16<S>; 3],
}

impl<S: Simd> BoxLanes<S> {
    /// The corners of the box around all sixteen.
    #[inline(always)]
    pub fn around(self) -> (Vec3, Vec3) {
        let [min, max] = [self.min, self.max];
        (
            Vec3::new(min[0].reduce_min(), min[1].reduce_min(), min[2].reduce_min()),
            Vec3::new(max[0].reduce_max(), max[1].reduce_max(), max[2].reduce_max()),
        )
    }
}

/// Where the boxes are that a ray is prepared for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BoxSpace {
    /// What boxes are relative to; finite, in world space.
    pub middle: Vec3,
    /// The largest coordinates, without their signs, of anything in the boxes, relative to the
    /// middle; at least 0.
    pub half_size: Vec3,
}

/// What the test needs to know about one ray.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct BoxRay {
    /// One by each coordinate of the direction, scaled.
    inverse: [f32; 3],
    /// What to add to `lo * inverse`, the margin included.
    lower: [f32; 3],
    /// What to add to `hi * inverse`, the margin included.
    upper: [f32; 3],
    /// Ends of the interval, in multiples of the scaled direction.
    t_min: f32,
    t_max: f32,
    /// The largest coordinate of the direction, without its sign.
    size: f32,
    /// The direction divided by `size`.
    direction: [f32; 3],
}

impl BoxRay {
    /// A ray that crosses nothing but, perhaps, boxes met by rays out of range.
    pub const EMPTY: Self = Self {
        inverse: [0.0; 3],
        lower: [0.0; 3],
        upper: [0.0; 3],
        t_min: f32::INFINITY,
        t_max: f32::NEG_INFINITY,
        size: 1.0,
        direction: [0.0; 3],
    };

    /// Prepares an active ray for boxes in `space`. `slack` is relative to the distances at hand,
    /// at least [`SLACK`](super::cone_sphere::SLACK).
    #[inline(always)]
    pub fn new(ray: &Ray, space: &BoxSpace, slack: f32) -> Self {
        let size = ray.direction.abs().max_element();
        let direction = ray.direction / size;
        let origin = ray.origin - space.middle;
        let reach = (origin.abs() + space.half_size).max_element();
        let mut prepared = Self {
            t_min: ray.t_min * size,
            t_max: ray.t_max * size,
            size,
            direction: direction.to_array(),
            ..Self::EMPTY
        };
        let in_range = reach <= LARGEST_REACH;
        let margin = slack * reach + (UNDERFLOW + COARSEST_T * size);
        for axis in 0..3 {
            let coordinate = direction[axis].abs().max(THINNEST).copysign(direction[axis]);
            let inverse = 1.0 / coordinate;
            let (lower, upper) =
                ((-margin - origin[axis]) * inverse, (margin - origin[axis]) * inverse);
            prepared.inverse[axis] = if in_range { inverse } else { 0.0 };
            prepared.lower[axis] = if in_range { lower } else { f32::NEG_INFINITY };
            prepared.upper[axis] = if in_range { upper } else { f32::INFINITY };
        }
        prepared
    }

    /// Makes `t`, in multiples of the ray's own direction, the end of the interval.
    #[inline(always)]
    pub fn set_t_max(&mut self, t: f32) {
        self.t_max = t * self.size;
    }

    /// The direction, scaled so that its largest coordinate is 1 or -1.
    #[inline(always)]
    pub fn direction(&self) -> Vec3 {
        self.direction.into()
    }
}

/// Which of the boxes the ray may cross within its interval.
#[inline(always)]
pub fn crosses<S: Simd>(simd: S, ray: &BoxRay, boxes: &BoxLanes<S>) -> mask32x16<S> {
    let [x_near, x_far] = slab(simd, ray, boxes, 0);
    let [y_near, y_far] = slab(simd, ray, boxes, 1);
    let [z_near, z_far] = slab(simd, ray, boxes, 2);
    let near = x_near.max(y_near).max(z_near.max(f32x16::splat(simd, ray.t_min)));
    let far = x_far.min(y_far).min(z_far.min(f32x16::splat(simd, ray.t_max)));
    near.simd_le(far)
}

/// Where the ray enters and leaves the boxes' slabs across one axis.
#[inline(always)]
fn slab<S: Simd>(simd: S, ray: &BoxRay, boxes: &BoxLanes<S>, axis: usize) -> [f32x16<S>; 2] {
    let inverse = f32x16::splat(simd, ray.inverse[axis]);
    let a = boxes.min[axis].mul_add(inverse, f32x16::splat(simd, ray.lower[axis]));
    let b = boxes.max[axis].mul_add(inverse, f32x16::splat(simd, ray.upper[axis]));
    [a.min(b), a.max(b)]
}

#[cfg(test)]
#[path = "ray_boxes_tests.rs"]
mod tests;
