//! Finds out which of sixteen rays go alike, and what holds for all of these.
//!
//! ```text
//!   alike     same signs, through the same face of a cube, from nearby: no division
//!   Slopes    directions as the axes of that face have them: four divisions
//!   close     those that stay together on their way
//!   beam      bounds of these: the least lane of each of fourteen columns at once
//! ```
//!
//! **Source.** That of [`ray_beams`](super::ray_beams), whose beams these are.
//!
//! **Invariants.** `shear` has the bits of [`ShearedRay`](super::ray_triangle::ShearedRay); inverses
//! and margin are those of [`AlignedRays`](super::aligned_rays::AlignedRays) or wider.
//!
//! **Cost.** Some 40 operations for those that are alike, 110 more and four divisions for a beam.

use super::aligned_rays::{Order, face_axes, goes_along, inverse, margin};
use super::axes::{Axes, load_axes};
use super::least_of_each::least_of_each;
use super::ray_beams::RayBeam;
use super::ray_boxes::{BoxBounds, LARGEST_DISTANCE, SMALLEST_SIZE};
use super::ray_lanes::RayLanes;
use super::{LANES, Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16, u32x16};

/// Sixteen rays in registers.
#[derive(Clone, Copy, Debug)]
pub struct Neighbours<S: Simd> {
    origin: Axes<S>,
    direction: Axes<S>,
    t_min: f32x16<S>,
    t_max: f32x16<S>,
    /// The face of a cube that each direction goes through.
    faces: u32x16<S>,
}

/// Sixteen directions along the axes kx, ky and kz of one face. Those that do not go through it have
/// anything.
#[derive(Clone, Copy, Debug)]
pub struct Slopes<S: Simd> {
    face: usize,
    /// sx, sy and `d[kz]` of the accepting test.
    pub(super) shear: Axes<S>,
    /// Inverse coordinates along kx and ky of the directions divided by their largest one.
    inverse: [f32x16<S>; 2],
    /// The largest coordinate, without its sign.
    size: f32x16<S>,
}

impl<S: Simd> Neighbours<S> {
    /// Takes up sixteen rays.
    #[inline(always)]
    pub fn of(simd: S, rays: &RayLanes) -> Self {
        let (origin, direction) = (load_axes(simd, &rays.origin), load_axes(simd, &rays.direction));
        let order = Order::of(direction);
        Self {
            origin,
            direction,
            t_min: f32x16::from_slice(simd, &rays.t_min),
            t_max: f32x16::from_slice(simd, &rays.t_max),
            faces: order.faces(simd, order.apply(direction)[2]),
        }
    }

    /// The face of a cube that a ray's direction goes through.
    #[inline(always)]
    pub fn face(&self, lane: usize) -> usize {
        self.faces[lane] as usize
    }

    /// Those of some lanes whose rays go like the first of them, as far as is easily told: through
    /// the same face, along or against the same axes, from within `width` of its origin.
    #[inline(always)]
    pub fn alike(&self, simd: S, lanes: u64, width: f32) -> u64 {
        let first = lanes.trailing_zeros() as usize % LANES;
        let splat = f32x16::splat;
        let mut alike = self.faces.simd_eq(u32x16::splat(simd, self.faces[first]));
        let one = splat(simd, 1.0);
        for axis in 0..3 {
            let own = splat(simd, self.direction[axis][first]);
            alike &= one.copysign(self.direction[axis]).simd_eq(one.copysign(own));
            let apart = (self.origin[axis] - splat(simd, self.origin[axis][first])).abs();
            alike &= apart.simd_le(splat(simd, width));
        }
        alike.to_bitmask() & lanes
    }

    /// The directions along the axes of a face.
    #[inline(always)]
    pub fn slopes(&self, simd: S, face: usize) -> Slopes<S> {
        let [x, y, z] = face_axes(face).map(
            #[inline(always)]
            |axis| self.direction[axis],
        );
        let size = z.abs();
        let inverse = [inverse(simd, x, size), inverse(simd, y, size)];
        Slopes { face, shear: [x / z, y / z, z], inverse, size }
    }

    /// The beam around the rays of some lanes, at least one, which must be [`Self::alike`];
    /// `None` where one is out of range. For `bounds` and `slack` see
    /// [`AlignedRays::prepare`](super::aligned_rays::AlignedRays::prepare).
    #[inline(always)]
    pub fn beam(
        &self,
        simd: S,
        slopes: &Slopes<S>,
        lanes: u64,
        bounds: &BoxBounds,
        slack: f32,
    ) -> Option<RayBeam> {
        let infinite = f32x16::splat(simd, f32::INFINITY);
        let lanes = mask32x16::from_bitmask(simd, lanes);
        let axes = face_axes(slopes.face);
        let mut columns = [infinite; LANES];
        for (idx, &axis) in axes.iter().enumerate() {
            let origin = self.origin[axis];
            columns[2 * idx] = lanes.select(origin, infinite);
            columns[2 * idx + 1] = lanes.select(-origin, infinite);
        }
        for (idx, &inverse) in slopes.inverse.iter().enumerate() {
            columns[6 + 2 * idx] = lanes.select(inverse, infinite);
            columns[7 + 2 * idx] = lanes.select(-inverse, infinite);
        }
        let size = slopes.size;
        columns[10] = lanes.select(self.t_min * size, infinite);
        columns[11] = lanes.select(-(self.t_max * size), infinite);
        columns[12] = lanes.select(size, infinite);
        columns[13] = lanes.select(-size, infinite);
        let least = *least_of_each(columns);

        let range = |idx: usize| [least[idx], -least[idx + 1]];
        let origin = [range(0), range(2), range(4)];
        let mut farthest = 0.0_f32;
        for ([o0, o1], axis) in origin.into_iter().zip(axes) {
            let (center, half_size) = (bounds.center[axis], bounds.half_size[axis]);
            farthest = farthest.max((center - o0).abs().max((center - o1).abs()) + half_size);
        }
        let [smallest, largest] = range(12);
        let in_range = farthest <= LARGEST_DISTANCE && smallest >= SMALLEST_SIZE;
        let along = if goes_along(slopes.face) { [1.0; 2] } else { [-1.0; 2] };
        in_range.then(|| {
            let [t_min, t_max] = range(10);
            RayBeam::new(
                origin,
                [range(6), range(8), along],
                margin(farthest, largest, slack),
                [t_min, t_max],
            )
        })
    }
}

impl<S: Simd> Slopes<S> {
    /// The face.
    pub fn face(&self) -> usize {
        self.face
    }

    /// Those of some lanes whose directions stay within `width` of that of the first one over
    /// `distance`.
    #[inline(always)]
    pub fn close(&self, simd: S, lanes: u64, width: f32, distance: f32) -> u64 {
        let first = lanes.trailing_zeros() as usize % LANES;
        let splat = f32x16::splat;
        let [x, y, _] = self.shear;
        let apart = (x - splat(simd, x[first])).abs().max((y - splat(simd, y[first])).abs());
        (apart * splat(simd, distance)).simd_le(splat(simd, width)).to_bitmask() & lanes
    }
}
