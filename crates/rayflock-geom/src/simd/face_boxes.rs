//! Boxes on a face around sixteen triangles, from their boxes in space: less tight than what
//! projecting each corner gives, for a third of the operations.
//!
//! Most triangles of a frame are far from all of a few rays. They are asked with these boxes;
//! those that are left are projected.
//!
//! ```text
//!   s = (min - center) + (max - center)     d = (max - center) - (min - center)
//!   q = rows * s     h = |rows| * d         every corner lies within q - h .. q + h, all twofold
//!   central     n = 1 / q_z, k = h_z n      x within  q_x n  -+  (h_x + |q_x n| h_z) n (1 + 2 k)
//!   parallel                                x within  (q_x -+ h_x) / 2
//! ```
//!
//! **Invariants.** Where a box is `certain`, it contains the one of
//! [`Face::project_triangles`] if the triangle has a place on the face, and otherwise no ray of
//! the face hits the triangle. Proven for central faces: a corner is `(q_x + a) / (q_z + b)` with
//! `|a| <= h_x`, `|b| <= h_z`, which is off from `q_x / q_z` by at most
//! `(h_x + |x| h_z) / (q_z - h_z)`, and `1 / (1 - k) <= 1 + 2 k` as `k <= 1/2` is asked for.
//! Rounding adds some 16 u of the distance from the center, which the added part covers along with
//! the margin of the corners.
//!
//! **Cost.** Some 75 operations and one division for 16 triangles; on all six sides of a cube 130
//! and three.

use glam::Vec3;

use super::axes::{Axes, splat_axes, subtract};
use super::face::{FARTHEST, Face, FaceKind, LARGEST, SMALLEST, WIDEST_CORNER, rotate, taxicab};
use super::ray_triangle::{DEPTH_ERROR, PERTURBATION};
use super::{Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16};

/// Boxes around sixteen triangles.
#[derive(Clone, Copy, Debug)]
pub struct FaceBoxes<S: Simd> {
    /// Least and largest x, least and largest y.
    pub bounds: [f32x16<S>; 4],
    /// Where the box says all.
    pub certain: mask32x16<S>,
    /// Triangles that no ray of the face hits, whatever their box is.
    pub behind: mask32x16<S>,
}

/// Boxes in space around sixteen triangles, seen from the center of a face.
#[derive(Clone, Copy, Debug)]
pub struct SpaceBoxes<S: Simd> {
    /// Twice their middles.
    sum: Axes<S>,
    /// Twice their half sizes.
    size: Axes<S>,
}

impl<S: Simd> SpaceBoxes<S> {
    /// Boxes around triangles, given the columns of their corners.
    #[inline(always)]
    pub fn around(simd: S, [a, b, c]: &[Axes<S>; 3], center: Vec3) -> Self {
        let min = [a[0].min(b[0]).min(c[0]), a[1].min(b[1]).min(c[1]), a[2].min(b[2]).min(c[2])];
        let max = [a[0].max(b[0]).max(c[0]), a[1].max(b[1]).max(c[1]), a[2].max(b[2]).max(c[2])];
        let center = splat_axes(simd, center);
        let (min, max) = (subtract(min, center), subtract(max, center));
        let sum = [min[0] + max[0], min[1] + max[1], min[2] + max[2]];
        Self { sum, size: subtract(max, min) }
    }

    /// The boxes on two sides of the cube around the center: that along an axis, and that against
    /// it. Coordinates on both are along the two axes that follow it.
    ///
    /// The same as [`Face::place_boxes`] of central faces with these axes, as what lies before the
    /// one lies behind the other.
    #[inline(always)]
    pub fn on_sides(&self, simd: S, axis: usize) -> [FaceBoxes<S>; 2] {
        let turned = |v: &Axes<S>| [v[(axis + 1) % 3], v[(axis + 2) % 3], v[axis]];
        let (q, h) = (turned(&self.sum), turned(&self.size));
        let zero = f32x16::splat(simd, 0.0);
        let (along, against) = (q[2].simd_gt(zero), q[2].simd_lt(zero));
        let placed = box_central(simd, [q[0], q[1], q[2].abs()], h);
        let least = f32x16::splat(simd, -16.0 * DEPTH_ERROR) * (taxicab(q) + taxicab(h));
        [(along, h[2] + q[2]), (against, h[2] - q[2])].map(|(is_before, farthest)| FaceBoxes {
            certain: placed.certain & is_before,
            behind: farthest.simd_lt(least),
            ..placed
        })
    }
}

impl Face {
    /// Boxes around triangles, given their boxes in space.
    #[inline(always)]
    pub fn place_boxes<S: Simd>(&self, simd: S, boxes: &SpaceBoxes<S>) -> FaceBoxes<S> {
        let q = rotate(self.splat_rows(simd), boxes.sum);
        let [x, y, z] = self.rows;
        let absolute =
            [splat_axes(simd, x.abs()), splat_axes(simd, y.abs()), splat_axes(simd, z.abs())];
        let h = rotate(absolute, boxes.size);
        match self.kind {
            FaceKind::Central => box_central(simd, q, h),
            FaceKind::Parallel { reach } => box_parallel(simd, q, h, reach),
        }
    }
}

#[inline(always)]
fn box_central<S: Simd>(simd: S, q: Axes<S>, h: Axes<S>) -> FaceBoxes<S> {
    let splat = f32x16::splat;
    let n = splat(simd, 1.0) / q[2];
    let (x, y, k) = (q[0] * n, q[1] * n, h[2] * n);
    let stretched = n.mul_add(k + k, n);
    let wide = splat(simd, 1.0) + x.abs() + y.abs();
    let added = splat(simd, 24.0 * PERTURBATION) * wide * wide;
    let x_reach = x.abs().mul_add(h[2], h[0]).mul_add(stretched, added);
    let y_reach = y.abs().mul_add(h[2], h[1]).mul_add(stretched, added);
    let extent = taxicab(q) + taxicab(h);
    // A corner must not be so far to the side that its margin is larger than what is added.
    let spread = x_reach + y_reach;
    let certain = k.simd_le(splat(simd, 0.5))
        & q[2].simd_gt(splat(simd, 4.0 * SMALLEST))
        & spread.simd_le(wide)
        & (wide * wide).simd_lt(splat(simd, WIDEST_CORNER / 16.0))
        & extent.simd_lt(splat(simd, LARGEST));
    let behind = (q[2] + h[2]).simd_lt(splat(simd, -16.0 * DEPTH_ERROR) * extent);
    let bounds = [x - x_reach, x + x_reach, y - y_reach, y + y_reach];
    FaceBoxes { bounds, certain, behind }
}

#[inline(always)]
fn box_parallel<S: Simd>(simd: S, q: Axes<S>, h: Axes<S>, reach: f32) -> FaceBoxes<S> {
    let splat = f32x16::splat;
    let half = splat(simd, 0.5);
    let extent = taxicab(q) + taxicab(h);
    let certain = extent.simd_lt(splat(simd, 0.25 * FARTHEST));
    let least = splat(simd, 4.0 * PERTURBATION * reach + 2.0 * f32::MIN_POSITIVE);
    let added = splat(simd, 4.0 * PERTURBATION).mul_add(extent, least);
    let (x_reach, y_reach) = (h[0].mul_add(half, added), h[1].mul_add(half, added));
    let (x, y) = (q[0] * half, q[1] * half);
    let behind = mask32x16::splat(simd, false);
    let bounds = [x - x_reach, x + x_reach, y - y_reach, y + y_reach];
    FaceBoxes { bounds, certain, behind }
}
