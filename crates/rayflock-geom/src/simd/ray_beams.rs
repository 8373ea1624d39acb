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

use super::ray_boxes::BoxLanes;
use super::{Simd, SimdBase, f32x16, mask32x16};

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

    /// A beam of rays, in the order kx, ky, kz: least and largest coordinates of origins, and of
    /// inverse directions, which must have one sign an axis; the margin; the interval.
    #[inline(always)]
    pub(super) fn new(
        origin: [[f32; 2]; 3],
        inverse: [[f32; 2]; 3],
        margin: f32,
        [t_min, t_max]: [f32; 2],
    ) -> Self {
        let mut beam = Self { origin, inverse, margin, t_min, t_max, ..Self::EMPTY };
        for axis in 0..3 {
            if inverse[axis][1] < 0.0 {
                let ([o0, o1], [i0, i1]) = (origin[axis], inverse[axis]);
                beam.is_against[axis] = true;
                (beam.origin[axis], beam.inverse[axis]) = ([-o1, -o0], [-i1, -i0]);
            }
        }
        beam
    }

    /// Makes `t_max`, in multiples of the scaled directions, the end of the beam.
    #[inline(always)]
    pub fn set_t_max(&mut self, t_max: f32) {
        self.t_max = t_max;
    }
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
