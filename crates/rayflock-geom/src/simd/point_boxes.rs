//! Sixteen boxes around points of rays: which of them a triangle on their face may touch.
//!
//! **Invariants.** Conservative for every ray that [`FaceTriangle::may_hit`] would keep: edge
//! functions and nearness are evaluated by the same operations, which are monotone, at the corners
//! of the box where they are largest.
//!
//! **Cost.** Six comparisons; 18 operations more for the edges where several boxes are touched.

use super::face_triangle::FaceTriangle;
use super::least_of_each::least_of_each;
use super::{LANES, Lanes, Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16};

/// The edges are asked where the box of a triangle touches more boxes than this.
const FEW: u32 = 2;

/// Sixteen boxes as columns.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct PointBoxes {
    /// Least x, largest x, least y, largest y.
    pub bounds: [Lanes; 4],
    /// The least nearness at which any ray in the box accepts a hit.
    pub limit: Lanes,
    /// The largest such nearness.
    pub begin: Lanes,
}

impl PointBoxes {
    /// Boxes without points, which nothing touches.
    pub const EMPTY: Self = Self {
        bounds: [
            [f32::INFINITY; LANES],
            [f32::NEG_INFINITY; LANES],
            [f32::INFINITY; LANES],
            [f32::NEG_INFINITY; LANES],
        ],
        limit: [f32::INFINITY; LANES],
        begin: [f32::NEG_INFINITY; LANES],
    };

    /// Empties one box.
    #[inline(always)]
    pub fn clear(&mut self, lane: usize) {
        self.set(lane, &PointBox::EMPTY);
    }

    /// Writes one box.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, one: &PointBox) {
        for (column, bound) in self.bounds.iter_mut().zip(one.bounds) {
            column[lane] = bound;
        }
        self.limit[lane] = one.limit;
        self.begin[lane] = one.begin;
    }

    /// The box around all sixteen.
    pub fn union(&self) -> PointBox {
        let mut union = PointBox::EMPTY;
        for lane in 0..LANES {
            let [x0, x1, y0, y1] = &self.bounds;
            let bounds = [x0[lane], x1[lane], y0[lane], y1[lane]];
            union =
                union.union(&PointBox { bounds, limit: self.limit[lane], begin: self.begin[lane] });
        }
        union
    }

    /// Which boxes the triangle may touch, one bit a box.
    #[inline(always)]
    pub fn touched<S: Simd>(&self, simd: S, triangle: &FaceTriangle) -> u32 {
        let splat = f32x16::splat;
        let load = f32x16::from_slice;
        let [x0, x1, y0, y1] = triangle.bounds();
        let [left, right, low, high] = &self.bounds;
        let (left, right) = (load(simd, left), load(simd, right));
        let (low, high) = (load(simd, low), load(simd, high));
        let apart = left.simd_gt(splat(simd, x1))
            | right.simd_lt(splat(simd, x0))
            | low.simd_gt(splat(simd, y1))
            | high.simd_lt(splat(simd, y0))
            | load(simd, &self.limit).simd_gt(splat(simd, triangle.nearest()))
            | load(simd, &self.begin).simd_lt(splat(simd, triangle.farthest()));
        let near = !apart;
        let bits = near.to_bitmask() as u32;
        if bits.count_ones() <= FEW {
            return bits;
        }
        let p = &triangle.planes;
        let beside = is_beside(simd, [p[0], p[1], p[2]], [left, right], [low, high])
            | is_beside(simd, [p[3], p[4], p[5]], [left, right], [low, high])
            | is_beside(simd, [p[6], p[7], p[8]], [left, right], [low, high]);
        bits & !(beside.to_bitmask() as u32)
    }
}

/// Where an edge function is negative all over the box.
#[inline(always)]
fn is_beside<S: Simd>(
    simd: S,
    [a, b, c]: [f32; 3],
    x: [f32x16<S>; 2],
    y: [f32x16<S>; 2],
) -> mask32x16<S> {
    let splat = f32x16::splat;
    let (a, b, c) = (splat(simd, a), splat(simd, b), splat(simd, c));
    let along_y = y[0].mul_add(b, c).max(y[1].mul_add(b, c));
    x[0].mul_add(a, along_y).max(x[1].mul_add(a, along_y)).simd_lt(splat(simd, 0.0))
}

/// A box around points of rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointBox {
    /// Least x, largest x, least y, largest y.
    pub bounds: [f32; 4],
    /// The least nearness at which any ray in the box accepts a hit.
    pub limit: f32,
    /// The largest such nearness.
    pub begin: f32,
}

impl PointBox {
    /// No point.
    pub const EMPTY: Self = Self {
        bounds: [f32::INFINITY, f32::NEG_INFINITY, f32::INFINITY, f32::NEG_INFINITY],
        limit: f32::INFINITY,
        begin: f32::NEG_INFINITY,
    };

    /// The box around both.
    pub fn union(&self, other: &Self) -> Self {
        let ([a0, a1, a2, a3], [b0, b1, b2, b3]) = (self.bounds, other.bounds);
        let bounds = [a0.min(b0), a1.max(b1), a2.min(b2), a3.max(b3)];
        Self { bounds, limit: self.limit.min(other.limit), begin: self.begin.max(other.begin) }
    }

    /// Width times height; 0 without points.
    pub fn area(&self) -> f32 {
        let [x0, x1, y0, y1] = self.bounds;
        if self.is_empty() { 0.0 } else { (x1 - x0) * (y1 - y0) }
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.bounds[0] > self.bounds[1]
    }

    /// The box around the points of the `active` rays.
    #[inline(always)]
    pub fn around<S: Simd>(
        simd: S,
        [x, y, limit, begin]: [f32x16<S>; 4],
        active: mask32x16<S>,
    ) -> Self {
        Self::around_with_most(simd, [x, y, limit, begin, x], active).0
    }

    /// The same, and the largest `value` of them; minus infinity without any.
    #[inline(always)]
    pub fn around_with_most<S: Simd>(
        simd: S,
        [x, y, limit, begin, value]: [f32x16<S>; 5],
        active: mask32x16<S>,
    ) -> (Self, f32) {
        let infinite = f32x16::splat(simd, f32::INFINITY);
        let least = *least_of_each([
            active.select(x, infinite),
            active.select(-x, infinite),
            active.select(y, infinite),
            active.select(-y, infinite),
            active.select(limit, infinite),
            active.select(-begin, infinite),
            active.select(-value, infinite),
            infinite,
        ]);
        let bounds = [least[0], -least[2], least[4], -least[6]];
        (Self { bounds, limit: least[8], begin: -least[10] }, -least[12])
    }
}
