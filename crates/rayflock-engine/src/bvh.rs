//! A tree over the geometry built anew each frame, and rays that flow through it in streams.
//!
//! ```text
//!   (parts)      objects that rest go to a kept tree, objects that change to a fresh one
//!   leaf_order   the order of the frame before where it still serves; else along a Hilbert curve
//!                (sort_slots), or where many rays come, by area (split_by_area)
//!   build_tree   (stage_triangles) up to sixteen primitives a leaf, sixteen children a node, in
//!                the shape that goes with the order (tree_shape)
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
//! around rays that go alike). For what is kept from frame to frame see `leaf_order`, for trees by
//! area `split_by_area`.
//!
//! **Departures.** The curve is Hilbert's, and over it all leaves and nodes are full. Lists hold
//! the rays that leave through one face of a cube, so that they share the order of axes. Groups
//! are looked for in sixteen neighbours at a time: what does not go like the first of those left
//! is split off, and whoever has no company travels alone; so does what is left after two where
//! the batch is said to have no order. A group that has met too many triangles is dissolved: its
//! rays go on alone, with the hits that they have (`ray_group`).
//!
//! **Invariants.** Boxes are conservative (`simd::ray_boxes`, `simd::ray_beams`,
//! `simd::triangle_boxes`): a primitive that the accepting test would hit is in a leaf that the ray
//! gets to, unless a nearer hit was found before. Which tree an object is in changes speed, never
//! an answer.
//!
//! **Cost.** Per frame, two passes over what changed and a sort of it, with the leaves some 13 ns
//! a triangle on two AVX-512 server cores, 130 ns by area; 69 bytes a triangle above the table, by
//! area somewhat more and what splitting keeps; trees are built when the first batch of a frame
//! comes. Per ray, 64 bytes in a block, 128 in a group. Groups took 1K triangles x 1M mirrored
//! rays from 66 to 18 ms (the same cores). Loading, grouping and answering a ray are some 30
//! cycles, a node 17 a single ray and 45 a group, a leaf 45 a single ray. Dissolving groups took
//! shadows of a dense teapot in a wide arena (158K triangles, 230K rays) from 49 to 5.4 ms, its
//! mirrored rays from 32 to 6.5 ms. Asking about the boxes of spheres first, and dissolving groups
//! by spheres as well, took shadows among 100K of them (225K rays) from 207 to 18 ms. Looking for
//! groups among shadow rays toward a lamp as well, and trees by area, took museum7 at rest from 83
//! to 41 ms a picture (800 x 600).
//!
//! **Did not pay.** Sending rays of short lists through the rest of a tree one by one, nearest box
//! first; asking for the vertices of triangles ahead when leaves are written; huge pages; cutting
//! what fits into one leaf where the parts have less surface; writing leaves past the cache; handing
//! a list that all of it cross on to a child without copying it. Leaving out triangles that lie where
//! none of a few rays goes, by the voxels that these cross, before a tree is built: a million
//! triangles past 4K rays in no order took 20 instead of 23 ms, 256K no less. For rays in one
//! direction, the boxes of nodes and the edges of triangles on the plane across it: a million of
//! them past 64K triangles took as long as before, from above or toward suns.

mod build_tree;
mod config;
mod leaf_order;
mod ray_block;
mod ray_group;
mod sort_slots;
mod split_by_area;
mod stage_triangles;
mod trace_block;
mod trace_groups;
mod trace_rays;
mod tree;
mod tree_shape;
mod walk_tree;

use rayflock_geom::simd::ray_boxes::BoxBounds;
use rayflock_geom::simd::{LANES, SimdLevel, dispatch};
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

/// How many of sixteen rays are tried as the first of a group where the batch is said to have no
/// order: neighbours may go alike all the same, as shadow rays of a picture do.
const LEADERS_WITHOUT_ORDER: usize = 2;

/// A tree that is built when a first batch comes.
#[derive(Debug, Default)]
struct LazyTree {
    tree: Tree,
    /// Whether it holds what it should in this frame.
    is_built: bool,
}

/// Traces streams of rays through a tree that is built anew each frame.
#[derive(Debug, Default)]
pub struct BvhEngine {
    config: Config,
    table: PrimitiveTable,
    parts: Parts,
    builder: TreeBuilder,
    wanted: Wanted,
    /// Over the objects that rest.
    kept: LazyTree,
    /// Over the objects that change.
    fresh: LazyTree,
    /// Memory of tasks that are not running.
    scratch: Scratch<BlockTracer>,
}

