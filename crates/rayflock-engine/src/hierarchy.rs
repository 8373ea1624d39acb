//! The hierarchical ray engine: a structure over the rays, nothing over the geometry.
//!
//! Rays that share an origin or a direction, and look forward, are points of a face: see
//! `points`. All others go through a tree of cones:
//!
//! ```text
//!   arrange      rays into tiles of 16 that are close in space
//!   build_tree   bound each tile by a sphere-cone, then cones of cones, fanout 4
//!   refine       all primitives -> those a node's cone touches -> its children's ... -> a tile's
//!                (keep_touched asks the cone)
//!   trace_tile   test a tile's rays against its candidates, nearest first, until all candidates
//!                left lie beyond every hit
//!   trace_ray    the same ray by ray, where a tile has no list or more than 256 candidates
//!   answer       hand the hits over in the caller's order
//! ```
//!
//! **Source.** L. Szecsi, "The Hierarchical Ray Engine", WSCG 2006 (tiles of rays, enclosing
//! cones against enclosing spheres, the exact test behind them); D. Roger, U. Assarsson,
//! N. Holzschuch, "Whitted Ray-Tracing for Dynamic Scenes using a Ray-Space Hierarchy on the
//! GPU", EGSR 2007 (several levels, cones that start from spheres, pairs refined level by level);
//! N. Reis, V. Costa, J. Pereira, "Coherent Ray-Space Hierarchy via Ray Hashing and Sorting",
//! GRAPP 2017 (unordered rays hashed and sorted into tiles).
//!
//! **Departures.** Refinement is depth first with one list a level, so that lists stay in the
//! cache and memory does not grow with the number of pairs. Lists carry the bounding spheres they
//! refer to, written by compressing stores, so that no test gathers. Nodes also bound how far
//! their rays reach, and candidates of a tile are sorted by distance, which the depth test of a
//! graphics card did after the fact. Blocks of sixteen primitives that are neighbours in their
//! mesh are asked before their members, the shallow level over objects of Reis et al.; it costs
//! one pass and no ordering. Where a cone is wider than it is worth, the rays are their own cones.
//!
//! **Invariants.** Cones, reaches and slack are conservative: a primitive that the accepting test
//! would hit gets to the tile of the ray (`simd::cone_sphere`). Every primitive a tile skips for
//! its distance lies beyond the tile's hits.
//!
//! **Cost.** Per frame one pass over the primitives that changed, but for the first batch of
//! points, which passes all of them where they lie. Per batch and task one cone test for each block
//! of sixteen primitives and one for each member of a touched block, again below nodes too wide for
//! a list; then up to four for each surviving (node, primitive) pair. 20 bytes a ray, 12 more where
//! rays are sorted; 56 bytes a node; up to 24 bytes a primitive for each list of a thread, one list
//! a level at most.

mod arrange;
mod build_tree;
mod candidates;
mod config;
mod keep_touched;
mod points;
mod ray_tree;
mod refine;
mod sort_rays;
mod trace_ray;
mod trace_tile;

use rayflock_geom::{FrameChanges, Geometry, Hits, RayBatch};
use web_time::Instant;

pub use config::Config;

use self::arrange::Arrangement;
use self::points::{PointTracer, PointWork};
use self::ray_tree::RayTree;
use self::refine::TaskMemory;
use crate::answer::{offer_hits, tell_occluded};
use crate::packet::{Nearest, Question};
use crate::primitives::PrimitiveTable;
use crate::scratch::Scratch;
use crate::{CommitStats, EngineError, EngineKind, RayEngine, TraceStats};

/// Tests rays against the primitives that the cones around them touch.
#[derive(Debug, Default)]
pub struct HierarchyEngine {
    config: Config,
    table: PrimitiveTable,
    arrangement: Arrangement,
    tree: RayTree,
    points: PointTracer,
    /// Whether the last batch was traced as points of faces, not by the tree.
    on_faces: bool,
    /// Whether this frame has had a batch.
    has_traced: bool,
    /// Nearest hits in the order of the arrangement.
    nearest: Vec<Nearest>,
    /// Lists and packets of tasks that are not running.
    scratch: Scratch<TaskMemory>,
}

