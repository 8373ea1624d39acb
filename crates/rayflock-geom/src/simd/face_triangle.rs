//! What a face knows about a triangle: three edge functions and a nearness, all linear in a point.
//!
//! ```text
//!   edge(x, y) = A x + B y + C      not negative on the triangle
//!   near(x, y) = a x + b y + c      at least the nearness of any hit, at most `spread` more
//! ```
//!
//! Rejecting only. With `m` the margin of the face, `d` width plus height of the triangle's box and
//! `u` the unit roundoff:
//! - Point and corners are off by `m` against what is accepted, so an edge function by
//!   `2 m d + 2 m^2 <= 3 m d`, and by `9 u |A, B| s <= m d` for rounding, as C is formed from a
//!   corner and not from a product of two. So 4 m d are added.
//! - The triangle's area is off by `4.75 m d`. One that is not larger than `6 m d` has no sign to
//!   go by; then edge functions are within `10.75 m d` of zero all over the triangle, and 16 m d
//!   are added.
//! - With `G` the range of the corners' nearness and `k = d^2 / area`, the plane through the
//!   corners has a slope up to `4 G k / d`, is off by `36 u G k^2` for the rounding of its slopes,
//!   and by what the point is off: `5 m G k / d` and `36 u G k^2` are added beside the face's own
//!   margin. Slivers (`k` above 256) have their largest nearness everywhere.
//!
//! **Invariants.** Evaluation is monotone in x and in y, rounding included: the values at a box's
//! corners bound those at points within.
//!
//! **Cost.** Some 90 operations and one division for 16 triangles; 11 for 16 rays.

use glam::Vec3;

use super::face::FaceTriangles;
use super::ray_triangle::TriangleBlock;
use super::{Bytes, LANES, Lanes, Select, Simd, SimdBase, SimdFloat, f32x16, mask32x16, u32x16};

/// Beyond this square of size over area, a triangle is a sliver.
const SLIVER: f32 = 256.0;

/// Unit roundoff.
const UNIT: f32 = f32::EPSILON / 2.0;

/// Sixteen triangles as a face sees them.
#[derive(Clone, Copy, Debug)]
pub struct TrianglePlanes<S: Simd> {
    /// A, B and C of the edge from each corner to the next.
    pub edges: [[f32x16<S>; 3]; 3],
    /// a, b and c of the nearness.
    pub near: [f32x16<S>; 3],
    /// The largest nearness of a hit anywhere.
    pub nearest: f32x16<S>,
    /// The least nearness of a hit anywhere.
    pub farthest: f32x16<S>,
    /// By how much the nearness of a hit may be less than the plane says.
    pub spread: f32x16<S>,
}

/// A triangle on its way to the rays: what its face knows about it, and itself.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct FaceTriangle {
    /// A, B, C of three edges, then a, b, c of the nearness; last the box: least and largest x,
    /// least and largest y.
    pub planes: Lanes,
    /// Corners, nine coordinates; the largest nearness, the least, the spread; then bits of slot,
    /// rank and mask.
    pub primitive: Lanes,
}

/// Places in [`FaceTriangle::primitive`].
const NEAREST: usize = 9;
const FARTHEST: usize = 10;
const SPREAD: usize = 11;
const SLOT: usize = 12;
const RANK: usize = 13;
const MASK: usize = 14;

impl FaceTriangle {
    /// Nothing, to be overwritten.
    pub const EMPTY: Self = Self { planes: [0.0; LANES], primitive: [0.0; LANES] };

    /// A primitive that may be hit anywhere in its box (least and largest x, least and largest y),
    /// up to a nearness.
    pub fn anywhere(bounds: [f32; 4], nearest: f32) -> Self {
        let mut all = Self::EMPTY;
        all.planes[11] = nearest;
        // Finite, so that boxes without points stay out of reach.
        let bounds = bounds.map(|bound| bound.clamp(f32::MIN, f32::MAX));
        all.planes[12..].copy_from_slice(&bounds);
        all.primitive[NEAREST] = nearest;
        all.primitive[FARTHEST] = f32::NEG_INFINITY;
        all.primitive[SPREAD] = f32::INFINITY;
        all
    }

