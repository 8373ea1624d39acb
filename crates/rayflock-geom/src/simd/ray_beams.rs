//! Which of sixteen boxes any ray of a beam may cross: the rejecting test for rays that go similar
//! ways, once for all of them.
//!
//! ```text
//!   origins within o0 .. o1, one by directions within i0 .. i1, for each axis, both taken along it
//!   near = max over the axes of min(a i0, a i1), a = low - o1 - m    and the least t_min
//!   far  = min over the axes of max(b i0, b i1), b = high - o0 + m   and the largest t_max
//! ```
//!
//! **Source.** S. Boulos, I. Wald, P. Shirley, "Geometric and Arithmetic Culling Methods for
//! Entire Ray Packets", UUCS-06-010, 2006 (interval arithmetic over a packet).
//!
//! **Invariants.** What [`crosses`](super::ray_boxes::crosses) keeps for any of the rays is kept:
//! the same margin, the largest of the rays', covers two roundings of a distance to a corner and
//! one of a product, and corners are formed from centre and half size by one rounding, which
//! [`BoxBounds::between`](super::ray_boxes::BoxBounds::between) has left room for.
//!
//! **Cost.** 34 operations for sixteen boxes and any number of rays.

use super::aligned_rays::AlignedRays;
use super::least_of_each::least_of_each;
use super::ray_boxes::BoxLanes;
use super::{LANES, Select, Simd, SimdBase, SimdMask, f32x16, mask32x16, u32x16};

/// Bounds of rays that leave through one face of a cube, in the order kx, ky, kz, each axis taken
/// along the rays.
#[derive(Clone, Copy, Debug)]
pub struct RayBeam {
    /// Least and largest coordinate of the origins.
    origin: [[f32; 2]; 3],
    /// Least and largest inverse coordinate of the scaled directions.
    inverse: [[f32; 2]; 3],
    /// Whether the rays go against an axis.
    is_against: [bool; 3],
    margin: f32,
    /// The least and the largest multiple of the scaled directions.
    t_min: f32,
    t_max: f32,
}

impl RayBeam {
    /// A beam that crosses nothing.
    pub const EMPTY: Self = Self {
        origin: [[0.0; 2]; 3],
        inverse: [[1.0; 2]; 3],
        is_against: [false; 3],
        margin: 0.0,
        t_min: f32::INFINITY,
        t_max: f32::NEG_INFINITY,
    };

    /// The beam around the rays of some lanes, at least one; `None` where one is out of range.
    /// They must leave through one face and have the same signs, as those that are [`alike`].
    #[inline(always)]
    pub fn around<S: Simd>(simd: S, rays: &AlignedRays, lanes: u64) -> Option<Self> {
        let load = f32x16::from_slice;
        let infinite = f32x16::splat(simd, f32::INFINITY);
        let lanes = mask32x16::from_bitmask(simd, lanes);
        let mut columns = [infinite; LANES];
        for axis in 0..3 {
            let (origin, inverse) =
                (load(simd, &rays.origin[axis]), load(simd, &rays.inverse[axis]));
            columns[4 * axis] = lanes.select(origin, infinite);
            columns[4 * axis + 1] = lanes.select(-origin, infinite);
            columns[4 * axis + 2] = lanes.select(inverse, infinite);
            columns[4 * axis + 3] = lanes.select(-inverse, infinite);
        }
        columns[12] = lanes.select(-load(simd, &rays.margin), infinite);
        columns[13] = lanes.select(load(simd, &rays.t_min), infinite);
        columns[14] = lanes.select(-load(simd, &rays.t_max), infinite);
        let least = *least_of_each(columns);

        let mut beam =
            Self { margin: -least[12], t_min: least[13], t_max: -least[14], ..Self::EMPTY };
        for axis in 0..3 {
            let [o0, o1] = [least[4 * axis], -least[4 * axis + 1]];
            let [i0, i1] = [least[4 * axis + 2], -least[4 * axis + 3]];
            let is_against = i1 < 0.0;
            beam.is_against[axis] = is_against;
            beam.origin[axis] = if is_against { [-o1, -o0] } else { [o0, o1] };
            beam.inverse[axis] = if is_against { [-i1, -i0] } else { [i0, i1] };
        }
        (beam.margin < f32::INFINITY).then_some(beam)
    }

