//! Divides points of a surface into clusters that are close by and face along one line.
//!
//! **Carefully**: the cluster with the largest sum of squared distances is cut at its mean across
//! its longest side, or between what faces along its main line and what does not, again and again;
//! then Lloyd's iterations let every point go to the nearest mean. **Quickly**, for meshes that are
//! new each frame: see `along_curve`.
//!
//! **Source.** S. Lloyd, "Least squares quantization in PCM", IEEE Trans. Inf. Theory 28 (1982), as
//! R. Wang et al. (2006) use it for sphere sets. D. Cohen-Steiner et al., "Variational Shape
//! Approximation", SIGGRAPH 2004, for clusters whose normals agree.
//!
//! **Cost.** n log k for n points and k clusters, and n k for each of Lloyd's iterations, which are
//! left out where that is much.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::ops::Range;

use glam::Vec3;
use rayflock_geom::Aabb;
use rayon::prelude::*;

use super::surface_mean::{SurfaceMean, main_line};

/// To face across counts as to be away by this share of the side of a cluster's mean surface. Among
/// 0, 0.15, 0.25, 0.35, 0.5 and 1, it is the best for three built-in scenes together.
const TURN: f32 = 0.25;

/// Lloyd's iterations: after the third, sums of squares fall by less than a percent.
const ITERATIONS: usize = 3;

/// Distances that one of Lloyd's iterations may take: a hundredth of a second.
const MOST_DISTANCES: usize = 1 << 24;

/// A point to be clustered.
#[derive(Clone, Copy, Debug)]
pub(super) struct WeightedPoint {
    pub(super) position: Vec3,
    /// Of unit length, or zero where no way is faced.
    pub(super) normal: Vec3,
    /// The surface that it stands for.
    pub(super) weight: f32,
    /// What the point stands for; different for each.
    pub(super) idx: u32,
    /// Working memory: what is sorted by.
    pub(super) code: u32,
}

impl WeightedPoint {
    /// A point of no surface.
    pub(super) const fn at(position: Vec3, idx: u32) -> Self {
        Self { position, normal: Vec3::ZERO, weight: 1.0, idx, code: 0 }
    }
}

/// Brings `points` into the order of at most `count` clusters; each range is one, none is empty.
pub(super) fn cluster_carefully(points: &mut [WeightedPoint], count: usize) -> Vec<Range<usize>> {
    let surface: f32 = points.iter().map(|point| point.weight).sum();
    let turn = TURN * TURN * surface / count.max(1) as f32;
    let mut ranges = split(points, count, turn);
    if points.len().saturating_mul(count) > MOST_DISTANCES {
        return ranges;
    }
    for _ in 0..ITERATIONS {
        let mean = |range: &Range<usize>| SurfaceMean::of(&points[range.clone()]);
        let means: Vec<SurfaceMean> = ranges.iter().map(mean).collect();
        ranges = go_to_nearest(points, &means, turn);
    }
    ranges
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
    fn new(points: &[WeightedPoint], range: Range<usize>, turn: f32) -> Self {
        let members = &points[range.clone()];
        let mean = SurfaceMean::of(members);
        let error = |point: &WeightedPoint| point.weight * mean.distance_squared(point, turn);
        Self { error: members.iter().map(error).sum(), range }
    }
}

/// Cuts the worst cluster until there are `count`.
fn split(points: &mut [WeightedPoint], count: usize, turn: f32) -> Vec<Range<usize>> {
    if points.is_empty() {
        return Vec::new();
    }
    let mut parts = BinaryHeap::from([Part::new(points, 0..points.len(), turn)]);
    while parts.len() < count.min(points.len()) {
        let Some(worst) = parts.pop() else { break };
        let Some(middle) = cut(&mut points[worst.range.clone()], turn) else {
            // Points in one place: no cut helps, here or in what is better.
            parts.push(worst);
            break;
        };
        let Range { start, end } = worst.range;
        parts.push(Part::new(points, start..start + middle, turn));
        parts.push(Part::new(points, start + middle..end, turn));
    }
    parts.into_iter().map(|part| part.range).collect()
}

/// Brings the points below the mean to the front, and returns how many; `None` where all are
/// alike. The mean is along the longest side of their box, or of how much they face along their
/// main line, whichever they differ more in.
fn cut(points: &mut [WeightedPoint], turn: f32) -> Option<usize> {
    let axis = Aabb::around(points.iter().map(|point| point.position)).size().max_position();
    let mean = SurfaceMean::of(points);
    let (line, _) = main_line(&mean.facing);
    let along_side = |point: &WeightedPoint| point.position[axis];
    let along_line = |point: &WeightedPoint| 2.0_f32.sqrt() * point.normal.dot(line).powi(2);
    let by_side = mean_and_spread(points, along_side);
    let by_line = mean_and_spread(points, along_line);
    match turn * by_line.1 > by_side.1 {
        true => part(points, along_line, by_line.0),
        false => part(points, along_side, by_side.0),
    }
}

/// The mean of a value, by weight, and the mean of squared differences from it.
fn mean_and_spread(points: &[WeightedPoint], value: impl Fn(&WeightedPoint) -> f32) -> (f32, f32) {
    let has_weight = points.iter().any(|point| point.weight > 0.0);
    let weight = |point: &WeightedPoint| if has_weight { f64::from(point.weight) } else { 1.0 };
    let total: f64 = points.iter().map(weight).sum();
    let mean =
        points.iter().map(|point| weight(point) * f64::from(value(point))).sum::<f64>() / total;
    let squared = |point: &WeightedPoint| (f64::from(value(point)) - mean).powi(2);
    let spread = points.iter().map(|point| weight(point) * squared(point)).sum::<f64>() / total;
    (mean as f32, spread as f32)
}

/// Brings the points with a value of at most `middle` to the front; how many, if neither all nor
/// none.
fn part(
    points: &mut [WeightedPoint],
    value: impl Fn(&WeightedPoint) -> f32,
    middle: f32,
) -> Option<usize> {
    points.sort_unstable_by(|a, b| value(a).total_cmp(&value(b)).then(a.idx.cmp(&b.idx)));
    let near = points.partition_point(|point| value(point) <= middle);
    (near > 0 && near < points.len()).then_some(near)
}

/// Sorts points by the nearest mean; the ranges of means that have any.
fn go_to_nearest(
    points: &mut [WeightedPoint],
    means: &[SurfaceMean],
    turn: f32,
) -> Vec<Range<usize>> {
    points.par_iter_mut().with_min_len(64).for_each(|point| {
        let mut nearest = (f32::INFINITY, 0);
        for (idx, mean) in (0_u32..).zip(means) {
            let squared = mean.distance_squared(point, turn);
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

    use super::super::along_curve::cluster_quickly;
    use super::*;

    fn points(positions: &[Vec3]) -> Vec<WeightedPoint> {
        let point = |(idx, &position)| WeightedPoint::at(position, idx);
        (0..).zip(positions).map(point).collect()
    }

    fn error(points: &[WeightedPoint], ranges: &[Range<usize>]) -> f32 {
        ranges.iter().map(|range| Part::new(points, range.clone(), 0.0).error).sum()
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
