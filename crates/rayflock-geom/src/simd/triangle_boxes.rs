//! The box around sixteen triangles, or sixteen bounding spheres, for trees of boxes.
//!
//! **Invariants.** The accepting test gets the depth of a triangle to
//! [`DEPTH_ERROR`] of a radius around it, and half the diagonal of its box is such a radius: by
//! half the sum of its edges, which is more, boxes are enlarged. What is left, the sideways
//! [`PERTURBATION`](super::ray_triangle::PERTURBATION) and rounding, is relative to the distance
//! from the ray and added there ([`ray_boxes`](super::ray_boxes)).

use super::axes::{Axes, load_axes, load_ordered_axes, subtract};
use super::cone_sphere::SphereBlock;
use super::ray_beams::BoxCorners;
use super::ray_boxes::{BoxBounds, BoxLanes, CORNER_ERROR};
use super::ray_triangle::{DEPTH_ERROR, TriangleBlock};
use super::{Simd, SimdBase, f32x16};

/// The box around sixteen triangles, enlarged.
#[inline(always)]
pub fn around_triangles<S: Simd>(simd: S, triangles: &TriangleBlock) -> BoxBounds {
    let [a, b, c] = &triangles.corners;
    let (a, b, c) = (load_axes(simd, a), load_axes(simd, b), load_axes(simd, c));
    let (min, max) = around_each(simd, [a, b, c]);
    BoxBounds::around_lanes(min, max)
}

/// Half the surfaces of the boxes around each of sixteen triangles, summed.
#[inline(always)]
pub fn half_area_around_each<S: Simd>(simd: S, triangles: &TriangleBlock) -> f32 {
    let [a, b, c] = &triangles.corners;
    let (a, b, c) = (load_axes(simd, a), load_axes(simd, b), load_axes(simd, c));
    let (min, max) = around_each(simd, [a, b, c]);
    let [x, y, z] = subtract(max, min);
    simd.reduce_sum_f32x16(x * y + y * z + z * x)
}

/// The boxes around each of sixteen triangles, enlarged, with their coordinates in the order of
/// `axes`.
#[inline(always)]
pub fn triangle_corners<S: Simd>(
    simd: S,
    triangles: &TriangleBlock,
    axes: [usize; 3],
) -> BoxCorners<S> {
    let [a, b, c] = &triangles.corners;
    let load = load_ordered_axes;
    let (min, max) =
        around_each(simd, [load(simd, a, axes), load(simd, b, axes), load(simd, c, axes)]);
    BoxCorners::between(outward(simd, min, -1.0), outward(simd, max, 1.0))
}

/// Least and largest coordinates of triangles, moved outward by the error of their depth.
#[inline(always)]
fn around_each<S: Simd>(simd: S, [a, b, c]: [Axes<S>; 3]) -> (Axes<S>, Axes<S>) {
    let min = [lowest(a[0], b[0], c[0]), lowest(a[1], b[1], c[1]), lowest(a[2], b[2], c[2])];
    let max = [highest(a[0], b[0], c[0]), highest(a[1], b[1], c[1]), highest(a[2], b[2], c[2])];
    let edges = subtract(max, min);
    let radius = (edges[0] + edges[1] + edges[2]) * f32x16::splat(simd, 0.5);
    let moved = radius * f32x16::splat(simd, DEPTH_ERROR);
    move_apart(min, max, moved)
}

/// Moves coordinates for rounding, as [`BoxBounds::between`] does.
#[inline(always)]
fn outward<S: Simd>(simd: S, corner: Axes<S>, sign: f32) -> Axes<S> {
    let error = f32x16::splat(simd, sign * CORNER_ERROR);
    [
        corner[0] + corner[0].abs() * error,
        corner[1] + corner[1].abs() * error,
        corner[2] + corner[2].abs() * error,
    ]
}

/// The box around sixteen bounding spheres, enlarged.
#[inline(always)]
pub fn around_spheres<S: Simd>(simd: S, spheres: &SphereBlock) -> BoxBounds {
    let spheres = spheres.load(simd);
    let outward = spheres.radius * f32x16::splat(simd, 1.0 + 2.0 * DEPTH_ERROR);
    let (min, max) = move_apart(spheres.center, spheres.center, outward);
    BoxBounds::around_lanes(min, max)
}

/// The boxes around each of sixteen bounding spheres, enlarged, with their coordinates in the order
/// of `axes`. Sides are moved for rounding, as [`BoxBounds::between`] does.
#[inline(always)]
pub fn sphere_boxes<S: Simd>(simd: S, spheres: &SphereBlock, axes: [usize; 3]) -> BoxLanes<S> {
    let center = load_ordered_axes(simd, &spheres.center, axes);
    let radius = f32x16::from_slice(simd, &spheres.radius);
    let outward = radius * f32x16::splat(simd, 1.0 + 2.0 * DEPTH_ERROR);
    let error = f32x16::splat(simd, CORNER_ERROR);
    let half_size = [
        outward + (center[0].abs() + outward) * error,
        outward + (center[1].abs() + outward) * error,
        outward + (center[2].abs() + outward) * error,
    ];
    BoxLanes { center, half_size }
}

/// Moves the sides of boxes outward.
#[inline(always)]
fn move_apart<S: Simd>(min: Axes<S>, max: Axes<S>, outward: f32x16<S>) -> (Axes<S>, Axes<S>) {
    let min = [min[0] - outward, min[1] - outward, min[2] - outward];
    let max = [max[0] + outward, max[1] + outward, max[2] + outward];
    (min, max)
}

#[inline(always)]
fn lowest<S: Simd>(a: f32x16<S>, b: f32x16<S>, c: f32x16<S>) -> f32x16<S> {
    a.min(b).min(c)
}

#[inline(always)]
fn highest<S: Simd>(a: f32x16<S>, b: f32x16<S>, c: f32x16<S>) -> f32x16<S> {
    a.max(b).max(c)
}
