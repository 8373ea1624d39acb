//! Sorts rays by the direction of a set that is nearest to theirs.

use std::ops::Range;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering::Relaxed;

use glam::Vec3;
use rayflock_geom::{RayBatch, RayState};
use rayon::prelude::*;
use tracing::debug_span;

use super::config::Config;
use super::direction_set::{DirectionLayout, DirectionSet};
use crate::TraceStats;
use crate::answers::Answers;
use crate::sort_keyed::KeyedSorter;

/// Rays that one task gives keys.
const RAYS_PER_TASK: usize = 4096;

/// There are at most so many directions unless more are asked for.
const MOST_DIRECTIONS: usize = 640;

/// Whatever is asked for, there are no more: the time to make a set grows with their square.
const MOST_DIRECTIONS_EVER: usize = 4096;

/// Rays by direction; memory is kept.
#[derive(Debug, Default)]
pub(super) struct DirectionSorter {
    chosen: Option<ChosenSet>,
    sorter: KeyedSorter,
    runs: Vec<Run>,
}

/// A set of directions and what it was made from.
#[derive(Debug)]
struct ChosenSet {
    layout: DirectionLayout,
    count: usize,
    set: DirectionSet,
}

/// The rays of one direction.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub(super) direction: Vec3,
    /// Places in the order of directions.
    pub(super) entries: Range<usize>,
}

impl DirectionSorter {
    /// Chooses the set of directions for a batch.
    ///
    /// A direction costs some work for each primitive, a ray for each tile: with `D` directions and
    /// `N` tiles a side that are `1 + N sqrt(2 / D)`. The sum is least where `D` is about
    /// `(rays / sqrt(primitives))^(2/3)`; it is rounded to a power of four, so that sets last.
    pub(super) fn choose(&mut self, config: &Config, ray_count: usize, prim_count: usize) {
        let count = config.direction_count.unwrap_or_else(|| {
            let wanted = (ray_count as f32 / (prim_count.max(1) as f32).sqrt()).powf(2.0 / 3.0);
            let power = (wanted / 10.0).max(1.0).log(4.0).round();
            (10.0 * 4.0_f32.powf(power)).min(MOST_DIRECTIONS as f32) as usize
        });
        let (layout, count) = (config.layout, count.min(MOST_DIRECTIONS_EVER));
        let is_same = |one: &&ChosenSet| (one.layout, one.count) == (layout, count);
        if self.chosen.as_ref().filter(is_same).is_none() {
            self.chosen = Some(ChosenSet { layout, count, set: DirectionSet::new(layout, count) });
        }
    }

    /// Sorts the active rays of a batch; the others hit nothing.
    pub(super) fn sort(&mut self, batch: &RayBatch<'_>, answers: &Answers) -> TraceStats {
        let _span = debug_span!("sort_directions").entered();
        self.runs.clear();
        let Some(ChosenSet { set, .. }) = &self.chosen else { return TraceStats::default() };
        let nowhere = set.directions().len();
        let tasks = self.sorter.entries(batch.len()).par_chunks_mut(RAYS_PER_TASK).enumerate();
        let invalid_rays = tasks.map(|(task_idx, keyed)| {
            let mut invalid_count = 0;
            for (idx, keyed) in keyed.iter_mut().enumerate() {
                let ray_idx = task_idx * RAYS_PER_TASK + idx;
                let ray = batch.ray(ray_idx);
                let key = match ray.state() {
                    RayState::Active => set.nearest(ray.direction),
                    RayState::Inactive | RayState::Invalid => {
                        answers.set_none(ray_idx);
                        invalid_count += u64::from(ray.state() == RayState::Invalid);
                        nowhere
                    }
                };
                *keyed.get_mut() = ((key as u64) << 32) | ray_idx as u64;
            }
            invalid_count
        });
        let invalid_rays = invalid_rays.sum();
        self.sorter.sort(usize::BITS - nowhere.leading_zeros());

        // Find where each direction begins.
        let sorted = self.sorter.sorted();
        let key = |entry: &AtomicU64| (entry.load(Relaxed) >> 32) as usize;
        let mut start = 0;
        while let Some(key_here) = sorted.get(start).map(key).filter(|&key| key < nowhere) {
            let len = sorted[start..].partition_point(|entry| key(entry) == key_here);
            let direction = set.directions()[key_here];
            self.runs.push(Run { direction, entries: start..start + len });
            start += len;
        }
        TraceStats { rays: batch.len() as u64, invalid_rays, ..TraceStats::default() }
    }

    /// The directions that occur, each with its rays.
    pub(super) fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// Positions in the batch.
    pub(super) fn ray_idx(
        &self,
        entries: Range<usize>,
    ) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.sorter.sorted()[entries].iter().map(|entry| entry.load(Relaxed) as u32 as usize)
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.sorter.memory_usage() + self.runs.capacity() * size_of::<Run>()
    }
}
