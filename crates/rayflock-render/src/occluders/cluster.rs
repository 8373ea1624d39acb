//! Divides points with weights into clusters.
//!
//! **Carefully**: the cluster with the largest sum of squared distances is cut at its mean across
//! its longest side, again and again; then Lloyd's iterations let every point go to the nearest
//! mean. **Quickly**, for meshes that are new each frame: points in the order of a Hilbert curve,
//! cut into runs of equal weight.
//!
//! **Source.** S. Lloyd, "Least squares quantization in PCM", IEEE Trans. Inf. Theory 28 (1982), as
//! R. Wang et al. (2006) use it for sphere sets; the curve as in `geom::simd::space_curve`.
//!
//! **Cost.** Carefully: n log k for n points and k clusters, and n k for each of Lloyd's
//! iterations, which are left out where that is much. Quickly: a sort.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::ops::Range;

use glam::{DVec3, Vec3};
use rayflock_geom::Aabb;
use rayflock_geom::simd::space_curve::{MOST_BITS, hilbert_codes};
use rayflock_geom::simd::{LANES, SimdBase, SimdLevel, dispatch, f32x16};
use rayon::prelude::*;

/// Lloyd's iterations: after the third, sums of squares fall by less than a percent.
const ITERATIONS: usize = 3;

/// Distances that one of Lloyd's iterations may take: a hundredth of a second.
const MOST_DISTANCES: usize = 1 << 24;

/// A point to be clustered.
#[derive(Clone, Copy, Debug)]
pub(super) struct WeightedPoint {
    pub(super) position: Vec3,
    pub(super) weight: f32,
    /// What the point stands for; different for each.
    pub(super) idx: u32,
    /// Working memory: what is sorted by.
    pub(super) code: u32,
}

/// Brings `points` into the order of at most `count` clusters; each range is one, none is empty.
pub(super) fn cluster_carefully(points: &mut [WeightedPoint], count: usize) -> Vec<Range<usize>> {
    let mut ranges = split(points, count);
    if points.len().saturating_mul(count) > MOST_DISTANCES {
        return ranges;
    }
    for _ in 0..ITERATIONS {
        let means: Vec<Vec3> = ranges.iter().map(|range| mean(&points[range.clone()])).collect();
        ranges = go_to_nearest(points, &means);
    }
    ranges
}

/// The same along a curve, appended to `ranges`.
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
    points.sort_unstable_by_key(|point| (point.code, point.idx));
}

/// The places of `positions` in an order in which neighbours are close.
pub(crate) fn nearby_order(positions: &[Vec3]) -> Vec<usize> {
    let point = |(idx, &position)| WeightedPoint { position, weight: 1.0, idx, code: 0 };
    let mut points: Vec<_> = (0..).zip(positions).map(point).collect();
    sort_along_curve(&mut points);
    points.into_iter().map(|point| point.idx as usize).collect()
}

/// A cluster that may be cut, the worst first.
#[derive(Debug)]
struct Part {
    /// Sum of weighted squared distances to the mean.
    error: f32,
    range: Range<usize>,
}

