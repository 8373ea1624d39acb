//! The one accepting ray-triangle test.
//!
//! A ray is sheared so that it becomes the z axis; a triangle is hit iff the origin of the xy
//! plane lies inside it, which the signs of three edge functions tell.
//!
//! ```text
//!   kz = axis of the largest |direction|, kx and ky the two after it (cyclic)
//!   p  = vertex - origin                  x = p[kx] - sx * p[kz]     sx = d[kx] / d[kz]
//!                                         y = p[ky] - sy * p[kz]     sy = d[ky] / d[kz]
//!   U = cx*by - cy*bx    V = ax*cy - ay*cx    W = bx*ay - by*ax      det = (U + V) + W
//!   z = ((U*az + V*bz) + W*cz) / det      t = z / d[kz]      u = V / det      v = W / det
//! ```
//!
//! **Source.** S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1),
//! 2013.
//!
//! **Departures.** Two-sided, so the paper's swap of kx and ky is left out. `z` stays unscaled and
//! is divided by `d[kz]` at the end, so that tiny and huge directions neither overflow nor lose
//! digits. Not only edge values of exactly zero go to `f64`, but also those that underflow or
//! overflow, and triangles seen edge-on, whose depth would lose its digits.
//! `docs/algorithms/intersection.md` compares this test with the scalar triple product.
//!
//! **Invariants.**
//! - One sequence of IEEE operations without FMA: any SIMD level and either way of filling the
//!   lanes agree to the bit.
//! - Exact signs: rounding is monotone, so a difference of two rounded products never has the
//!   wrong sign; where it is zero, `f64` holds both products exactly. What is accepted is thus
//!   the exact triangle of the *rounded* sheared vertices. They depend on ray and vertex alone,
//!   so triangles that share an edge leave no gap.
//! - A sheared vertex is off by at most six rounding units of `max |vertex - origin|`; see
//!   [`PERTURBATION`].
//!
//! **Cost.** About 60 operations and four divisions for 16 pairs.

use glam::Vec3;

use super::aligned_rays::face_axes;
use super::axes::{Axes, load_axes, load_ordered_axes, splat_axes, store_axes, subtract};
use super::neighbours::Slopes;
use super::ray_lanes::RayLanes;
use super::{LANES, Lanes, Select, Simd, SimdBase, SimdMask, f32x16, mask32x16};
use crate::Ray;

/// How far the accepting test may move a vertex sideways, relative to the largest coordinate of
/// `vertex - origin`: six rounding units (one each for two coordinates of that difference, the
/// quotient and the product, two for the final difference) times sqrt 2 for two coordinates, with
/// a margin of almost two. Whoever rejects triangles early must keep those within this distance
/// of a ray.
pub const PERTURBATION: f32 = 1.0 / (1 << 20) as f32;

/// Edge values beyond these bounds are computed again in `f64`. Below the smallest, products with
/// the depth of a corner underflow by more than the test may err.
const SMALLEST_EDGE: f32 = 1e-24;
const LARGEST_EDGE: f32 = 1e27;

/// Triangles whose sheared area is this part of the square of their sheared coordinates, or less,
/// are computed again in `f64`: seen edge-on, rounded edge values would leave `t` anywhere between
/// the corners' depths.
const THINNEST: f32 = 1.0 / 64.0;

/// How far `t` may lie off the triangle of the rounded vertices, relative to a radius around it:
/// each edge value is off by at most four rounding units of the square of the coordinates, the
/// sum of three by twelve, so a weight by `12 * 64` units; times two radii of depth, times sqrt 3
/// for the slant of the ray. With a margin of one half.
pub const DEPTH_ERROR: f32 = 1.0 / (1 << 12) as f32;

/// What the accepting test needs to know about one ray.
#[derive(Clone, Copy, Debug)]
pub struct ShearedRay {
    /// Start of the ray.
    pub origin: Vec3,
    /// The axes kx, ky, kz.
    pub axes: [usize; 3],
    /// sx, sy and `d[kz]`.
    pub shear: [f32; 3],
    /// Smallest accepted `t`.
    pub t_min: f32,
    /// Largest accepted `t`.
    pub t_max: f32,
}

