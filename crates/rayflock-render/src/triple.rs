//! Three columns of sixteen lanes: points, directions or colours at work. What needs no more than
//! the kernels of geometry have is theirs.

use bytemuck::NoUninit;
use rayflock_geom::simd::{
    LANES, Select, Simd, SimdBase, SimdFloat, f32x16, mask32x16, point_columns,
};

pub(crate) use rayflock_geom::simd::axes::{
    Axes as Triple, dot, load_axes as load, splat_axes as splat, store_axes as store, subtract,
};

/// The three columns that begin `offset` bytes into each of sixteen rows.
///
/// # Panics
/// When no fourth scalar follows them in the row.
#[inline(always)]
pub(crate) fn columns_at<S: Simd, R: NoUninit>(
    simd: S,
    rows: &[R; LANES],
    offset: usize,
) -> Triple<S> {
    let scalars: &[f32] = bytemuck::cast_slice(rows);
    let size = size_of::<f32>();
    let columns = point_columns(simd, &scalars[offset / size..], size_of::<R>() / size);
    columns.expect("sixteen rows, and a scalar after the columns of the last")
}

#[inline(always)]
pub(crate) fn add<S: Simd>(a: &Triple<S>, b: &Triple<S>) -> Triple<S> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(crate) fn scale<S: Simd>(a: &Triple<S>, factor: f32x16<S>) -> Triple<S> {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

/// Unit vectors, zero where there is no length to divide by; to the bit what
/// [`Vec3::normalize_or_zero`] makes of each lane.
#[inline(always)]
pub(crate) fn normalized_or_zero<S: Simd>(simd: S, a: &Triple<S>) -> Triple<S> {
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    let factor = one / dot(*a, *a).sqrt();
    let has_length = factor.simd_gt(zero) & factor.simd_lt(f32x16::splat(simd, f32::INFINITY));
    let unit = scale(a, factor);
    [
        has_length.select(unit[0], zero),
        has_length.select(unit[1], zero),
        has_length.select(unit[2], zero),
    ]
}

/// Where not all three are zero.
#[inline(always)]
pub(crate) fn is_something<S: Simd>(simd: S, a: &Triple<S>) -> mask32x16<S> {
    let zero = f32x16::splat(simd, 0.0);
    !(a[0].simd_eq(zero) & a[1].simd_eq(zero) & a[2].simd_eq(zero))
}

/// Makes `values` the `others` where `mask` is set.
#[inline(always)]
pub(crate) fn select<S: Simd>(mask: mask32x16<S>, values: &mut Triple<S>, others: &Triple<S>) {
    for (value, other) in values.iter_mut().zip(others) {
        *value = mask.select(*other, *value);
    }
}

/// The sum of three triples, each times its share, in this order.
#[inline(always)]
pub(crate) fn weighted<S: Simd>(values: &[Triple<S>; 3], shares: &[f32x16<S>; 3]) -> Triple<S> {
    let first = add(&scale(&values[0], shares[0]), &scale(&values[1], shares[1]));
    add(&first, &scale(&values[2], shares[2]))
}
