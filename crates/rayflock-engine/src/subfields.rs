//! Parallel subfields: grids of primitives, one for each direction.
//!
//! A grid across a direction has, in each of its tiles, the primitives that rays along the
//! direction may hit there; rays that go about along it walk over some tiles.
//!
//! ```text
//!   sort_directions   rays by the nearest direction of a direction_set, unless they share one
//!   prepare (store)   the subfields of the directions that occur: what rests is written once, what
//!                     moves each frame, once, when a ray first wants it
//!     bin_triangles     project, and bring to blocks of tiles
//!     fill_block        to tiles, from near to far, sixteen a leaf (tile_grid)
//!   trace_aligned     rays along a shared direction: one tile each
//!   trace_walking     other rays: walk_tiles, from near to far
//!     meet_tile         one ray against the leaves between two depths
//!     ray_group         sixteen rays against spheres and user primitives
//!   answer            hand the hits over
//! ```
//!
//! **Source.** P. Khanna, J. Mortensen, I. Yu, M. Slater, "Fast Ray Tracing of Scenes With
//! Unstructured Motion", SIGGRAPH 2004 posters (subfields of tiles, a 1D BSP along each, static and
//! dynamic identifiers, stamps of frames, update on demand); J. Mortensen, P. Khanna, I. Yu,
//! M. Slater, "A Visibility Field for Ray Tracing", CGIV 2007 (directions and their look-up).
//!
//! **Departures.** A batch that shares a direction gets a subfield along exactly that one. Tiles hold
//! corners, not identifiers, sixteen triangles a leaf in the order of their depth: an implicit 1D
//! BSP. Tiles are as small as the primitives around them are worth, and what moves has a grid of its
//! own with a window around it, so that a small object in a large place gets small tiles. Instead of
//! locking a subfield when a ray needs it, a batch is sorted by direction first; then each
//! direction is brought up to date once, all in parallel. Stamps are kept by block, not by tile.
//!
//! **Invariants.** Places and depths are conservative: `simd::face` bounds what the accepting test
//! may move a triangle, `walk_tiles` what a ray's place may be off. Only blocks with the stamp of
//! the frame are read.
//!
//! `docs/algorithms/subfields.md` has the whole story.
//!
//! **Cost.** A frame costs nothing until a direction is wanted; then two passes over its moving
//! primitives, and about 150 bytes each for a direction. 64K triangles take 3 ms for a direction
//! (two AVX-512 server cores); a ray along it, about 40 ns of a core for each leaf.

mod bin_triangles;
mod build_grid;
mod config;
mod direction_set;
mod fill_block;
mod meet_tile;
mod ray_group;
mod sort_directions;
mod store;
mod subfield;
mod tile_grid;
mod trace_aligned;
mod trace_walking;
mod walk_tiles;

use glam::Vec3;
use rayflock_geom::simd::dispatch;
use rayflock_geom::{FrameChanges, Geometry, Hits, RayBatch};
use rayon::prelude::*;
use tracing::debug_span;

pub use config::Config;
pub use direction_set::{DirectionLayout, DirectionSet};

use self::ray_group::{Asked, RayGroup};
use self::sort_directions::{DirectionSorter, Run};
use self::store::{Contents, SubfieldStore, bytes_for};
use self::trace_aligned::trace_aligned;
use self::trace_walking::trace_walking;
use crate::answer::{offer_hits, tell_occluded};
use crate::answers::Answers;
use crate::packet::Question;
use crate::parts::{KeptChange, Parts, Place};
use crate::primitives::PrimitiveTable;
use crate::scratch::Scratch;
use crate::{CommitStats, EngineError, EngineKind, RayEngine, TraceStats};

/// Rays that one task traces.
const RAYS_PER_TASK: usize = 1024;

/// Traces rays through grids, one for each direction.
#[derive(Debug, Default)]
pub struct SubfieldsEngine {
    config: Config,
    table: PrimitiveTable,
    parts: Parts,
    contents: Contents,
    store: SubfieldStore,
    sorter: DirectionSorter,
    answers: Answers,
    groups: Scratch<RayGroup>,
}

impl SubfieldsEngine {
    /// An engine with an empty frame.
    pub fn new(config: Config) -> Self {
        Self { config, table: PrimitiveTable::new(config.simd), ..Self::default() }
    }

    /// Answers a batch; `t_bound` tells beyond which hits are of no interest.
    fn trace(
        &mut self,
        rays: &RayBatch<'_>,
        question: Question,
        t_bound: &(impl Fn(usize) -> f32 + Sync),
    ) -> TraceStats {
        let shared = rays.direction().uniform();
        let shared = shared.filter(|shared| shared.is_finite() && *shared != Vec3::ZERO);
        self.answers.begin(rays.len(), question);
        match shared {
            Some(direction) => self.trace_aligned(rays, direction, question, t_bound),
            None => self.trace_walking(rays, question, t_bound),
        }
    }

