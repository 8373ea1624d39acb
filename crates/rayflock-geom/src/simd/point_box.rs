//! Boxes around the points of rays on a face.

use super::least_of_each::least_of_each;
use super::{Select, Simd, SimdBase, f32x16, mask32x16};

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