impl LazyTree {
    /// Gets ready for so many rays: builds the tree over the primitives that are `wanted`, or makes
    /// the one that there is better.
    fn prepare(
        &mut self,
        (simd, table): (SimdLevel, &PrimitiveTable),
        builder: &mut TreeBuilder,
        wanted: &Wanted,
        ray_count: usize,
    ) {
        let Self { tree, is_built } = self;
        if !*is_built {
            let _span = debug_span!("build_tree").entered();
            builder.build(simd, table, wanted, ray_count, tree);
            *is_built = true;
        } else if tree.order.is_worth_splitting(ray_count) {
            let _span = debug_span!("build_tree").entered();
            builder.improve(simd, table, tree);
        }
        tree.order.serve(ray_count);
    }
}

impl BvhEngine {
    /// An engine with an empty frame.
    pub fn new(config: Config) -> Self {
        Self { config, table: PrimitiveTable::new(config.simd), ..Self::default() }
    }

    /// Builds the trees that this frame needs, or makes them better for so many rays to come;
    /// returns the nanoseconds that it took.
    fn build_trees(&mut self, ray_count: usize) -> u64 {
        let start = Instant::now();
        let Self { config, table, parts, builder, wanted, .. } = self;
        let places = parts.places();
        for (half, is_kept) in [(&mut self.kept, true), (&mut self.fresh, false)] {
            if !half.is_built {
                list_wanted(table, |idx| (places[idx] == Place::Kept) == is_kept, wanted);
            }
            half.prepare((config.simd, table), builder, wanted, ray_count);
        }
        start.elapsed().as_nanos() as u64
    }

    /// The box around everything in the trees.
    fn bounds(&self) -> BoxBounds {
        let bounds = [&self.fresh, &self.kept].into_iter().filter_map(|half| half.tree.bounds());
        bounds.reduce(|bounds, other| bounds.union(&other)).unwrap_or_default()
    }

    /// How wide groups of rays may be: as some primitives, were these spread evenly over a square.
    fn group_width(&self) -> f32 {
        let leaf_count = self.fresh.tree.leaf_count() + self.kept.tree.leaf_count();
        let side = 2.0 * self.bounds().half_size.max_element();
        GROUP_PRIMS * side / ((leaf_count * LANES) as f32).sqrt()
    }

    /// Answers a batch, block by block.
    fn trace(&mut self, rays: &RayBatch<'_>, answers: AnswerColumns<'_>) -> TraceStats {
        if rays.is_empty() {
            return TraceStats::default();
        }
        let update_ns = self.build_trees(rays.len());
        let has_order = !matches!(rays.order(), RayOrder::Unordered);
        let asked = BlockQuestion {
            table: &self.table,
            batch: rays,
            trees: [&self.fresh.tree, &self.kept.tree],
            bounds: self.bounds(),
            group_width: self.group_width(),
            leader_count: if has_order { LANES } else { LEADERS_WITHOUT_ORDER },
            question: answers.question(),
        };
        let prim_count = self.fresh.tree.triangle_leaves.len() * LANES;
        let block_len = block_len(rays.len(), prim_count, has_order);
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

/// Lists the primitives of the objects that are chosen, without those that no ray sees.
fn list_wanted(table: &PrimitiveTable, is_chosen: impl Fn(usize) -> bool, wanted: &mut Wanted) {
    let objects = table.geometry().objects();
    wanted.list(table.spans(), |idx| is_chosen(idx) && objects[idx].mask != 0);
}

/// Rays that go through the tree together: as many as a cache holds, where groups leave few in a
/// leaf anyway; else enough for long lists there.
fn block_len(ray_count: usize, prim_count: usize, has_order: bool) -> usize {
    let longest = match prim_count {
        _ if has_order => 8 << 10,
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
        let change = self.parts.divide(self.table.geometry(), self.table.spans());
        self.kept.is_built &= change == KeptChange::None;
        self.fresh.is_built = false;
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
            + self.kept.tree.memory_usage()
            + self.fresh.tree.memory_usage()
            + self.scratch.sum(BlockTracer::memory_usage)
    }
}