impl ShearedRay {
    /// Prepares an active ray.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let d = ray.direction.to_array();
        let size = d.map(f32::abs);
        let mut kz = 0;
        if size[1] > size[kz] {
            kz = 1;
        }
        if size[2] > size[kz] {
            kz = 2;
        }
        let (kx, ky) = ((kz + 1) % 3, (kz + 2) % 3);
        Self {
            origin: ray.origin,
            axes: [kx, ky, kz],
            shear: [d[kx] / d[kz], d[ky] / d[kz], d[kz]],
            t_min: ray.t_min,
            t_max: ray.t_max,
        }
    }
}

/// Sixteen triangles: `corners[corner][axis][lane]`.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct TriangleBlock {
    /// World-space corners.
    pub corners: [[Lanes; 3]; 3],
}

impl TriangleBlock {
    /// Sixteen triangles without area, which nothing hits.
    pub const EMPTY: Self = Self { corners: [[[0.0; LANES]; 3]; 3] };

    /// Writes the triangle of one lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, corners: [Vec3; 3]) {
        for (columns, corner) in self.corners.iter_mut().zip(corners) {
            for (column, coordinate) in columns.iter_mut().zip(corner.to_array()) {
                column[lane] = coordinate;
            }
        }
    }

    /// The triangle of one lane.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> [Vec3; 3] {
        let corner = |axes: &[Lanes; 3]| Vec3::new(axes[0][lane], axes[1][lane], axes[2][lane]);
        [corner(&self.corners[0]), corner(&self.corners[1]), corner(&self.corners[2])]
    }
}

/// Sixteen rays as columns.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct RayPacket {
    /// Origins by axis.
    pub origin: [Lanes; 3],
    /// sx, sy and `d[kz]`.
    pub shear: [Lanes; 3],
    /// Which rays have the axis kz = x, and which y, one bit a lane.
    pub major: [u16; 2],
    /// Smallest accepted `t`.
    pub t_min: Lanes,
    /// Largest accepted `t`.
    pub t_max: Lanes,
}

impl RayPacket {
    /// Sixteen rays with empty intervals, which hit nothing.
    pub const EMPTY: Self = Self {
        origin: [[0.0; LANES]; 3],
        shear: [[0.0; LANES], [0.0; LANES], [1.0; LANES]],
        major: [0; 2],
        t_min: [f32::INFINITY; LANES],
        t_max: [f32::NEG_INFINITY; LANES],
    };

    /// Writes the ray of one lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, ray: &ShearedRay) {
        for (column, coordinate) in self.origin.iter_mut().zip(ray.origin.to_array()) {
            column[lane] = coordinate;
        }
        for (column, factor) in self.shear.iter_mut().zip(ray.shear) {
            column[lane] = factor;
        }
        for (axis, bits) in self.major.iter_mut().enumerate() {
            *bits = (*bits & !(1 << lane)) | (u16::from(ray.axes[2] == axis) << lane);
        }
        self.t_min[lane] = ray.t_min;
        self.t_max[lane] = ray.t_max;
    }

    /// Writes all rays, given as columns, as [`ShearedRay::new`] would one by one.
    #[inline(always)]
    pub fn fill<S: Simd>(
        &mut self,
        simd: S,
        origin: Axes<S>,
        direction: Axes<S>,
        [t_min, t_max]: [f32x16<S>; 2],
    ) {
        let [x, y, z] = direction;
        let size = [x.abs(), y.abs(), z.abs()];
        let y_leads = size[1].simd_gt(size[0]);
        let major_z = size[2].simd_gt(y_leads.select(size[1], size[0]));
        let (major_x, major_y) = (!(major_z | y_leads), y_leads & !major_z);
        self.major = [major_x.to_bitmask() as u16, major_y.to_bitmask() as u16];
        let [x, y, z] = permute_lanes(simd, self.major, direction);
        store_axes(&[x / z, y / z, z], &mut self.shear);
        store_axes(&origin, &mut self.origin);
        t_min.store_slice(&mut self.t_min);
        t_max.store_slice(&mut self.t_max);
    }

    /// Writes all rays, given as they were asked and by their slopes on the one face of a cube
    /// through which those that count go.
    #[inline(always)]
    pub fn fill_sloped<S: Simd>(&mut self, rays: &RayLanes, slopes: &Slopes<S>) {
        let [.., kz] = face_axes(slopes.face());
        self.major = [0, 1].map(|axis| if axis == kz { u16::MAX } else { 0 });
        self.origin = rays.origin;
        store_axes(&slopes.shear, &mut self.shear);
        (self.t_min, self.t_max) = (rays.t_min, rays.t_max);
    }

    /// The axis kz that all rays share, if they do.
    #[inline(always)]
    fn common_axis(&self) -> Option<usize> {
        match self.major {
            [u16::MAX, _] => Some(0),
            [_, u16::MAX] => Some(1),
            [0, 0] => Some(2),
            _ => None,
        }
    }
}