impl HierarchyEngine {
    /// An engine with an empty frame.
    pub fn new(config: Config) -> Self {
        Self { config, table: PrimitiveTable::new(config.simd), ..Self::default() }
    }

    /// Finds what all rays of the batch hit; `t_bounds`, if any, tell for each ray beyond which hits
    /// are of no interest.
    fn trace(
        &mut self,
        rays: &RayBatch<'_>,
        question: Question,
        t_bounds: Option<&[f32]>,
    ) -> TraceStats {
        let _span = tracing::debug_span!("trace_points").entered();
        let update_ns = if rays.is_empty() { 0 } else { self.write_for_more() };
        let work =
            PointWork { simd: self.config.simd, table: &self.table, rays, question, t_bounds };
        let traced = self.points.trace(&work);
        self.on_faces = traced.is_some();
        let mut stats = traced.unwrap_or_else(|| self.trace_tree(rays, question, t_bounds));
        stats.update_ns += update_ns;
        stats
    }

    /// One batch passes triangles where they lie; for more it pays to write them down. Returns the
    /// nanoseconds that it took.
    fn write_for_more(&mut self) -> u64 {
        if !std::mem::replace(&mut self.has_traced, true) {
            return 0;
        }
        let start = Instant::now();
        self.table.write_triangles();
        start.elapsed().as_nanos() as u64
    }

    /// Fills `nearest` by the tree of cones.
    fn trace_tree(
        &mut self,
        rays: &RayBatch<'_>,
        question: Question,
        t_bounds: Option<&[f32]>,
    ) -> TraceStats {
        let t_bound = &|ray_idx: usize| t_bounds.map_or(f32::INFINITY, |bounds| bounds[ray_idx]);
        self.table.write_bounds();
        self.arrangement.assign(rays);
        let mut stats = self.tree.build(rays, &self.arrangement, t_bound);
        // Tasks write what they begin with.
        self.nearest.resize(self.arrangement.ray_idx.len(), Nearest::NONE);
        let pass = refine::Pass {
            simd: self.config.simd,
            table: &self.table,
            tree: &self.tree,
            arrangement: &self.arrangement,
            rays,
            t_bound,
            question,
            scratch: &self.scratch,
        };
        stats += pass.run(&mut self.nearest);
        stats
    }

    /// The nearest hit of a ray in the tree of cones, by its position in the batch.
    #[inline(always)]
    fn found(&self, ray_idx: usize) -> Nearest {
        self.nearest[self.arrangement.place(ray_idx)]
    }
}

impl RayEngine for HierarchyEngine {
    fn name(&self) -> &str {
        EngineKind::Hierarchy.name()
    }

    fn commit(
        &mut self,
        geometry: &Geometry,
        changes: &FrameChanges,
    ) -> Result<CommitStats, EngineError> {
        self.has_traced = false;
        Ok(self.table.commit(geometry, changes))
    }

    fn closest_hit(&mut self, rays: &RayBatch<'_>, hits: &mut Hits<'_>) -> TraceStats {
        assert!(hits.has_len(rays.len()), "every column must have one entry for each ray");
        let stats = self.trace(rays, Question::Closest, Some(hits.t));
        if self.on_faces {
            offer_hits(&self.table, |ray_idx| self.points.nearest(ray_idx), hits);
        } else {
            offer_hits(&self.table, |ray_idx| self.found(ray_idx), hits);
        }
        stats
    }

    fn occluded(&mut self, rays: &RayBatch<'_>, occluded: &mut [bool]) -> TraceStats {
        assert_eq!(occluded.len(), rays.len(), "there must be one answer for each ray");
        let stats = self.trace(rays, Question::Occluded, None);
        if self.on_faces {
            tell_occluded(|ray_idx| self.points.is_occluded(ray_idx), occluded);
        } else {
            tell_occluded(|ray_idx| !self.found(ray_idx).is_none(), occluded);
        }
        stats
    }

    fn memory_usage(&self) -> usize {
        self.table.memory_usage()
            + self.arrangement.memory_usage()
            + self.tree.memory_usage()
            + self.points.memory_usage()
            + self.nearest.capacity() * size_of::<Nearest>()
            + self.scratch.sum(TaskMemory::memory_usage)
    }
}
