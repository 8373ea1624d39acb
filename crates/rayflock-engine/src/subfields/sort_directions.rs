//! Sorts rays by the direction of a set that is nearest to theirs.

use std::ops::Range;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering::Relaxed;

use glam::Vec3;
use rayflock_geom::RayState;
use rayon::prelude::*;
use tracing::debug_span;

use super::asked::{Asked, RayList};
use super::config::Config;
use super::direction_set::{DirectionLayout, DirectionSet};
use crate::TraceStats;
use crate::sort_keyed::KeyedSorter;

/// Rays that one task gives keys.
const RAYS_PER_TASK: usize = 4096;

/// There are at most so many directions unless more are asked for.
const MOST_DIRECTIONS: usize = 640;

/// See [`Work::direction_count`].
const SHARE: f32 = 0.2;

/// For how many frames what rests should last to be worth its writing.
const LASTING: usize = 32;

/// Whatever is asked for, there are no more: the time to make a set grows with their square.
const MOST_DIRECTIONS_EVER: usize = 4096;

/// Rays by direction; memory is kept.
#[derive(Debug, Default)]
pub(super) struct DirectionSorter {
    chosen: Option<ChosenSet>,
    /// The largest number of directions that a batch of this frame wanted.
    most_wanted: usize,
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

/// What the number of directions follows from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Work {
    pub(super) ray_count: usize,
    /// Primitives in the grids.
    pub(super) prim_count: usize,
    /// Those that are written anew each frame.
    pub(super) moving_count: usize,
}

impl Work {
    /// How many directions cost least.
    ///
    /// A direction costs some work for each primitive that moves, a ray for each tile: with `D`
    /// directions and `N` tiles a side, which is about the square root of the primitives, that are
    /// `1 + N sqrt(2 / D)`. The sum is least where `D` grows with
    /// `(rays * sqrt(primitives) / moving)^(2/3)`. With 60 ns a tile, 140 ns a primitive and ten
    /// primitives in a tile it is [`SHARE`] of that; it is rounded to a power of four, so that sets
    /// last.
    fn direction_count(&self) -> usize {
        let moving = self.moving_count.max(self.prim_count / LASTING).max(1);
        let wanted = self.ray_count as f32 * (self.prim_count as f32).sqrt() / moving as f32;
        let power = (SHARE * wanted.powf(2.0 / 3.0) / 10.0).max(1.0).log(4.0).round();
        (10.0 * 4.0_f32.powf(power)).min(MOST_DIRECTIONS as f32) as usize
    }
}

/// The rays of one direction.
#[derive(Clone, Debug)]
pub(super) struct Run {
    pub(super) direction: Vec3,
    /// Places in the order of directions.
    pub(super) entries: Range<usize>,
}

impl DirectionSorter {
    /// Begins a frame: it may need fewer directions than the one before.
    pub(super) fn begin_frame(&mut self) {
        let has_too_many = |chosen: &mut ChosenSet| 2 * self.most_wanted < chosen.count;
        if self.most_wanted > 0 && self.chosen.as_mut().is_some_and(has_too_many) {
            self.chosen = None;
        }
        self.most_wanted = 0;
    }

    /// Chooses the set of directions for a batch: as many as were asked for, else what its work is
    /// worth, but no more than `most`. Batches of a frame share one, the set for the largest of them
    /// so far: each direction costs as much for few rays as for many.
    pub(super) fn choose(&mut self, config: &Config, work: &Work, most: usize) {
        let wanted = config.direction_count.unwrap_or_else(|| work.direction_count().min(most));
        self.most_wanted = self.most_wanted.max(wanted.min(MOST_DIRECTIONS_EVER));
        let count = self.most_wanted;
        let serves = |chosen: &&ChosenSet| {
            let is_enough = match config.direction_count {
                Some(_) => chosen.count == count,
                None => (count..=most).contains(&chosen.count),
            };
            chosen.layout == config.layout && is_enough
        };
        if self.chosen.as_ref().filter(serves).is_none() {
            let set = DirectionSet::new(config.layout, count);
            self.chosen = Some(ChosenSet { layout: config.layout, count, set });
        }
    }

    /// Sorts the active rays of a list; the others hit nothing.
    pub(super) fn sort(&mut self, asked: &Asked<'_>, rays: RayList<'_>) -> TraceStats {
        let _span = debug_span!("sort_directions").entered();
        self.runs.clear();
        let Some(ChosenSet { set, .. }) = &self.chosen else { return TraceStats::default() };
        let nowhere = set.directions().len();
        let tasks = self.sorter.entries(rays.len()).par_chunks_mut(RAYS_PER_TASK).enumerate();
        let invalid_rays = tasks.map(|(task_idx, keyed)| {
            let mut invalid_count = 0;
            for (idx, keyed) in keyed.iter_mut().enumerate() {
                let ray_idx = rays.get(task_idx * RAYS_PER_TASK + idx);
                let ray = asked.batch.ray(ray_idx);
                let key = match ray.state() {
                    RayState::Active => set.nearest(asked.ray_in_grids(&ray).direction),
                    RayState::Inactive | RayState::Invalid => {
                        asked.answers.set_none(ray_idx);
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
        TraceStats { rays: rays.len() as u64, invalid_rays, ..TraceStats::default() }
    }

    /// The set that was chosen.
    pub(super) fn set(&self) -> Option<&DirectionSet> {
        self.chosen.as_ref().map(|chosen| &chosen.set)
    }

    /// The directions of the set.
    pub(super) fn directions(&self) -> &[Vec3] {
        self.set().map_or(&[], DirectionSet::directions)
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