impl PartialEq for Part {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Part {}

impl PartialOrd for Part {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Part {
    /// By error; among equals the first, so that the outcome is always the same.
    fn cmp(&self, other: &Self) -> Ordering {
        let error = self.error.total_cmp(&other.error);
        error.then(other.range.start.cmp(&self.range.start))
    }
}

impl Part {
    fn new(points: &[WeightedPoint], range: Range<usize>) -> Self {
        let members = &points[range.clone()];
        let mean = mean(members);
        let error = |point: &WeightedPoint| point.weight * point.position.distance_squared(mean);
        Self { error: members.iter().map(error).sum(), range }
    }
}

/// Cuts the worst cluster until there are `count`.
fn split(points: &mut [WeightedPoint], count: usize) -> Vec<Range<usize>> {
    if points.is_empty() {
        return Vec::new();
    }
    let mut parts = BinaryHeap::from([Part::new(points, 0..points.len())]);
    while parts.len() < count.min(points.len()) {
        let Some(worst) = parts.pop() else { break };
        let Some(middle) = cut(&mut points[worst.range.clone()]) else {
            // Points in one place: no cut helps, here or in what is better.
            parts.push(worst);
            break;
        };
        let Range { start, end } = worst.range;
        parts.push(Part::new(points, start..start + middle));
        parts.push(Part::new(points, start + middle..end));
    }
    parts.into_iter().map(|part| part.range).collect()
}

/// Brings the points on the near side of the mean, along the longest side of their box, to the
/// front, and returns how many; `None` where all are in one place.
fn cut(points: &mut [WeightedPoint]) -> Option<usize> {
    let bounds = Aabb::around(points.iter().map(|point| point.position));
    let axis = bounds.size().max_position();
    let middle = mean(points)[axis];
    points.sort_unstable_by(|a, b| {
        a.position[axis].total_cmp(&b.position[axis]).then(a.idx.cmp(&b.idx))
    });
    let near = points.partition_point(|point| point.position[axis] <= middle);
    (near > 0 && near < points.len()).then_some(near)
}

/// The mean of the positions, by weight; their plain mean where all weights are 0.
fn mean(points: &[WeightedPoint]) -> Vec3 {
    let (mut sum, mut total) = (DVec3::ZERO, 0.0);
    for point in points {
        sum += f64::from(point.weight) * point.position.as_dvec3();
        total += f64::from(point.weight);
    }
    if total > 0.0 {
        return (sum / total).as_vec3();
    }
    let plain: DVec3 = points.iter().map(|point| point.position.as_dvec3()).sum();
    (plain / points.len().max(1) as f64).as_vec3()
}

/// Sorts points by the nearest mean; the ranges of means that have any.
fn go_to_nearest(points: &mut [WeightedPoint], means: &[Vec3]) -> Vec<Range<usize>> {
    points.par_iter_mut().with_min_len(64).for_each(|point| {
        let squared = |mean: &Vec3| mean.distance_squared(point.position);
        let mut nearest = (f32::INFINITY, 0);
        for (idx, mean) in (0_u32..).zip(means) {
            let squared = squared(mean);
            if squared < nearest.0 {
                nearest = (squared, idx);
            }
        }
        point.code = nearest.1;
    });
    points.sort_unstable_by_key(|point| (point.code, point.idx));
    let mut start = 0;
    let ranges = points.chunk_by(|a, b| a.code == b.code).map(|members| {
        start += members.len();
        start - members.len()..start
    });
    ranges.collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn points(positions: &[Vec3]) -> Vec<WeightedPoint> {
        let point = |(idx, &position)| WeightedPoint { position, weight: 1.0, idx, code: 0 };
        (0..).zip(positions).map(point).collect()
    }

    fn error(points: &[WeightedPoint], ranges: &[Range<usize>]) -> f32 {
        ranges.iter().map(|range| Part::new(points, range.clone()).error).sum()
    }

    proptest! {
        #[test]
        fn every_point_is_in_one_cluster(
            positions in prop::collection::vec(prop::array::uniform3(-4.0..4.0_f32), 1..200),
            count in 1..40_usize,
        ) {
            let positions: Vec<_> = positions.into_iter().map(Vec3::from).collect();
            for carefully in [true, false] {
                let mut points = points(&positions);
                let mut ranges = Vec::new();
                if carefully {
                    ranges = cluster_carefully(&mut points, count);
                } else {
                    cluster_quickly(&mut points, count, &mut ranges);
                }
                prop_assert!(ranges.len() <= count && ranges.iter().all(|range| !range.is_empty()));
                ranges.sort_by_key(|range| range.start);
                let ends = ranges.iter().map(|range| range.end);
                let starts = ranges.iter().map(|range| range.start);
                prop_assert!(starts.skip(1).chain([points.len()]).eq(ends));
                let mut idxs: Vec<_> = points.iter().map(|point| point.idx as usize).collect();
                idxs.sort_unstable();
                prop_assert!(idxs.into_iter().eq(0..positions.len()));
            }
        }
    }

    #[test]
    fn care_is_worth_it() {
        let lattice: Vec<_> =
            (0..4096_u16).map(|i| Vec3::new(f32::from(i % 64), f32::from(i / 64), 0.0)).collect();
        let mut careful = points(&lattice);
        let mut quick = careful.clone();
        let careful_ranges = cluster_carefully(&mut careful, 48);
        let mut quick_ranges = Vec::new();
        cluster_quickly(&mut quick, 48, &mut quick_ranges);
        assert_eq!((careful_ranges.len(), quick_ranges.len()), (48, 48));
        let (careful, quick) = (error(&careful, &careful_ranges), error(&quick, &quick_ranges));
        assert!(careful < quick, "{careful} is not below {quick}");
    }

    #[test]
    fn points_in_one_place_are_one_cluster() {
        let mut points = points(&[Vec3::ONE; 5]);
        let ranges = cluster_carefully(&mut points, 3);
        assert_eq!((ranges.len(), &ranges[0]), (1, &(0..5)));
        assert!(cluster_carefully(&mut [], 3).is_empty());
    }
}
