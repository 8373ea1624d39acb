//! Boxes around sixteen triangles, and around sixteen bounding spheres, for trees of boxes.
//!
//! **Invariants.** The accepting test gets the depth of a triangle to
//! [`DEPTH_ERROR`] of a radius around it, and half the diagonal of its box is such a radius: by
//! half the sum of its edges, which is more, boxes are enlarged. What is left, the sideways
//! [`PERTURBATION`](super::ray_triangle::PERTURBATION) and rounding, is relative to the distance
//! from the ray and added there ([`ray_boxes`](super::ray_boxes)).

use glam::Vec3;

use super::axes::{load_axes, splat_axes, subtract};
use super::cone_sphere::SphereBlock;
use super::ray_boxes::BoxLanes;
use super::ray_triangle::{DEPTH_ERROR, TriangleBlock};
use super::{Simd, SimdBase, f32x16};

/// Boxes around sixteen triangles, enlarged, relative to `middle`; finite where the corners are.
#[inline(always)]
pub fn triangle_boxes<S: Simd>(simd: S, triangles: &TriangleBlock, middle: Vec3) -> BoxLanes<S> {
    let [a, b, c] = &triangles.corners;
    let (a, b, c) = (load_axes(simd, a), load_axes(simd, b), load_axes(simd, c));
    let min = [lowest(a[0], b[0], c[0]), lowest(a[1], b[1], c[1]), lowest(a[2], b[2], c[2])];
    let max = [highest(a[0], b[0], c[0]), highest(a[1], b[1], c[1]), highest(a[2], b[2], c[2])];
    let edges = subtract(max, min);
    let radius = (edges[0] + edges[1] + edges[2]) * f32x16::splat(simd, 0.5);
    enlarge(simd, BoxLanes { min, max }, middle, radius * f32x16::splat(simd, DEPTH_ERROR))
}

/// Boxes around sixteen bounding spheres, enlarged, relative to `middle`. A lane that nothing may
/// touch has an inverted box.
#[inline(always)]
pub fn sphere_boxes<S: Simd>(simd: S, spheres: &SphereBlock, middle: Vec3) -> BoxLanes<S> {
    let spheres = spheres.load(simd);
    let boxes = BoxLanes { min: spheres.center, max: spheres.center };
    let radius = spheres.radius * f32x16::splat(simd, 1.0 + 2.0 * DEPTH_ERROR);
    enlarge(simd, boxes, middle, radius)
}

/// Moves boxes to the middle and their sides outward; what overflows stays finite.
#[inline(always)]
fn enlarge<S: Simd>(simd: S, boxes: BoxLanes<S>, middle: Vec3, outward: f32x16<S>) -> BoxLanes<S> {
    let middle = splat_axes(simd, middle);
    let (min, max) = (subtract(boxes.min, middle), subtract(boxes.max, middle));
    let outward = finite(simd, outward);
    BoxLanes {
        min: [
            moved(simd, min[0], -outward),
            moved(simd, min[1], -outward),
            moved(simd, min[2], -outward),
        ],
        max: [
            moved(simd, max[0], outward),
            moved(simd, max[1], outward),
            moved(simd, max[2], outward),
        ],
    }
}

#[inline(always)]
fn moved<S: Simd>(simd: S, coordinate: f32x16<S>, by: f32x16<S>) -> f32x16<S> {
    finite(simd, finite(simd, coordinate) + by)
}

#[inline(always)]
fn finite<S: Simd>(simd: S, value: f32x16<S>) -> f32x16<S> {
    value.max(f32x16::splat(simd, f32::MIN)).min(f32x16::splat(simd, f32::MAX))
}

#[inline(always)]
fn lowest<S: Simd>(a: f32x16<S>, b: f32x16<S>, c: f32x16<S>) -> f32x16<S> {
    a.min(b).min(c)
}

#[inline(always)]
fn highest<S: Simd>(a: f32x16<S>, b: f32x16<S>, c: f32x16<S>) -> f32x16<S> {
    a.max(b).max(c)
}