    /// These corners.
    pub fn with_corners(mut self, corners: [Vec3; 3]) -> Self {
        for (place, corner) in self.primitive.chunks_exact_mut(3).zip(corners) {
            place.copy_from_slice(&corner.to_array());
        }
        self
    }

    /// Writes who this is.
    pub fn identify(&mut self, slot: u32, rank: u32, mask: u32) {
        self.primitive[SLOT] = f32::from_bits(slot);
        self.primitive[RANK] = f32::from_bits(rank);
        self.primitive[MASK] = f32::from_bits(mask);
    }

    /// The corners.
    #[inline(always)]
    pub fn corners(&self) -> [Vec3; 3] {
        let corner = |first: usize| Vec3::from_slice(&self.primitive[first..first + 3]);
        [corner(0), corner(3), corner(6)]
    }

    /// The largest nearness of a hit.
    #[inline(always)]
    pub fn nearest(&self) -> f32 {
        self.primitive[NEAREST]
    }

    /// The least nearness of a hit.
    #[inline(always)]
    pub fn farthest(&self) -> f32 {
        self.primitive[FARTHEST]
    }

    /// The slot.
    #[inline(always)]
    pub fn slot(&self) -> u32 {
        self.primitive[SLOT].to_bits()
    }

    /// The rank.
    #[inline(always)]
    pub fn rank(&self) -> u32 {
        self.primitive[RANK].to_bits()
    }

    /// The object mask.
    #[inline(always)]
    pub fn mask(&self) -> u32 {
        self.primitive[MASK].to_bits()
    }

    /// Least and largest x, least and largest y.
    #[inline(always)]
    pub fn bounds(&self) -> [f32; 4] {
        [self.planes[12], self.planes[13], self.planes[14], self.planes[15]]
    }

    /// Which of sixteen rays may hit the triangle: points, the least and the largest nearness at
    /// which each ray accepts a hit.
    #[inline(always)]
    pub fn may_hit<S: Simd>(&self, simd: S, [x, y, limit, begin]: [f32x16<S>; 4]) -> mask32x16<S> {
        let p = &self.planes;
        let a = plane(simd, [p[0], p[1], p[2]], x, y);
        let b = plane(simd, [p[3], p[4], p[5]], x, y);
        let c = plane(simd, [p[6], p[7], p[8]], x, y);
        let near = plane(simd, [p[9], p[10], p[11]], x, y);
        let zero = f32x16::splat(simd, 0.0);
        let before = (near - f32x16::splat(simd, self.primitive[SPREAD])).simd_gt(begin);
        !(a.min(b).min(c).simd_lt(zero) | near.simd_lt(limit) | before)
    }
}

#[inline(always)]
fn plane<S: Simd>(simd: S, [a, b, c]: [f32; 3], x: f32x16<S>, y: f32x16<S>) -> f32x16<S> {
    let splat = f32x16::splat;
    x.mul_add(splat(simd, a), y.mul_add(splat(simd, b), splat(simd, c)))
}

