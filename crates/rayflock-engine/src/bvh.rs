//! A tree over the geometry built anew each frame, and rays that flow through it in streams.
//!
//! ```text
//!   (parts)      objects that rest go to a kept tree, objects that change to a fresh one
//!   leaf_order   the order of the frame before where it still serves (split_greedily: a better
//!                one where it has served for long), else along a Hilbert curve (sort_slots)
//!   build_tree   (stage_triangles) sixteen primitives a leaf, sixteen leaves a node, sixteen nodes
//!                a node ...
//!   ray_block    some thousand rays, prepared for boxes and for triangles; neighbours that start
//!                and go alike become groups (ray_group)
//!   trace_block  lists go down the trees (walk_tree): of groups, one beam against sixteen boxes,
//!                in leaves all rays against each triangle that the beam meets (trace_groups);
//!                of single rays, each against sixteen boxes, then sixteen triangles (trace_rays)
//!   answer       hand the hits over
//! ```
//!
//! **Source.** I. Wald, C. Gribble, S. Boulos, A. Kensler, "SIMD Ray Stream Tracing", 2007;
//! J. Tsakok, "Faster Incoherent Rays: Multi-BVH Ray Stream Tracing", HPG 2009 (lists of rays
//! through nodes with as many children as a vector has lanes); C. Lauterbach et al., "Fast BVH
//! Construction on GPUs", Eurographics 2009 (a tree by sorting); S. Boulos, I. Wald, P. Shirley,
//! "Geometric and Arithmetic Culling Methods for Entire Ray Packets", UUCS-06-010, 2006 (intervals
//! around rays that go alike). For what is kept from frame to frame see `leaf_order`.
//!
//! **Departures.** The tree is filled from the bottom, so all nodes are full and none needs a
//! pointer; the curve is Hilbert's. Lists hold the rays that leave through one face of a cube, so
//! that they share the order of axes. Groups are looked for in sixteen neighbours at a time unless
//! the batch is said to have no order: what does not go like the first of those left is split off,
//! and whoever has no company travels alone. A group that has met too many triangles is dissolved:
//! its rays go on alone, with the hits that they have (`ray_group`).
//!
//! **Invariants.** Boxes are conservative (`simd::ray_boxes`, `simd::ray_beams`,
//! `simd::triangle_boxes`): a primitive that the accepting test would hit is in a leaf that the ray
//! gets to, unless a nearer hit was found before. Which tree an object is in changes speed, never
//! an answer.
//!
//! **Cost.** Per frame, two passes over what changed and a sort of it, with the leaves some 13 ns a
//! triangle on two AVX-512 server cores; 69 bytes a triangle above the table; the fresh tree is
//! built when the first batch of a frame comes. Per ray, 64 bytes in a block, 128 in batches with
//! an order. Groups took 1K triangles x 1M mirrored rays from 66 to 18 ms (the same cores).
//! Loading, grouping and answering a ray are some 30 cycles, a node 17 a single ray and 45 a group,
//! a leaf 45 a single ray. Dissolving groups took shadows of a dense teapot in a wide arena (158K
//! triangles, 230K rays) from 49 to 5.4 ms, its mirrored rays from 32 to 6.5 ms. Asking about the
//! boxes of spheres first, and dissolving groups by spheres as well, took shadows among 100K of
//! them (225K rays) from 207 to 18 ms.
//!
//! **Did not pay.** Sending rays of short lists through the rest of a tree one by one, nearest box
//! first; asking for the vertices of triangles ahead when leaves are written; huge pages.

mod build_tree;
mod config;
mod leaf_order;
mod ray_block;
mod ray_group;
mod sort_slots;
mod split_greedily;
mod stage_triangles;
mod trace_block;
mod trace_groups;
mod trace_rays;
mod tree;
mod walk_tree;

use rayflock_geom::simd::ray_boxes::BoxBounds;
use rayflock_geom::simd::{LANES, dispatch};
use rayflock_geom::{FrameChanges, Geometry, Hits, RayBatch, RayOrder};
use tracing::debug_span;
use web_time::Instant;

pub use config::Config;

use self::build_tree::TreeBuilder;
use self::trace_block::{BlockQuestion, BlockTracer};
use self::tree::Tree;
use crate::answer::AnswerColumns;
use crate::parts::{KeptChange, Parts, Place};
use crate::primitives::PrimitiveTable;
use crate::scratch::Scratch;
use crate::wanted::Wanted;
use crate::{CommitStats, EngineError, EngineKind, RayEngine, TraceStats};

/// Primitives along the side of a group of rays.
const GROUP_PRIMS: f32 = 8.0;

/// Traces streams of rays through a tree that is built anew each frame.
#[derive(Debug, Default)]
pub struct BvhEngine {
    config: Config,
    table: PrimitiveTable,
    parts: Parts,
    builder: TreeBuilder,
    wanted: Wanted,
    kept: Tree,
    fresh: Tree,
    /// Whether the fresh tree holds the objects of this frame; built when a first batch comes.
    fresh_is_built: bool,
    /// Memory of tasks that are not running.
    scratch: Scratch<BlockTracer>,
}

impl BvhEngine {
    /// An engine with an empty frame.
    pub fn new(config: Config) -> Self {
        Self { config, table: PrimitiveTable::new(config.simd), ..Self::default() }
    }

    /// Builds the kept tree if its objects changed, and once more when it has been of use for long.
    fn build_kept(&mut self) {
        self.fresh_is_built = false;
        let change = self.parts.divide(self.table.geometry(), self.table.spans());
        if change == KeptChange::Build || self.kept.order.holds() {
            self.list_wanted(|place| place == Place::Kept);
            self.builder.build(self.config.simd, &self.table, &self.wanted, &mut self.kept);
        }
    }

