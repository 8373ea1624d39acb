//! Points in the order of a Hilbert curve, in which neighbours are close.
//!
//! **Source.** The curve as in `geom::simd::space_curve`.
//!
//! **Cost.** A sort.

use std::ops::Range;

use glam::Vec3;
use rayflock_geom::Aabb;
use rayflock_geom::simd::space_curve::{MOST_BITS, hilbert_codes};
use rayflock_geom::simd::{LANES, SimdBase, SimdLevel, dispatch, f32x16};

use super::cluster::WeightedPoint;

/// Appends to `ranges` at most `count` clusters of `points`, which it sorts: runs of equal weight
/// along the curve.
pub(super) fn cluster_quickly(
    points: &mut [WeightedPoint],
    count: usize,
    ranges: &mut Vec<Range<usize>>,
) {
    sort_along_curve(points);
    let total: f64 = points.iter().map(|point| f64::from(point.weight)).sum();
    let share = total / count.max(1) as f64;
    // Rounding must not make one more.
    let most = ranges.len() + count.max(1) - 1;
    let (mut start, mut sum, mut run) = (0, 0.0, 1.0);
    for (idx, point) in points.iter().enumerate() {
        sum += f64::from(point.weight);
        if sum >= run * share && idx + 1 < points.len() && ranges.len() < most {
            ranges.push(start..idx + 1);
            start = idx + 1;
            run = (sum / share).floor() + 1.0;
        }
    }
    if start < points.len() {
        ranges.push(start..points.len());
    }
}

/// Sorts points along a Hilbert curve.
pub(super) fn sort_along_curve(points: &mut [WeightedPoint]) {
    place_on_curve(points);
    points.sort_unstable_by_key(|point| (point.code, point.idx));
}

/// Makes the codes of points their places along a Hilbert curve, `3 * MOST_BITS` bits.
pub(super) fn place_on_curve(points: &mut [WeightedPoint]) {
    let bounds = Aabb::around(points.iter().map(|point| point.position));
    let scale = (1 << MOST_BITS) as f32 / bounds.size().max_element();
    let scale = if scale.is_finite() { scale } else { 0.0 };
    for points in points.chunks_mut(LANES) {
        let mut cells = [[0.0; LANES]; 3];
        for (lane, point) in points.iter().enumerate() {
            let cell = (point.position - bounds.min) * scale;
            (cells[0][lane], cells[1][lane], cells[2][lane]) = (cell.x, cell.y, cell.z);
        }
        let codes: [u32; LANES] = dispatch!(SimdLevel::best().level(), simd => {
            let load = f32x16::from_slice;
            let cells = [load(simd, &cells[0]), load(simd, &cells[1]), load(simd, &cells[2])];
            *hilbert_codes(simd, cells, MOST_BITS)
        });
        points.iter_mut().zip(codes).for_each(|(point, code)| point.code = code);
    }
}

/// The places of `positions` in an order in which neighbours are close.
pub(crate) fn nearby_order(positions: &[Vec3]) -> Vec<usize> {
    let point = |(idx, &position)| WeightedPoint::at(position, idx);
    let mut points: Vec<_> = (0..).zip(positions).map(point).collect();
    sort_along_curve(&mut points);
    points.into_iter().map(|point| point.idx as usize).collect()
}
