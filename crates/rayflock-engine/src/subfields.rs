//! Parallel subfields: grids of primitives, one for each direction.
//!
//! A grid across a direction has, in each of its tiles, the primitives that rays along the
//! direction may hit there; rays that go about along it walk over some tiles.
//!
//! ```text
//!   policy            when subfields are brought up to date: on demand, eagerly, or under locks
//!   sort_directions   rays by the nearest direction of a direction_set, unless they share one
//!   prepare (store)   the subfields of the directions that occur: what rests is written once, what
//!                     moves each frame, once, when a ray first wants it
//!     bin_triangles     project, and bring to blocks of tiles
//!     fill_block        to tiles, from near to far, sixteen a leaf (tile_grid)
//!   trace_aligned     rays along a shared direction: one tile each
//!   trace_walking     other rays: walk_tiles, from near to far
//!     meet_tile         one ray against the leaves between two depths
//!     ray_group         sixteen rays against spheres and user primitives
//!   trace_nests       the same in object space, for nested objects (nests, nest_place)
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
//! primitives, and about 250 to 550 bytes each for a direction. 64K triangles take 3 ms for a direction
//! (two AVX-512 server cores); a ray along it, about 40 ns of a core for each leaf.

mod asked;
mod bin_triangles;
mod build_grid;
mod config;
mod direction_set;
mod fields;
mod fill_block;
mod hand_over;
mod lock;
mod meet_tile;
mod nest_place;
mod nests;
mod policy;
mod ray_group;
mod setting;
mod sort_directions;
mod store;
mod subfield;
mod tile_grid;
mod trace_aligned;
mod trace_nests;
mod trace_walking;
mod walk_tiles;

use glam::Vec3;
use rayflock_geom::{FrameChanges, Geometry, Hits, RayBatch};

pub use config::{Config, Nesting, TileOrder, UpdatePolicy};
pub use direction_set::{DirectionLayout, DirectionSet};

use self::asked::{Asked, RayList};
use self::fields::Fields;
use self::nests::Nests;
use self::trace_nests::NestTracer;
use crate::answer::{offer_hits, tell_occluded};
use crate::answers::Answers;
use crate::packet::Question;
use crate::parts::{KeptChange, Parts, Place};
use crate::primitives::PrimitiveTable;
use crate::{CommitStats, EngineError, EngineKind, Fact, RayEngine, TraceStats};

/// Traces rays through grids, one for each direction.
#[derive(Debug, Default)]
pub struct SubfieldsEngine {
    config: Config,
    table: PrimitiveTable,
    parts: Parts,
    /// Of what is not nested.
    fields: Fields,
    nests: Nests,
    nest_tracer: NestTracer,
    /// Positions of the objects that rest in the grids.
    kept_objects: Vec<usize>,
    answers: Answers,
}

impl SubfieldsEngine {
    /// An engine with an empty frame.
    pub fn new(config: Config) -> Self {
        let (table, fields) = (PrimitiveTable::new(config.simd), Fields::new(config));
        Self { config, table, fields, ..Self::default() }
    }

    /// Lists what is in the grids of the scene, and stamps what changed.
    fn list_contents(&mut self, change: KeptChange) {
        let (spans, places, nests) = (self.table.spans(), self.parts.places(), &self.nests);
        let is_kept = |idx: usize| places[idx] == Place::Kept && !nests.is_nested(idx);
        let contents = &mut self.fields.contents;
        contents.frame += 1;
        let is_same =
            self.kept_objects.iter().copied().eq((0..spans.len()).filter(|&i| is_kept(i)));
        if change == KeptChange::Build || !is_same {
            self.kept_objects.clear();
            self.kept_objects.extend((0..spans.len()).filter(|&idx| is_kept(idx)));
            contents.kept_frame = contents.frame;
            contents.kept.list(spans, is_kept);
        }
        contents.moving.list(spans, |idx| places[idx] != Place::Kept && !nests.is_nested(idx));
    }

    /// Answers a batch; `t_bounds`, if any, tell for each ray beyond which hits are of no interest.
    fn trace(
        &mut self,
        rays: &RayBatch<'_>,
        question: Question,
        t_bounds: Option<&[f32]>,
    ) -> TraceStats {
        if rays.is_empty() {
            return TraceStats::default();
        }
        let shared = rays.direction().uniform();
        let shared = shared.filter(|shared| shared.is_finite() && *shared != Vec3::ZERO);
        self.answers.begin(rays.len(), question);
        let (table, answers) = (&self.table, &self.answers);
        let asked =
            Asked { table, batch: rays, question, t_bounds, answers, place: None, everywhere: &[] };
        let policy = self.config.policy.policy();
        let mut stats = match shared {
            Some(direction) => self.fields.trace_aligned(table, &asked, direction),
            None => policy.trace(&mut self.fields, table, &asked, RayList::All(rays.len())),
        };
        stats += self.nest_tracer.trace(&mut self.nests, policy, &asked, shared);
        stats.update_ns += self.fields.take_update_ns() + self.nests.take_update_ns();
        stats
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
        self.table.write_triangles();
        let change = self.parts.divide(self.table.geometry(), self.table.spans());
        self.nests.choose(&self.config, self.table.geometry(), self.table.spans());
        self.list_contents(change);
        let policy = self.config.policy.policy();
        self.fields.sorter.begin_frame();
        policy.begin_frame(&mut self.fields, &self.table);
        self.nests.begin_frame(policy);
        Ok(stats)
    }

    fn closest_hit(&mut self, rays: &RayBatch<'_>, hits: &mut Hits<'_>) -> TraceStats {
        assert!(hits.has_len(rays.len()), "every column must have one entry for each ray");
        let stats = self.trace(rays, Question::Closest, Some(hits.t));
        offer_hits(&self.table, |ray_idx| self.answers.nearest(ray_idx), hits);
        stats
    }

    fn occluded(&mut self, rays: &RayBatch<'_>, occluded: &mut [bool]) -> TraceStats {
        assert_eq!(occluded.len(), rays.len(), "there must be one answer for each ray");
        let stats = self.trace(rays, Question::Occluded, None);
        tell_occluded(|ray_idx| self.answers.is_occluded(ray_idx), occluded);
        stats
    }

    fn memory_usage(&self) -> usize {
        self.table.memory_usage()
            + self.parts.memory_usage()
            + self.fields.memory_usage()
            + self.nests.memory_usage()
            + self.nest_tracer.memory_usage()
            + self.kept_objects.capacity() * size_of::<usize>()
            + self.answers.memory_usage()
    }

    fn facts(&self) -> Vec<Fact> {
        let directions = self.fields.store.len();
        let prim_count = self.fields.contents.prim_count().max(1);
        let each = self.fields.store.grid_bytes() as f64 / (directions.max(1) * prim_count) as f64;
        vec![
            Fact { name: "directions held", value: directions as f64 },
            Fact { name: "bytes a primitive and direction", value: each },
            Fact { name: "nested objects", value: self.nests.place_count() as f64 },
        ]
    }
}
