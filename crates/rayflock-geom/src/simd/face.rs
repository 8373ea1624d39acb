//! Faces: planes on which rays that share an origin or a direction are points, and triangles are
//! triangles.
//!
//! ```text
//!   p = v - center      [x y w] = rows * p
//!   central    rays share their origin, the center    point (x / w, y / w)   nearness 1 / w
//!   parallel   rays share their direction, rows[2]    point (x, y)           nearness -w
//! ```
//!
//! Nearness grows toward the rays' start and is linear over a triangle's place on the face. So a
//! ray is a point with a least nearness, a triangle three points with a nearness each, and one set
//! of kernels serves both kinds.
//!
//! **Invariants.** Nothing here decides where rounding might, so everything carries a margin: an
//! accepted ray's point lies within `margin` of the triangle of the projected corners, for each
//! coordinate. `margin` covers what the accepting test moves a corner ([`PERTURBATION`] of its
//! distance from the ray's origin) and the rounding of both projections:
//! - central: with `s = 1 + x^2 + y^2` the corner moves by at most
//!   `sqrt 2 (PERTURBATION + 4 u) s`, the ray's point by `6 u s`; together below
//!   `3 * PERTURBATION * s`;
//! - parallel: with `s` the distances of corner and ray's origin from the center, the corner moves
//!   by `(PERTURBATION + 6 u) s` (two of these as rows are not exactly at right angles with the
//!   direction), the ray's point by `4 u s`; together below `2 * PERTURBATION * s`.
//!
//! Triangles that reach behind the start of central rays, or are out of range, have no place on
//! the face; they are told apart and set up one by one.
//!
//! **Cost.** Some 60 operations and three divisions for 16 triangles.

use glam::Vec3;

use super::aligned_rays::Order;
use super::axes::{Axes, dot, splat_axes, subtract};
use super::ray_triangle::{DEPTH_ERROR, PERTURBATION};
use super::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16, u32x16};

/// Points of central rays lie within this square: 63 degrees to each side.
pub const WIDEST_POINT: f32 = 2.0;

/// Beyond these, numbers are too small or large to be reckoned with in `f32`.
pub(super) const SMALLEST: f32 = 1e-30;
pub(super) const LARGEST: f32 = 1e30;

/// The same for coordinates on parallel faces, which are multiplied with each other.
pub(super) const FARTHEST: f32 = 1e15;

/// Corners of central faces whose `1 + x^2 + y^2` is larger lie as good as beside the origin.
pub(super) const WIDEST_CORNER: f32 = (1 << 20) as f32;

/// What rays share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaceKind {
    /// Their origin.
    Central,
    /// Their direction. No origin is farther than `reach` from the center, in scene units.
    Parallel {
        /// The largest distance of an origin.
        reach: f32,
    },
}

/// A plane that rays pierce at a point each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    /// What rays share.
    pub kind: FaceKind,
    /// The shared origin, or the middle of the rays' origins.
    pub center: Vec3,
    /// Two axes along the face and the axis along which rays go, orthonormal but for rounding.
    pub rows: [Vec3; 3],
}

/// Where sixteen rays pierce a face.
#[derive(Clone, Copy, Debug)]
pub struct RayPoints<S: Simd> {
    /// First coordinate.
    pub x: f32x16<S>,
    /// Second coordinate.
    pub y: f32x16<S>,
    /// Depth (`w`) for each unit of `t`.
    pub pace: f32x16<S>,
    /// Depth where the ray starts; 0 on central faces.
    pub start: f32x16<S>,
    /// Rays that have a place on the face; the others' coordinates are anything.
    pub on_face: mask32x16<S>,
}

/// Sixteen triangles on a face.
#[derive(Clone, Copy, Debug)]
pub struct FaceTriangles<S: Simd> {
    /// First coordinates of the corners.
    pub x: [f32x16<S>; 3],
    /// Second coordinates.
    pub y: [f32x16<S>; 3],
    /// Nearness of the corners.
    pub near: [f32x16<S>; 3],
    /// By how much coordinates of corners may be off against points of rays that are accepted.
    pub margin: f32x16<S>,
    /// By how much the accepted nearness may exceed that of the corners.
    pub near_margin: f32x16<S>,
    /// Boxes around the triangles, margin included: least and largest x, least and largest y.
    pub bounds: [f32x16<S>; 4],
    /// Triangles with a place on the face.
    pub placed: mask32x16<S>,
    /// Triangles that no ray of the face hits, for they lie behind; none of them is `placed`.
    pub behind: mask32x16<S>,
}