    /// Answers a batch whose rays share a direction.
    fn trace_aligned(
        &mut self,
        rays: &RayBatch<'_>,
        direction: Vec3,
        question: Question,
        t_bound: &(impl Fn(usize) -> f32 + Sync),
    ) -> TraceStats {
        let (simd, budget) = (self.config.simd, self.config.budget);
        let place = self.store.prepare(simd, &self.table, &self.contents, &[direction], budget)[0];
        let _span = debug_span!("trace_aligned").entered();
        let asked = Asked { table: &self.table, batch: rays, question };
        let (subfield, groups) = (self.store.get(place), &self.groups);
        let answers = &self.answers;
        let tasks = (0..rays.len().div_ceil(RAYS_PER_TASK)).into_par_iter();
        let counted = tasks.map(|task_idx| {
            let mut group = groups.take();
            group.stats = TraceStats::default();
            let first_ray = task_idx * RAYS_PER_TASK;
            let part = first_ray..(first_ray + RAYS_PER_TASK).min(rays.len());
            dispatch!(simd.level(), simd => {
                trace_aligned(simd, &asked, subfield, &mut group, part, t_bound, answers);
            });
            let stats = group.stats;
            groups.give_back(group);
            stats
        });
        counted.reduce(TraceStats::default, |a, b| a + b)
    }

    /// Answers a batch whose rays go all ways: direction by direction.
    fn trace_walking(
        &mut self,
        rays: &RayBatch<'_>,
        question: Question,
        t_bound: &(impl Fn(usize) -> f32 + Sync),
    ) -> TraceStats {
        let prim_count = self.table.geometry().prim_count();
        self.sorter.choose(&self.config, rays.len(), prim_count);
        let mut stats = self.sorter.sort(rays, &self.answers);
        let at_once = (self.config.budget / bytes_for(&self.table)).max(1);
        for runs in self.sorter.runs().chunks(at_once) {
            let directions: Vec<Vec3> = runs.iter().map(|run| run.direction).collect();
            let (simd, budget) = (self.config.simd, self.config.budget);
            let places = self.store.prepare(simd, &self.table, &self.contents, &directions, budget);
            stats += self.trace_runs(rays, question, t_bound, runs, &places);
        }
        stats
    }

    /// Traces the rays of some directions whose subfields are ready.
    fn trace_runs(
        &self,
        rays: &RayBatch<'_>,
        question: Question,
        t_bound: &(impl Fn(usize) -> f32 + Sync),
        runs: &[Run],
        places: &[usize],
    ) -> TraceStats {
        let _span = debug_span!("trace_walking").entered();
        let asked = Asked { table: &self.table, batch: rays, question };
        let level = self.config.simd.level();
        let tasks = runs.par_iter().zip(places).flat_map_iter(|(run, &place)| {
            let starts = run.entries.clone().step_by(RAYS_PER_TASK);
            starts.map(move |start| (place, start..(start + RAYS_PER_TASK).min(run.entries.end)))
        });
        let counted = tasks.map(|(place, entries)| {
            let mut group = self.groups.take();
            group.stats = TraceStats::default();
            let ray_idx = self.sorter.ray_idx(entries);
            let subfield = self.store.get(place);
            dispatch!(level, simd => {
                trace_walking(simd, &asked, subfield, &mut group, ray_idx, t_bound, &self.answers);
            });
            let stats = group.stats;
            self.groups.give_back(group);
            stats
        });
        counted.reduce(TraceStats::default, |a, b| a + b)
    }
}

impl RayEngine for SubfieldsEngine {
    fn name(&self) -> &str {
        EngineKind::Subfields.name()
    }

    fn commit(
        &mut self,
        geometry: &Geometry,
        changes: &FrameChanges,
    ) -> Result<CommitStats, EngineError> {
        let stats = self.table.commit(geometry, changes);
        let contents = &mut self.contents;
        contents.frame += 1;
        if self.parts.divide(self.table.geometry(), self.table.spans()) == KeptChange::Build {
            contents.kept_frame = contents.frame;
            contents.kept.list(&self.table, self.parts.places(), |place| place == Place::Kept);
        }
        contents.moving.list(&self.table, self.parts.places(), |place| place != Place::Kept);
        Ok(stats)
    }

    fn closest_hit(&mut self, rays: &RayBatch<'_>, hits: &mut Hits<'_>) -> TraceStats {
        assert!(hits.has_len(rays.len()), "every column must have one entry for each ray");
        let bounds: &[f32] = hits.t;
        let stats = self.trace(rays, Question::Closest, &|ray_idx| bounds[ray_idx]);
        offer_hits(&self.table, |ray_idx| self.answers.nearest(ray_idx), hits);
        stats
    }

    fn occluded(&mut self, rays: &RayBatch<'_>, occluded: &mut [bool]) -> TraceStats {
        assert_eq!(occluded.len(), rays.len(), "there must be one answer for each ray");
        let stats = self.trace(rays, Question::Occluded, &|_| f32::INFINITY);
        tell_occluded(|ray_idx| self.answers.is_occluded(ray_idx), occluded);
        stats
    }

    fn memory_usage(&self) -> usize {
        self.table.memory_usage()
            + self.parts.memory_usage()
            + self.contents.memory_usage()
            + self.store.memory_usage()
            + self.sorter.memory_usage()
            + self.answers.memory_usage()
            + self.groups.sum(RayGroup::memory_usage)
    }
}