/// Sets up sixteen triangles that have a place on the face.
#[inline(always)]
pub fn set_up<S: Simd>(simd: S, on_face: &FaceTriangles<S>) -> TrianglePlanes<S> {
    let splat = f32x16::splat;
    let FaceTriangles { x, y, near, margin, near_margin, bounds, .. } = *on_face;
    // Width and height.
    let size = (bounds[1] - bounds[0]) + (bounds[3] - bounds[2]);
    let (x1, y1, x2, y2) = (x[1] - x[0], y[1] - y[0], x[2] - x[0], y[2] - y[0]);
    let area = x1 * y2 - x2 * y1;
    let unit = margin * size;

    let has_sign = area.abs().simd_gt(splat(simd, 6.0) * unit);
    let widened = has_sign.select(splat(simd, 4.0), splat(simd, 16.0));
    let widened = widened.mul_add(unit, splat(simd, f32::MIN_POSITIVE));
    let sign = splat(simd, 1.0).copysign(area);
    let edges = [
        edge(x[0], y[0], x[1], y[1], sign, widened),
        edge(x[1], y[1], x[2], y[2], sign, widened),
        edge(x[2], y[2], x[0], y[0], sign, widened),
    ];

    // The plane of nearness through the corners, and by how much to raise it.
    let most = near[0].max(near[1]).max(near[2]);
    let least = near[0].min(near[1]).min(near[2]);
    let range = most - least;
    let (near1, near2) = (near[1] - near[0], near[2] - near[0]);
    let inverse = splat(simd, 1.0) / area;
    let a = (near1 * y2 - near2 * y1) * inverse;
    let b = (near2 * x1 - near1 * x2) * inverse;
    let sliver = size * size * inverse.abs();
    let tilt = splat(simd, 5.0) * margin / size;
    let raised = range * sliver * splat(simd, 36.0 * UNIT).mul_add(sliver, tilt) + near_margin;
    let c = near[0] - (a * x[0] + b * y[0]) + raised;

    let (nearest, farthest) = (most + near_margin, least - near_margin);
    let is_plane = sliver.simd_lt(splat(simd, SLIVER));
    let zero = splat(simd, 0.0);
    let near = [is_plane.select(a, zero), is_plane.select(b, zero), is_plane.select(c, nearest)];
    let spread = is_plane.select(raised + raised, nearest - farthest);
    TrianglePlanes { edges, near, nearest, farthest, spread }
}

/// The edge function that grows to the inside, raised by `widened`.
#[inline(always)]
fn edge<S: Simd>(
    x0: f32x16<S>,
    y0: f32x16<S>,
    x1: f32x16<S>,
    y1: f32x16<S>,
    sign: f32x16<S>,
    widened: f32x16<S>,
) -> [f32x16<S>; 3] {
    let (a, b) = ((y0 - y1) * sign, (x1 - x0) * sign);
    [a, b, widened - (a * x0 + b * y0)]
}

impl<S: Simd> TrianglePlanes<S> {
    /// Writes the triangles one after the other, given their boxes, corners and bits of slots,
    /// ranks and masks.
    #[inline(always)]
    pub fn store(
        &self,
        simd: S,
        bounds: &[f32x16<S>; 4],
        block: &TriangleBlock,
        identity: [u32x16<S>; 3],
        triangles: &mut [FaceTriangle; LANES],
    ) {
        let ([a, b, c], [d, e, f]) = (self.edges, (self.near));
        let planes = transpose([
            a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2], d, e, f, bounds[0], bounds[1],
            bounds[2], bounds[3],
        ]);
        let load =
            |corner: usize, axis: usize| f32x16::from_slice(simd, &block.corners[corner][axis]);
        let zero = f32x16::splat(simd, 0.0);
        let primitives = transpose([
            load(0, 0),
            load(0, 1),
            load(0, 2),
            load(1, 0),
            load(1, 1),
            load(1, 2),
            load(2, 0),
            load(2, 1),
            load(2, 2),
            self.nearest,
            self.farthest,
            self.spread,
            identity[0].bitcast(),
            identity[1].bitcast(),
            identity[2].bitcast(),
            zero,
        ]);
        for lane in 0..LANES {
            planes[lane].store_slice(&mut triangles[lane].planes);
            primitives[lane].store_slice(&mut triangles[lane].primitive);
        }
    }
}

/// Makes rows of columns: four perfect shuffles.
#[inline(always)]
pub(super) fn transpose<S: Simd>(rows: [f32x16<S>; LANES]) -> [f32x16<S>; LANES] {
    shuffle(shuffle(shuffle(shuffle(rows))))
}

/// Interleaves the first half of the rows with the second.
#[inline(always)]
fn shuffle<S: Simd>(rows: [f32x16<S>; LANES]) -> [f32x16<S>; LANES] {
    let mut shuffled = rows;
    for idx in 0..LANES / 2 {
        let (low, high) = rows[idx].interleave(rows[idx + LANES / 2]);
        shuffled[2 * idx] = low;
        shuffled[2 * idx + 1] = high;
    }
    shuffled
}
