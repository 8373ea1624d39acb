//! The subfields over the primitives of one table, and the way of a batch through them.

use glam::Vec3;
use rayflock_geom::simd::dispatch;
use rayon::prelude::*;
use tracing::debug_span;
use web_time::Instant;

use super::asked::{Asked, RayList};
use super::config::Config;
use super::ray_group::RayGroup;
use super::sort_directions::{DirectionSorter, Run, Work};
use super::store::{Contents, SubfieldStore};
use super::subfield::Subfield;
use super::trace_aligned::trace_aligned;
use super::trace_walking::trace_walking;
use crate::TraceStats;
use crate::primitives::PrimitiveTable;
use crate::scratch::Scratch;

/// Rays that one task traces.
pub(super) const RAYS_PER_TASK: usize = 1024;

/// Subfields and all it takes to trace through them.
#[derive(Debug, Default)]
pub(super) struct Fields {
    pub(super) config: Config,
    pub(super) contents: Contents,
    pub(super) store: SubfieldStore,
    pub(super) sorter: DirectionSorter,
    pub(super) groups: Scratch<RayGroup>,
    /// The directions of a batch, and the positions of their subfields in the store.
    directions: Vec<Vec3>,
    pub(super) places: Vec<usize>,
    /// Nanoseconds spent on bringing subfields up to date since that was asked last.
    update_ns: u64,
}

impl Fields {
    /// No subfields yet.
    pub(super) fn new(config: Config) -> Self {
        Self { config, ..Self::default() }
    }

    /// Brings the subfields of some directions, all different, up to date; `places` are then their
    /// positions in the store.
    fn prepare(&mut self, held: &PrimitiveTable, directions: &[Vec3]) {
        let start = Instant::now();
        let Self { config, contents, store, places, .. } = self;
        store.prepare(config, held, contents, directions, places);
        self.update_ns += start.elapsed().as_nanos() as u64;
    }

    /// Brings the subfields of the whole set up to date.
    pub(super) fn prepare_set(&mut self, held: &PrimitiveTable) {
        let sorter = std::mem::take(&mut self.sorter);
        self.prepare(held, sorter.directions());
        self.sorter = sorter;
    }

    /// Brings all subfields that are held up to date.
    pub(super) fn refresh(&mut self, held: &PrimitiveTable) {
        self.store.refresh(&self.config, held, &self.contents);
    }

    /// Nanoseconds spent on bringing subfields up to date since this was asked last.
    pub(super) fn take_update_ns(&mut self) -> u64 {
        std::mem::take(&mut self.update_ns)
    }

    /// Chooses the set of directions for so many rays.
    pub(super) fn choose_set(&mut self, ray_count: usize) {
        let prim_count = self.contents.prim_count();
        let moving_count = self.contents.moving.prim_count();
        let most = self.most_at_once();
        self.sorter.choose(&self.config, &Work { ray_count, prim_count, moving_count }, most);
    }

    /// How many subfields the budget is good for, at least one.
    pub(super) fn most_at_once(&self) -> usize {
        (self.config.budget / self.store.bytes_each(&self.contents)).max(1)
    }

    /// Answers a batch whose rays share a direction.
    pub(super) fn trace_aligned(
        &mut self,
        held: &PrimitiveTable,
        asked: &Asked<'_>,
        direction: Vec3,
    ) -> TraceStats {
        self.prepare(held, &[direction]);
        let _span = debug_span!("trace_aligned").entered();
        let (subfield, ray_count) = (self.store.get(self.places[0]), asked.batch.len());
        let tasks = (0..ray_count.div_ceil(RAYS_PER_TASK)).into_par_iter();
        let counted = tasks.map(|task_idx| {
            let mut group = self.groups.take();
            group.stats = TraceStats::default();
            let first_ray = task_idx * RAYS_PER_TASK;
            let part = first_ray..(first_ray + RAYS_PER_TASK).min(ray_count);
            dispatch!(self.config.simd.level(), simd => {
                trace_aligned(simd, asked, subfield, &mut group, part);
            });
            let stats = group.stats;
            self.groups.give_back(group);
            stats
        });
        counted.reduce(TraceStats::default, |a, b| a + b)
    }

    /// Answers rays, all active, that go along a direction.
    pub(super) fn trace_along(
        &mut self,
        held: &PrimitiveTable,
        asked: &Asked<'_>,
        rays: RayList<'_>,
        direction: Vec3,
    ) -> TraceStats {
        self.prepare(held, &[direction]);
        let _span = debug_span!("trace_walking").entered();
        let subfield = self.store.get(self.places[0]);
        let tasks = (0..rays.len().div_ceil(RAYS_PER_TASK)).into_par_iter();
        let counted = tasks.map(|task_idx| {
            let first = task_idx * RAYS_PER_TASK;
            let entries = first..(first + RAYS_PER_TASK).min(rays.len());
            self.trace_walking(asked, subfield, entries.map(|idx| rays.get(idx)))
        });
        counted.reduce(TraceStats::default, |a, b| a + b)
    }

    /// Answers rays direction by direction, as many directions at a time as the budget is good for.
    pub(super) fn trace_sorted(
        &mut self,
        held: &PrimitiveTable,
        asked: &Asked<'_>,
        rays: RayList<'_>,
    ) -> TraceStats {
        let mut stats = self.sorter.sort(asked, rays);
        let at_once = self.most_at_once();
        let sorter = std::mem::take(&mut self.sorter);
        for runs in sorter.runs().chunks(at_once) {
            let mut directions = std::mem::take(&mut self.directions);
            directions.clear();
            directions.extend(runs.iter().map(|run| run.direction));
            self.prepare(held, &directions);
            self.directions = directions;
            stats += self.trace_runs(asked, &sorter, runs);
        }
        self.sorter = sorter;
        stats
    }

    /// Traces the rays of some directions whose subfields are ready.
    fn trace_runs(&self, asked: &Asked<'_>, sorter: &DirectionSorter, runs: &[Run]) -> TraceStats {
        let _span = debug_span!("trace_walking").entered();
        let tasks = runs.par_iter().zip(&self.places).flat_map_iter(|(run, &place)| {
            let starts = run.entries.clone().step_by(RAYS_PER_TASK);
            starts.map(move |start| (place, start..(start + RAYS_PER_TASK).min(run.entries.end)))
        });
        let counted = tasks.map(|(place, entries)| {
            self.trace_walking(asked, self.store.get(place), sorter.ray_idx(entries))
        });
        counted.reduce(TraceStats::default, |a, b| a + b)
    }

    /// Answers active rays of one subfield, given their positions in the batch.
    fn trace_walking(
        &self,
        asked: &Asked<'_>,
        subfield: &Subfield,
        ray_idx: impl ExactSizeIterator<Item = usize>,
    ) -> TraceStats {
        let mut group = self.groups.take();
        group.stats = TraceStats::default();
        dispatch!(self.config.simd.level(), simd => {
            trace_walking(simd, asked, subfield, &mut group, ray_idx);
        });
        let stats = group.stats;
        self.groups.give_back(group);
        stats
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.directions.capacity() * size_of::<Vec3>()
            + self.places.capacity() * size_of::<usize>()
            + self.contents.memory_usage()
            + self.store.memory_usage()
            + self.sorter.memory_usage()
            + self.groups.sum(RayGroup::memory_usage)
    }
}
