//! What a face knows about a triangle: three edge functions and a nearness, all linear in a point.
//!
//! ```text
//!   edge(x, y) = A x + B y + C      not negative on the triangle
//!   near(x, y) = a x + b y + c      at least the nearness of any hit, at most `spread` more
//! ```
//!
//! Mostly for rejecting. With `m` the margin of the face, `d` width plus height of the triangle's
//! box and `u` the unit roundoff:
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
//! Errors have either sign, so where all edge functions of a triangle with a sign exceed twice what
//! was added, the accepting test sees the ray within the triangle ([`FaceTriangle::must_hit`]).
//!
//! **Invariants.** Evaluation is monotone in x and in y, rounding included, so the values at the
//! sides of a strip bound those at points within.
//!
//! **Cost.** Some 90 operations and one division for 16 triangles; 11 for 16 rays.

use super::face::FaceTriangles;
use super::{LANES, Lanes, Select, Simd, SimdBase, SimdFloat, f32x16, mask32x16};

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
    /// By how much the nearness of a hit may be less than the plane says.
    pub spread: f32x16<S>,
    /// What edge functions exceed where the triangle is hit for certain.
    pub inside: f32x16<S>,
}

/// What rays are asked of a triangle before they meet it.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct FaceTriangle {
    /// A, B, C of three edges, then a, b, c of the nearness; least and largest x; the spread; what
    /// edge functions exceed inside.
    planes: Lanes,
}

/// Places in [`FaceTriangle::planes`].
const NEAR: usize = 9;
const ENDS: usize = 12;
const SPREAD: usize = 14;
const INSIDE: usize = 15;

/// By how much a clipped end is moved outward, for the rounding of a division.
const CLIP_SLACK: f32 = 4.0 * f32::EPSILON;

/// More than the rounding of an edge function in `f32`, relative to the sizes of its terms.
const EDGE_SLACK: f64 = 1.0 / (1 << 20) as f64;

impl FaceTriangle {
    /// Nothing, to be overwritten.
    pub const EMPTY: Self = Self { planes: [0.0; LANES] };

    /// What is known of a primitive that was placed alone.
    pub fn of(reach: &FaceReach) -> Self {
        let mut all = Self::EMPTY;
        all.planes[..NEAR].copy_from_slice(reach.edges.as_flattened());
        all.planes[NEAR + 2] = reach.nearest;
        all.planes[ENDS..SPREAD].copy_from_slice(&reach.bounds[..2]);
        all.planes[SPREAD] = f32::INFINITY;
        all.planes[INSIDE] = f32::INFINITY;
        all
    }

    /// Least and largest x.
    #[inline(always)]
    pub fn ends(&self) -> [f32; 2] {
        [self.planes[ENDS], self.planes[ENDS + 1]]
    }

    /// Which of sixteen rays may hit the triangle: points, the least and the largest nearness at
    /// which each ray accepts a hit.
    #[inline(always)]
    pub fn may_hit<S: Simd>(&self, simd: S, [x, y, limit, begin]: [f32x16<S>; 4]) -> mask32x16<S> {
        let [edge, near, farthest] = self.at(simd, x, y);
        let zero = f32x16::splat(simd, 0.0);
        !(edge.simd_lt(zero) | near.simd_lt(limit) | farthest.simd_gt(begin))
    }

    /// Which of sixteen rays hit the triangle for certain: points, the least and the largest
    /// nearness at which each ray surely accepts a hit, as [`Face::surely`](super::face::Face::surely)
    /// tells.
    #[inline(always)]
    pub fn must_hit<S: Simd>(&self, simd: S, [x, y, least, most]: [f32x16<S>; 4]) -> mask32x16<S> {
        let [edge, near, farthest] = self.at(simd, x, y);
        let inside = f32x16::splat(simd, self.planes[INSIDE]);
        edge.simd_gt(inside) & farthest.simd_gt(least) & near.simd_lt(most)
    }

    /// At sixteen points: the least edge function, the largest and the least nearness of a hit.
    #[inline(always)]
    fn at<S: Simd>(&self, simd: S, x: f32x16<S>, y: f32x16<S>) -> [f32x16<S>; 3] {
        let p = &self.planes;
        let a = plane(simd, [p[0], p[1], p[2]], x, y);
        let b = plane(simd, [p[3], p[4], p[5]], x, y);
        let c = plane(simd, [p[6], p[7], p[8]], x, y);
        let near = plane(simd, [p[9], p[10], p[11]], x, y);
        [a.min(b).min(c), near, near - f32x16::splat(simd, p[SPREAD])]
    }
}

