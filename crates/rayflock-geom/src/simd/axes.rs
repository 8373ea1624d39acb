//! Vectors in space, one column of lanes an axis, for kernels.
//!
//! These are functions, not closures inside the kernels: a closure can't be forced inline, and
//! code compiled for AVX2 can't inline one that is not (measured on an x86-64 server core at AVX2:
//! 127 instead of 700 million ray-triangle tests a second).

use glam::Vec3;

use super::{Lanes, Simd, SimdBase, f32x16};

/// x, y and z of sixteen points or directions.
pub type Axes<S> = [f32x16<S>; 3];

/// Three columns as vectors.
#[inline(always)]
pub fn load_axes<S: Simd>(simd: S, columns: &[Lanes; 3]) -> Axes<S> {
    let load = f32x16::from_slice;
    [load(simd, &columns[0]), load(simd, &columns[1]), load(simd, &columns[2])]
}

/// Three columns as vectors, in another order.
#[inline(always)]
pub fn load_ordered_axes<S: Simd>(
    simd: S,
    columns: &[Lanes; 3],
    [first, second, third]: [usize; 3],
) -> Axes<S> {
    let load = f32x16::from_slice;
    [load(simd, &columns[first]), load(simd, &columns[second]), load(simd, &columns[third])]
}

/// Writes three vectors as columns.
#[inline(always)]
pub fn store_axes<S: Simd>(axes: &Axes<S>, columns: &mut [Lanes; 3]) {
    for (axis, column) in axes.iter().zip(columns) {
        axis.store_slice(column);
    }
}

/// One point in every lane.
#[inline(always)]
pub fn splat_axes<S: Simd>(simd: S, point: Vec3) -> Axes<S> {
    let splat = f32x16::splat;
    [splat(simd, point.x), splat(simd, point.y), splat(simd, point.z)]
}

/// Lane by lane.
#[inline(always)]
pub fn subtract<S: Simd>(a: Axes<S>, b: Axes<S>) -> Axes<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The scalar product, summed in the order of the axes.
#[inline(always)]
pub fn dot<S: Simd>(a: Axes<S>, b: Axes<S>) -> f32x16<S> {
    (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
}

/// Coordinates without their signs.
#[inline(always)]
pub(super) fn absolute<S: Simd>([x, y, z]: Axes<S>) -> Axes<S> {
    [x.abs(), y.abs(), z.abs()]
}

/// The largest of the coordinates.
#[inline(always)]
pub(super) fn largest<S: Simd>([x, y, z]: Axes<S>) -> f32x16<S> {
    x.max(y).max(z)
}