/// The outcome of sixteen tests; lanes that were not accepted hold anything.
#[derive(Clone, Copy, Debug)]
pub struct LaneHits<S: Simd> {
    /// Where the triangle is hit within the interval.
    pub accepted: mask32x16<S>,
    /// Distances in multiples of the direction's length.
    pub t: f32x16<S>,
    /// Barycentric coordinates of vertices 1 and 2, times `det`: divided where hits are kept.
    weights: [f32x16<S>; 2],
    det: f32x16<S>,
}

impl<S: Simd> LaneHits<S> {
    /// Barycentric coordinates of vertex 1 and of vertex 2.
    #[inline(always)]
    pub fn barycentric(&self) -> [f32x16<S>; 2] {
        let [u, v] = self.weights;
        [u / self.det, v / self.det]
    }
}

/// One ray against sixteen triangles; only `active` lanes count.
#[inline(always)]
pub fn intersect_block<S: Simd>(
    simd: S,
    ray: &ShearedRay,
    block: &TriangleBlock,
    active: mask32x16<S>,
) -> LaneHits<S> {
    let [a, b, c] = &block.corners;
    let corners =
        [relative_axes(simd, a, ray), relative_axes(simd, b, ray), relative_axes(simd, c, ray)];
    let shear = splat_axes(simd, ray.shear.into());
    let interval = [f32x16::splat(simd, ray.t_min), f32x16::splat(simd, ray.t_max)];
    intersect_sheared(simd, corners, shear, interval, active)
}

/// Corners relative to the origin of one ray, in its order kx, ky, kz.
#[inline(always)]
fn relative_axes<S: Simd>(simd: S, corner: &[Lanes; 3], ray: &ShearedRay) -> Axes<S> {
    let [kx, ky, kz] = ray.axes;
    [
        f32x16::from_slice(simd, &corner[kx]) - f32x16::splat(simd, ray.origin[kx]),
        f32x16::from_slice(simd, &corner[ky]) - f32x16::splat(simd, ray.origin[ky]),
        f32x16::from_slice(simd, &corner[kz]) - f32x16::splat(simd, ray.origin[kz]),
    ]
}

/// Sixteen triangles in registers, for many rays with the same axes kx, ky, kz.
#[derive(Clone, Copy, Debug)]
pub struct AlignedBlock<S: Simd> {
    /// Corners, each in the order kx, ky, kz.
    corners: [[f32x16<S>; 3]; 3],
}

impl<S: Simd> AlignedBlock<S> {
    /// Loads triangles for rays with these axes.
    #[inline(always)]
    pub fn load(simd: S, block: &TriangleBlock, axes: [usize; 3]) -> Self {
        let [a, b, c] = &block.corners;
        let load = load_ordered_axes;
        Self { corners: [load(simd, a, axes), load(simd, b, axes), load(simd, c, axes)] }
    }
}

/// [`intersect_block`] for triangles that have been loaded for the axes of the ray, and the origin
/// of the ray in their order.
#[inline(always)]
pub fn intersect_aligned<S: Simd>(
    simd: S,
    origin: Vec3,
    shear: [f32; 3],
    [t_min, t_max]: [f32; 2],
    block: &AlignedBlock<S>,
    active: mask32x16<S>,
) -> LaneHits<S> {
    let origin = splat_axes(simd, origin);
    let [a, b, c] = block.corners;
    let corners = [subtract(a, origin), subtract(b, origin), subtract(c, origin)];
    let interval = [f32x16::splat(simd, t_min), f32x16::splat(simd, t_max)];
    intersect_sheared(simd, corners, splat_axes(simd, shear.into()), interval, active)
}

