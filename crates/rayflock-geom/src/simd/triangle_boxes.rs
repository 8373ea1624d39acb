//! The box around sixteen triangles, or sixteen bounding spheres, for trees of boxes.
//!
//! **Invariants.** The accepting test gets the depth of a triangle to
//! [`DEPTH_ERROR`] of a radius around it, and half the diagonal of its box is such a radius: by
//! half the sum of its edges, which is more, boxes are enlarged. What is left, the sideways
//! [`PERTURBATION`](super::ray_triangle::PERTURBATION) and rounding, is relative to the distance
//! from the ray and added there ([`ray_boxes`](super::ray_boxes)).

use super::axes::{load_axes, subtract};
use super::cone_sphere::SphereBlock;
use super::ray_boxes::BoxBounds;
use super::ray_triangle::{DEPTH_ERROR, TriangleBlock};
use super::{Simd, SimdBase, f32x16};

/// The box around sixteen triangles, enlarged.
#[inline(always)]
pub fn around_triangles<S: Simd>(simd: S, triangles: &TriangleBlock) -> BoxBounds {
    let [a, b, c] = &triangles.corners;
    let (a, b, c) = (load_axes(simd, a), load_axes(simd, b), load_axes(simd, c));
    let min = [lowest(a[0], b[0], c[0]), lowest(a[1], b[1], c[1]), lowest(a[2], b[2], c[2])];
    let max = [highest(a[0], b[0], c[0]), highest(a[1], b[1], c[1]), highest(a[2], b[2], c[2])];
    let edges = subtract(max, min);
    let radius = (edges[0] + edges[1] + edges[2]) * f32x16::splat(simd, 0.5);
    let outward = radius * f32x16::splat(simd, DEPTH_ERROR);
    around(min, max, outward)
}

/// The box around sixteen bounding spheres, enlarged.
#[inline(always)]
pub fn around_spheres<S: Simd>(simd: S, spheres: &SphereBlock) -> BoxBounds {
    let spheres = spheres.load(simd);
    let outward = spheres.radius * f32x16::splat(simd, 1.0 + 2.0 * DEPTH_ERROR);
    around(spheres.center, spheres.center, outward)
}

/// The box around boxes with their sides moved outward.
#[inline(always)]
fn around<S: Simd>(min: [f32x16<S>; 3], max: [f32x16<S>; 3], outward: f32x16<S>) -> BoxBounds {
    let min = [min[0] - outward, min[1] - outward, min[2] - outward];
    let max = [max[0] + outward, max[1] + outward, max[2] + outward];
    BoxBounds::around_lanes(min, max)
}

#[inline(always)]
fn lowest<S: Simd>(a: f32x16<S>, b: f32x16<S>, c: f32x16<S>) -> f32x16<S> {
    a.min(b).min(c)
}

#[inline(always)]
fn highest<S: Simd>(a: f32x16<S>, b: f32x16<S>, c: f32x16<S>) -> f32x16<S> {
    a.max(b).max(c)
}