    /// Makes `t_max`, in multiples of the scaled directions, the end of the beam.
    #[inline(always)]
    pub fn set_t_max(&mut self, t_max: f32) {
        self.t_max = t_max;
    }
}

/// Those of some lanes whose rays go like the first of them: through the same face, along or
/// against the same axes, from within `width` of its origin, to within `width` after `distance`.
#[inline(always)]
pub fn alike<S: Simd>(simd: S, rays: &AlignedRays, lanes: u64, width: f32, distance: f32) -> u64 {
    let first = lanes.trailing_zeros() as usize % LANES;
    let splat = f32x16::splat;
    let face = u32x16::splat(simd, rays.faces[first]);
    let mut alike = u32x16::from_slice(simd, &rays.faces).simd_eq(face);
    let zero = splat(simd, 0.0);
    for axis in 0..3 {
        let inverse = f32x16::from_slice(simd, &rays.inverse[axis]);
        let one_way = (inverse * splat(simd, rays.inverse[axis][first])).simd_gt(zero);
        let origin = f32x16::from_slice(simd, &rays.origin[axis]);
        let apart = (origin - splat(simd, rays.origin[axis][first])).abs();
        alike &= one_way & apart.simd_le(splat(simd, width));
    }
    for axis in 0..2 {
        let slope = f32x16::from_slice(simd, &rays.shear[axis]);
        let apart = (slope - splat(simd, rays.shear[axis][first])).abs() * splat(simd, distance);
        alike &= apart.simd_le(splat(simd, width));
    }
    alike.to_bitmask() & lanes
}

/// Sixteen boxes by their corners, as rays along and against each axis meet them.
#[derive(Clone, Copy, Debug)]
pub struct BoxCorners<S: Simd> {
    /// For each axis: the side met first and the side met last, along it and against it.
    sides: [[[f32x16<S>; 2]; 2]; 3],
}

impl<S: Simd> BoxCorners<S> {
    /// The corners of boxes.
    #[inline(always)]
    pub fn of(boxes: &BoxLanes<S>) -> Self {
        let BoxLanes { center: c, half_size: h } = boxes;
        Self::between(
            [c[0] - h[0], c[1] - h[1], c[2] - h[2]],
            [c[0] + h[0], c[1] + h[1], c[2] + h[2]],
        )
    }

    /// Boxes between corners.
    #[inline(always)]
    pub(super) fn between(low: [f32x16<S>; 3], high: [f32x16<S>; 3]) -> Self {
        let sides = |axis: usize| [[low[axis], high[axis]], [-high[axis], -low[axis]]];
        Self { sides: [sides(0), sides(1), sides(2)] }
    }
}

/// Which of the boxes any ray of the beam may cross within its interval.
#[inline(always)]
pub fn beam_crosses<S: Simd>(simd: S, beam: &RayBeam, boxes: &BoxCorners<S>) -> mask32x16<S> {
    let [x_near, x_far] = slab(simd, beam, boxes, 0);
    let [y_near, y_far] = slab(simd, beam, boxes, 1);
    let [z_near, z_far] = slab(simd, beam, boxes, 2);
    let near = x_near.max(y_near).max(z_near.max(f32x16::splat(simd, beam.t_min)));
    let far = x_far.min(y_far).min(z_far.min(f32x16::splat(simd, beam.t_max)));
    !near.simd_gt(far)
}

/// Where the first ray may enter and the last one leave the boxes' slabs across one axis.
#[inline(always)]
fn slab<S: Simd>(simd: S, beam: &RayBeam, boxes: &BoxCorners<S>, axis: usize) -> [f32x16<S>; 2] {
    let splat = f32x16::splat;
    let [near, far] = boxes.sides[axis][usize::from(beam.is_against[axis])];
    let ([o0, o1], [i0, i1]) = (beam.origin[axis], beam.inverse[axis]);
    let (i0, i1, margin) = (splat(simd, i0), splat(simd, i1), splat(simd, beam.margin));
    let near = (near - splat(simd, o1)) - margin;
    let far = (far - splat(simd, o0)) + margin;
    [(near * i0).min(near * i1), (far * i0).max(far * i1)]
}