/// Sixteen rays against one triangle; only `active` lanes count.
#[inline(always)]
pub fn intersect_packet<S: Simd>(
    simd: S,
    packet: &RayPacket,
    corners: &[Vec3; 3],
    active: mask32x16<S>,
) -> LaneHits<S> {
    let origin = load_axes(simd, &packet.origin);
    let a = subtract(splat_axes(simd, corners[0]), origin);
    let b = subtract(splat_axes(simd, corners[1]), origin);
    let c = subtract(splat_axes(simd, corners[2]), origin);
    let permuted = match packet.common_axis() {
        Some(0) => [[a[1], a[2], a[0]], [b[1], b[2], b[0]], [c[1], c[2], c[0]]],
        Some(1) => [[a[2], a[0], a[1]], [b[2], b[0], b[1]], [c[2], c[0], c[1]]],
        Some(_) => [a, b, c],
        None => {
            let major = packet.major;
            [
                permute_lanes(simd, major, a),
                permute_lanes(simd, major, b),
                permute_lanes(simd, major, c),
            ]
        }
    };
    let shear = load_axes(simd, &packet.shear);
    let interval =
        [f32x16::from_slice(simd, &packet.t_min), f32x16::from_slice(simd, &packet.t_max)];
    intersect_sheared(simd, permuted, shear, interval, active)
}

/// Brings each lane's coordinates into the order kx, ky, kz of its own ray.
#[inline(always)]
fn permute_lanes<S: Simd>(simd: S, major: [u16; 2], [x, y, z]: Axes<S>) -> Axes<S> {
    let major_x = mask32x16::from_bitmask(simd, major[0].into());
    let major_y = mask32x16::from_bitmask(simd, major[1].into());
    [
        major_x.select(y, major_y.select(z, x)),
        major_x.select(z, major_y.select(x, y)),
        major_x.select(x, major_y.select(y, z)),
    ]
}

/// Corners sheared so that the ray is the z axis, and the edge functions at its origin.
#[derive(Clone, Copy)]
struct Sheared<S: Simd> {
    corners: [Axes<S>; 3],
    /// U, V and W.
    edges: Axes<S>,
}

impl<S: Simd> Sheared<S> {
    /// Shears corners relative to the origin in the order kx, ky, kz, and forms edge functions.
    #[inline(always)]
    fn new([a, b, c]: [Axes<S>; 3], [sx, sy, _]: Axes<S>) -> Self {
        let (ax, ay) = (a[0] - sx * a[2], a[1] - sy * a[2]);
        let (bx, by) = (b[0] - sx * b[2], b[1] - sy * b[2]);
        let (cx, cy) = (c[0] - sx * c[2], c[1] - sy * c[2]);
        let edges = [cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax];
        Self { corners: [[ax, ay, a[2]], [bx, by, b[2]], [cx, cy, c[2]]], edges }
    }

    /// Where two signs differ: these are exact whatever the third is.
    #[inline(always)]
    fn is_outside(&self, simd: S) -> mask32x16<S> {
        let zero = f32x16::splat(simd, 0.0);
        let [u, v, w] = self.edges;
        let positive = u.simd_gt(zero) | v.simd_gt(zero) | w.simd_gt(zero);
        let negative = u.simd_lt(zero) | v.simd_lt(zero) | w.simd_lt(zero);
        positive & negative
    }
}