impl Face {
    /// Where rays pierce the face.
    #[inline(always)]
    pub fn project_rays<S: Simd>(
        &self,
        simd: S,
        origin: Axes<S>,
        direction: Axes<S>,
    ) -> RayPoints<S> {
        let [a, b, c] = self.splat_rows(simd);
        // Directions of any length, none of which may underflow.
        let size = direction[0].abs().max(direction[1].abs()).max(direction[2].abs());
        let unit = [direction[0] / size, direction[1] / size, direction[2] / size];
        let slope = dot(c, unit);
        match self.kind {
            FaceKind::Central => {
                let (x, y) = (dot(a, unit) / slope, dot(b, unit) / slope);
                let widest = f32x16::splat(simd, WIDEST_POINT);
                let zero = f32x16::splat(simd, 0.0);
                let within = x.abs().simd_le(widest) & y.abs().simd_le(widest);
                let on_face = within & slope.simd_gt(zero);
                RayPoints { x, y, pace: slope * size, start: zero, on_face }
            }
            FaceKind::Parallel { .. } => {
                let p = subtract(origin, splat_axes(simd, self.center));
                let (x, y, start) = (dot(a, p), dot(b, p), dot(c, p));
                let extent = x.abs() + y.abs() + start.abs();
                let on_face = extent.simd_lt(f32x16::splat(simd, FARTHEST));
                RayPoints { x, y, pace: slope * size, start, on_face }
            }
        }
    }

    /// The least nearness at which rays accept hits up to `t_far`, lowered for rounding; minus
    /// infinity where numbers are out of range.
    #[inline(always)]
    pub fn limit<S: Simd>(&self, simd: S, points: &RayPoints<S>, t_far: f32x16<S>) -> f32x16<S> {
        self.nearness(simd, points, t_far, -1.0)
    }

    /// The largest nearness at which rays accept hits from `t_min` on, raised for rounding;
    /// infinity where numbers are out of range.
    #[inline(always)]
    pub fn begin<S: Simd>(&self, simd: S, points: &RayPoints<S>, t_min: f32x16<S>) -> f32x16<S> {
        self.nearness(simd, points, t_min, 1.0)
    }

    /// The least and the largest nearness between which rays accept hits for certain: their `t` lie
    /// in the interval, zero and numbers out of range left out.
    #[inline(always)]
    pub fn surely<S: Simd>(
        &self,
        simd: S,
        points: &RayPoints<S>,
        [t_min, t_max]: [f32x16<S>; 2],
    ) -> [f32x16<S>; 2] {
        // What lies beyond the begin of what is beyond the end, lies before the end.
        let t_max = t_max.min(f32x16::splat(simd, FARTHEST));
        let t_min = t_min.max(f32x16::splat(simd, 1.0 / FARTHEST));
        [self.begin(simd, points, t_max), self.limit(simd, points, t_min)]
    }

    /// Nearness at `t`, moved for rounding into the direction of `sign`.
    #[inline(always)]
    fn nearness<S: Simd>(
        &self,
        simd: S,
        points: &RayPoints<S>,
        t: f32x16<S>,
        sign: f32,
    ) -> f32x16<S> {
        let splat = f32x16::splat;
        let way = t * points.pace;
        let smallest = splat(simd, SMALLEST);
        let (nearness, in_range) = match self.kind {
            FaceKind::Central => {
                let moved = splat(simd, 1.0 + sign * 2.0 * PERTURBATION) / way;
                (moved, way.simd_ge(smallest) & t.simd_ge(smallest))
            }
            FaceKind::Parallel { .. } => {
                let extent = points.x.abs() + points.y.abs() + points.start.abs() + way.abs();
                let slack = splat(simd, PERTURBATION) * extent + splat(simd, f32::MIN_POSITIVE);
                let moved = slack * splat(simd, sign) - (points.start + way);
                (moved, t.simd_ge(splat(simd, 0.0)))
            }
        };
        let in_range = in_range & points.pace.simd_ge(smallest);
        in_range.select(nearness, splat(simd, sign * f32::INFINITY))
    }

    /// Places triangles on the face, given the columns of their corners.
    #[inline(always)]
    pub fn project_triangles<S: Simd>(&self, simd: S, corners: &[Axes<S>; 3]) -> FaceTriangles<S> {
        let center = splat_axes(simd, self.center);
        let rows = self.splat_rows(simd);
        let p = [
            subtract(corners[0], center),
            subtract(corners[1], center),
            subtract(corners[2], center),
        ];
        let q = [rotate(rows, p[0]), rotate(rows, p[1]), rotate(rows, p[2])];
        let radius = largest_edge(&p);
        match self.kind {
            FaceKind::Central => place_central(simd, &q, radius),
            FaceKind::Parallel { reach } => place_parallel(simd, &q, radius, reach),
        }
    }

    #[inline(always)]
    pub(super) fn splat_rows<S: Simd>(&self, simd: S) -> [Axes<S>; 3] {
        let [a, b, c] = self.rows;
        [splat_axes(simd, a), splat_axes(simd, b), splat_axes(simd, c)]
    }
}

/// The sides of a cube around their shared origin that rays pierce, and where: rays of side `2 a`
/// go along axis a, those of side `2 a + 1` against it; x and y are along the two axes that follow
/// it, from -1 to 1.
#[inline(always)]
pub fn pierce_cube<S: Simd>(simd: S, direction: Axes<S>) -> (u32x16<S>, [f32x16<S>; 2]) {
    let order = Order::of(direction);
    let ordered = order.apply(direction);
    let inverse = f32x16::splat(simd, 1.0) / order.size;
    (order.faces(simd, ordered[2]), [ordered[0] * inverse, ordered[1] * inverse])
}