    /// Builds the fresh tree, once a frame; returns the nanoseconds that it took.
    fn build_fresh(&mut self) -> u64 {
        let start = Instant::now();
        if !self.fresh_is_built {
            let _span = debug_span!("build_tree").entered();
            self.fresh_is_built = true;
            self.list_wanted(|place| place != Place::Kept);
            self.builder.build(self.config.simd, &self.table, &self.wanted, &mut self.fresh);
        }
        start.elapsed().as_nanos() as u64
    }

    /// Lists the primitives of objects by where they are, without those that no ray sees.
    fn list_wanted(&mut self, is_chosen: impl Fn(Place) -> bool) {
        let (places, objects) = (self.parts.places(), self.table.geometry().objects());
        let is_wanted = |idx: usize| is_chosen(places[idx]) && objects[idx].mask != 0;
        self.wanted.list(self.table.spans(), is_wanted);
    }

    /// The box around everything in the trees.
    fn bounds(&self) -> BoxBounds {
        match (self.fresh.is_empty(), self.kept.is_empty()) {
            (false, false) => self.fresh.bounds.union(&self.kept.bounds),
            (false, true) => self.fresh.bounds,
            (true, _) => self.kept.bounds,
        }
    }

    /// How wide groups of rays may be: as some primitives, were these spread evenly over a square.
    fn group_width(&self, order: RayOrder) -> f32 {
        if matches!(order, RayOrder::Unordered) {
            return 0.0;
        }
        let leaf_count = self.fresh.leaf_count() + self.kept.leaf_count();
        let side = 2.0 * self.bounds().half_size.max_element();
        GROUP_PRIMS * side / ((leaf_count * LANES) as f32).sqrt()
    }

    /// Answers a batch, block by block.
    fn trace(&mut self, rays: &RayBatch<'_>, answers: AnswerColumns<'_>) -> TraceStats {
        if rays.is_empty() {
            return TraceStats::default();
        }
        let update_ns = self.build_fresh();
        self.fresh.order.serve(rays.len());
        self.kept.order.serve(rays.len());
        let asked = BlockQuestion {
            table: &self.table,
            batch: rays,
            trees: [&self.fresh, &self.kept],
            bounds: self.bounds(),
            group_width: self.group_width(rays.order()),
            question: answers.question(),
        };
        let prim_count = self.fresh.triangle_leaves.len() * LANES;
        let block_len = block_len(rays.len(), prim_count, asked.group_width > 0.0);
        let _span = debug_span!("trace_blocks").entered();
        TraceStats { update_ns, ..self.trace_part(&asked, block_len, 0, answers) }
    }

    /// Answers the rays from `first_ray` on, in parallel.
    fn trace_part(
        &self,
        asked: &BlockQuestion<'_>,
        block_len: usize,
        first_ray: usize,
        answers: AnswerColumns<'_>,
    ) -> TraceStats {
        if answers.len() > block_len {
            // Parts of whole vectors.
            let middle = (answers.len() / 2).next_multiple_of(LANES);
            let (left, right) = answers.split_at(middle);
            let (left, right) = rayon::join(
                || self.trace_part(asked, block_len, first_ray, left),
                || self.trace_part(asked, block_len, first_ray + middle, right),
            );
            return left + right;
        }
        let mut tracer = self.scratch.take();
        let stats = dispatch!(self.config.simd.level(), simd => {
            tracer.answer(simd, asked, first_ray, answers)
        });
        self.scratch.give_back(tracer);
        stats
    }
}

/// Rays that go through the tree together: as many as a cache holds, where groups leave few in a
/// leaf anyway; else enough for long lists there.
fn block_len(ray_count: usize, prim_count: usize, has_groups: bool) -> usize {
    let longest = match prim_count {
        _ if has_groups => 16 << 10,
        0..131_072 => 16 << 10,
        131_072..524_288 => 64 << 10,
        _ => 256 << 10,
    };
    let tasks = ray_count.div_ceil(longest).max(2 * rayon::current_num_threads());
    ray_count.div_ceil(tasks).next_multiple_of(LANES).clamp(1024.min(ray_count.max(1)), longest)
}

impl RayEngine for BvhEngine {
    fn name(&self) -> &str {
        EngineKind::Bvh.name()
    }

    fn commit(
        &mut self,
        geometry: &Geometry,
        changes: &FrameChanges,
    ) -> Result<CommitStats, EngineError> {
        let stats = self.table.commit(geometry, changes);
        self.build_kept();
        Ok(stats)
    }

    fn closest_hit(&mut self, rays: &RayBatch<'_>, hits: &mut Hits<'_>) -> TraceStats {
        assert!(hits.has_len(rays.len()), "every column must have one entry for each ray");
        self.trace(rays, AnswerColumns::Hits(hits.reborrow()))
    }

    fn occluded(&mut self, rays: &RayBatch<'_>, occluded: &mut [bool]) -> TraceStats {
        assert_eq!(occluded.len(), rays.len(), "there must be one answer for each ray");
        self.trace(rays, AnswerColumns::Occluded(occluded))
    }

    fn memory_usage(&self) -> usize {
        self.table.memory_usage()
            + self.parts.memory_usage()
            + self.builder.memory_usage()
            + self.kept.memory_usage()
            + self.fresh.memory_usage()
            + self.scratch.sum(BlockTracer::memory_usage)
    }
}