/// The test itself, on corners relative to the origin in the order kx, ky, kz.
#[inline(always)]
fn intersect_sheared<S: Simd>(
    simd: S,
    corners: [Axes<S>; 3],
    shear: Axes<S>,
    [t_min, t_max]: [f32x16<S>; 2],
    active: mask32x16<S>,
) -> LaneHits<S> {
    let zero = f32x16::splat(simd, 0.0);
    let sheared = Sheared::new(corners, shear);
    let inside = active & !sheared.is_outside(simd);
    if !inside.any_true() {
        // Divisions cost as much as all the rest.
        return LaneHits { accepted: inside, t: zero, weights: [zero; 2], det: zero };
    }
    let [a, b, c] = sheared.corners;
    let [u_edge, v_edge, w_edge] = sheared.edges;

    // Interpolate the depth.
    let det = (u_edge + v_edge) + w_edge;
    let z = ((u_edge * a[2] + v_edge * b[2]) + w_edge * c[2]) / det;
    let t = z / shear[2];
    let mut hits = LaneHits { accepted: inside, t, weights: [v_edge, w_edge], det };

    // Compute again in f64 what is on an edge, seen edge-on or out of range.
    let size = [u_edge.abs(), v_edge.abs(), w_edge.abs()];
    let smallest = size[0].min(size[1]).min(size[2]);
    let largest = size[0].max(size[1]).max(size[2]);
    let (x_extent, y_extent) = (extent(a[0], b[0], c[0]), extent(a[1], b[1], c[1]));
    let thinnest = f32x16::splat(simd, THINNEST) * (x_extent * x_extent + y_extent * y_extent);
    let plain = smallest.simd_gt(zero)
        & det.abs().simd_gt(thinnest)
        & largest.simd_gt(f32x16::splat(simd, SMALLEST_EDGE))
        & largest.simd_lt(f32x16::splat(simd, LARGEST_EDGE))
        & is_finite(simd, t);
    let rare = (inside & !plain).to_bitmask();
    if rare != 0 {
        hits = intersect_rare(simd, rare, sheared.corners, shear[2], hits);
    }
    let within = hits.t.simd_ge(t_min) & hits.t.simd_le(t_max) & is_finite(simd, hits.t);
    hits.accepted &= within;
    hits
}

/// The largest of three coordinates, without its sign.
#[inline(always)]
fn extent<S: Simd>(a: f32x16<S>, b: f32x16<S>, c: f32x16<S>) -> f32x16<S> {
    a.abs().max(b.abs()).max(c.abs())
}

#[inline(always)]
fn is_finite<S: Simd>(simd: S, value: f32x16<S>) -> mask32x16<S> {
    value.abs().simd_lt(f32x16::splat(simd, f32::INFINITY))
}

/// Replaces the lanes in `rare` by the outcome in `f64`.
#[inline(always)]
fn intersect_rare<S: Simd>(
    simd: S,
    rare: u64,
    sheared: [Axes<S>; 3],
    dz: f32x16<S>,
    hits: LaneHits<S>,
) -> LaneHits<S> {
    let mut accepted = hits.accepted.to_bitmask();
    let [mut u, mut v] = hits.weights.map(|weight| *weight);
    let (mut t, mut det) = (*hits.t, *hits.det);
    let mut remaining = rare;
    while remaining != 0 {
        let lane = remaining.trailing_zeros() as usize;
        remaining &= remaining - 1;
        let mut corners = [[0.0; 3]; 3];
        for (corner, axes) in corners.iter_mut().zip(&sheared) {
            for (coordinate, axis) in corner.iter_mut().zip(axes) {
                *coordinate = axis[lane];
            }
        }
        match intersect_in_f64(corners, dz[lane]) {
            Some(outcome) => {
                [t[lane], u[lane], v[lane]] = outcome;
                det[lane] = 1.0;
            }
            None => accepted &= !(1 << lane),
        }
    }
    LaneHits {
        accepted: mask32x16::from_bitmask(simd, accepted),
        t: f32x16::from_slice(simd, &t),
        weights: [f32x16::from_slice(simd, &u), f32x16::from_slice(simd, &v)],
        det: f32x16::from_slice(simd, &det),
    }
}

/// The test from the sheared corners on, in `f64`: products of `f32` values are exact, and the
/// sign of their difference is too. Returns t, u and v.
#[cold]
#[inline(never)]
fn intersect_in_f64(corners: [[f32; 3]; 3], dz: f32) -> Option<[f32; 3]> {
    let [a, b, c] = corners.map(|corner| corner.map(f64::from));
    let u_edge = c[0] * b[1] - c[1] * b[0];
    let v_edge = a[0] * c[1] - a[1] * c[0];
    let w_edge = b[0] * a[1] - b[1] * a[0];
    let edges = [u_edge, v_edge, w_edge];
    let inside = edges.iter().all(|&edge| edge >= 0.0) || edges.iter().all(|&edge| edge <= 0.0);
    let det = (u_edge + v_edge) + w_edge;
    if !inside || det == 0.0 {
        return None;
    }
    let z = ((u_edge * a[2] + v_edge * b[2]) + w_edge * c[2]) / det;
    Some([(z / f64::from(dz)) as f32, (v_edge / det) as f32, (w_edge / det) as f32])
}

#[cfg(test)]
#[path = "ray_triangle_tests.rs"]
mod tests;