/// A radius around each triangle: the longer of two edges, as the sum of its coordinates.
#[inline(always)]
fn largest_edge<S: Simd>(p: &[Axes<S>; 3]) -> f32x16<S> {
    let (a, b) = (subtract(p[1], p[0]), subtract(p[2], p[0]));
    (a[0].abs() + a[1].abs() + a[2].abs()).max(b[0].abs() + b[1].abs() + b[2].abs())
}

#[inline(always)]
pub(super) fn rotate<S: Simd>([a, b, c]: [Axes<S>; 3], p: Axes<S>) -> Axes<S> {
    [fused_dot(a, p), fused_dot(b, p), fused_dot(c, p)]
}

#[inline(always)]
fn fused_dot<S: Simd>(a: Axes<S>, b: Axes<S>) -> f32x16<S> {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// The sum of a vector's coordinates without their signs, at least its length.
#[inline(always)]
pub(super) fn taxicab<S: Simd>(p: Axes<S>) -> f32x16<S> {
    p[0].abs() + p[1].abs() + p[2].abs()
}

#[inline(always)]
fn place_central<S: Simd>(simd: S, q: &[Axes<S>; 3], radius: f32x16<S>) -> FaceTriangles<S> {
    let splat = f32x16::splat;
    let one = splat(simd, 1.0);
    let near = [one / q[0][2], one / q[1][2], one / q[2][2]];
    let x = [q[0][0] * near[0], q[1][0] * near[1], q[2][0] * near[2]];
    let y = [q[0][1] * near[0], q[1][1] * near[1], q[2][1] * near[2]];
    let s = [
        x[0].mul_add(x[0], y[0].mul_add(y[0], one)),
        x[1].mul_add(x[1], y[1].mul_add(y[1], one)),
        x[2].mul_add(x[2], y[2].mul_add(y[2], one)),
    ];
    let s = s[0].max(s[1]).max(s[2]);
    let margin = splat(simd, 3.0 * PERTURBATION) * s;
    let nearest = near[0].max(near[1]).max(near[2]);

    // The depth of a hit is off by DEPTH_ERROR of the radius, which nearness turns into a factor.
    let relative = radius * nearest;
    let near_margin = nearest
        * splat(simd, 2.0 * DEPTH_ERROR).mul_add(relative, splat(simd, 4.0 * PERTURBATION) * s);
    let is_near = relative.simd_lt(splat(simd, 0.25 / DEPTH_ERROR));

    // A sum keeps a NaN, a maximum need not.
    let extent = taxicab(q[0]) + taxicab(q[1]) + taxicab(q[2]);
    let in_range = extent.simd_lt(splat(simd, LARGEST));
    let least = q[0][2].min(q[1][2]).min(q[2][2]);
    let most = q[0][2].max(q[1][2]).max(q[2][2]);
    let in_front = least.simd_gt(splat(simd, SMALLEST));
    let placed = in_range & in_front & is_near & s.simd_lt(splat(simd, WIDEST_CORNER));
    let behind = in_range & most.simd_lt(splat(simd, -4.0 * DEPTH_ERROR) * extent);
    let bounds = bounds(&x, &y, margin);
    FaceTriangles { x, y, near, margin, near_margin, bounds, placed, behind }
}

#[inline(always)]
fn place_parallel<S: Simd>(
    simd: S,
    q: &[Axes<S>; 3],
    radius: f32x16<S>,
    reach: f32,
) -> FaceTriangles<S> {
    let splat = f32x16::splat;
    let (x, y) = ([q[0][0], q[1][0], q[2][0]], [q[0][1], q[1][1], q[2][1]]);
    let near = [-q[0][2], -q[1][2], -q[2][2]];
    let (a, b, c) = (taxicab(q[0]), taxicab(q[1]), taxicab(q[2]));
    let placed = (a + b + c).simd_lt(splat(simd, FARTHEST));
    let extent = a.max(b).max(c) + splat(simd, reach);
    let margin = splat(simd, 2.0 * PERTURBATION).mul_add(extent, splat(simd, f32::MIN_POSITIVE));
    let near_margin = splat(simd, DEPTH_ERROR).mul_add(radius, margin + margin);
    let behind = mask32x16::splat(simd, false);
    let bounds = bounds(&x, &y, margin);
    FaceTriangles { x, y, near, margin, near_margin, bounds, placed, behind }
}

#[inline(always)]
fn bounds<S: Simd>(x: &[f32x16<S>; 3], y: &[f32x16<S>; 3], margin: f32x16<S>) -> [f32x16<S>; 4] {
    [
        x[0].min(x[1]).min(x[2]) - margin,
        x[0].max(x[1]).max(x[2]) + margin,
        y[0].min(y[1]).min(y[2]) - margin,
        y[0].max(y[1]).max(y[2]) + margin,
    ]
}