/// Where on a face a primitive may be hit that was placed alone.
#[derive(Clone, Copy, Debug)]
pub struct FaceReach {
    /// Least and largest x, least and largest y.
    pub bounds: [f32; 4],
    /// A, B and C of three edges, all zero where there are none.
    pub edges: [[f32; 3]; 3],
    /// The largest nearness of a hit.
    pub nearest: f32,
}

impl FaceReach {
    /// Anywhere in the box (least and largest x, least and largest y), up to a nearness.
    pub fn anywhere(bounds: [f32; 4], nearest: f32) -> Self {
        let bounds = bounds.map(|bound| bound.clamp(f32::MIN, f32::MAX));
        Self { bounds, edges: [[0.0; 3]; 3], nearest }
    }

    /// Least and largest x, of those asked, between two y: outside of them
    /// [`FaceTriangle::may_hit`] keeps nothing. The first is larger where there is nothing between.
    pub fn clip_x(&self, y: [f32; 2], x: [f32; 2]) -> [f32; 2] {
        self.clip(0, y, x)
    }

    /// Least and largest y, of those asked, between two x, likewise.
    pub fn clip_y(&self, x: [f32; 2], y: [f32; 2]) -> [f32; 2] {
        self.clip(1, x, y)
    }

    fn clip(&self, axis: usize, across: [f32; 2], along: [f32; 2]) -> [f32; 2] {
        let bounds = &self.bounds[2 * axis..];
        let [mut low, mut high] = [along[0].max(bounds[0]), along[1].min(bounds[1])].map(f64::from);
        let [p0, p1] = across.map(f64::from);
        for edge in self.edges.map(|edge| edge.map(f64::from)) {
            let (a, b, c) = (edge[1 - axis], edge[axis], edge[2]);
            // An edge function is at most `b v + rest` there, the rounding of `may_hit` included.
            let size =
                [(a, p0, p1), (b, low, high)].map(|(k, p, q)| k.abs() * p.abs().max(q.abs()));
            let rest = (a * p0).max(a * p1) + c + EDGE_SLACK * (size[0] + size[1] + c.abs());
            if b > 0.0 {
                low = low.max(-rest / b);
            } else if b < 0.0 {
                high = high.min(rest / -b);
            } else if rest < 0.0 {
                return [f32::INFINITY, f32::NEG_INFINITY];
            }
        }
        [(low as f32).next_down(), (high as f32).next_up()]
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
    let inside = has_sign.select(widened + widened, splat(simd, f32::INFINITY));
    TrianglePlanes { edges, near, spread, inside }
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
    /// One triangle, sixteen times.
    #[inline(always)]
    pub fn of_one(simd: S, triangle: &FaceTriangle) -> Self {
        let p = &triangle.planes;
        let splat = |place: usize| f32x16::splat(simd, p[place]);
        let three = |first: usize| [splat(first), splat(first + 1), splat(first + 2)];
        Self {
            edges: [three(0), three(3), three(6)],
            near: three(NEAR),
            spread: splat(SPREAD),
            inside: splat(INSIDE),
        }
    }

    /// Least and largest x between two y, of those given: outside of them
    /// [`FaceTriangle::may_hit`] keeps nothing that the accepting test may accept. The first is
    /// larger where there is nothing between.
    #[inline(always)]
    pub fn clip(
        &self,
        simd: S,
        [mut x0, mut x1]: [f32x16<S>; 2],
        [y0, y1]: [f32x16<S>; 2],
    ) -> [f32x16<S>; 2] {
        let zero = f32x16::splat(simd, 0.0);
        let infinite = f32x16::splat(simd, f32::INFINITY);
        for [a, b, c] in self.edges {
            // An edge function is at most `a x + rest` there, rounding included.
            let rest = y0.mul_add(b, c).max(y1.mul_add(b, c));
            let bound = rest / -a;
            let slack = f32x16::splat(simd, CLIP_SLACK) * bound.abs();
            x0 = a.simd_gt(zero).select(x0.max(bound - slack), x0);
            x1 = a.simd_lt(zero).select(x1.min(bound + slack), x1);
            let is_beside = a.simd_eq(zero) & rest.simd_lt(zero);
            x0 = is_beside.select(infinite, x0);
        }
        [x0, x1]
    }

    /// Writes the triangles one after the other, given their least and largest x.
    #[inline(always)]
    pub fn store(&self, [x0, x1]: [f32x16<S>; 2], triangles: &mut [FaceTriangle; LANES]) {
        let ([a, b, c], [d, e, f]) = (self.edges, self.near);
        let rows = transpose([
            a[0],
            a[1],
            a[2],
            b[0],
            b[1],
            b[2],
            c[0],
            c[1],
            c[2],
            d,
            e,
            f,
            x0,
            x1,
            self.spread,
            self.inside,
        ]);
        for (triangle, row) in triangles.iter_mut().zip(rows) {
            row.store_slice(&mut triangle.planes);
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
