//! Refines candidates down the ray tree: a node keeps those of its parent's candidates that its
//! own cone touches.
//!
//! One task for each node of a level with enough nodes to keep all threads busy walks its subtree
//! depth first, with one list a level.

use std::ops::Range;

use rayflock_geom::simd::{LANES, Simd, SimdLevel, dispatch};
use rayflock_geom::{Ray, RayBatch};
use tracing::debug_span;

use super::arrange::{Arrangement, active_ray};
use super::build_tree::bound_ray;
use super::candidates::Candidates;
use super::keep_touched::{keep_of_all, keep_of_list};
use super::ray_tree::{RayNode, RayTree};
use super::trace_ray::RayTracer;
use super::trace_tile::TileTracer;
use crate::TraceStats;
use crate::packet::{Nearest, Question};
use crate::primitives::PrimitiveTable;
use crate::scratch::Scratch;

/// Tasks wanted for each thread, so that all finish at about the same time.
const TASKS_PER_THREAD: usize = 16;

/// Tiles with more candidates than this are traced ray by ray.
const LONGEST_TILE_LIST: usize = 256;

/// A long list of more than one in this many of all primitives is dropped: below, whole blocks can
/// be rejected again.
const LARGEST_SHARE: usize = 4;

/// More levels than a tree of fanout 4 over 32-bit codes can have, and one above the root.
const MAX_LEVELS: usize = 19;

/// One question about one batch, on its way through the tree.
pub(super) struct Pass<'a, F> {
    pub(super) simd: SimdLevel,
    pub(super) table: &'a PrimitiveTable,
    pub(super) tree: &'a RayTree,
    pub(super) arrangement: &'a Arrangement,
    pub(super) rays: &'a RayBatch<'a>,
    /// Distance, in multiples of the direction, beyond which hits of a ray are of no interest.
    pub(super) t_bound: &'a F,
    pub(super) question: Question,
    /// Memory of tasks that are not running.
    pub(super) scratch: &'a Scratch<TaskMemory>,
}

/// What one task works with.
#[derive(Debug, Default)]
pub(super) struct TaskMemory {
    /// Candidates of the node at work, one list a level.
    lists: Vec<Candidates>,
    /// Candidates of a single ray.
    ray_list: Candidates,
    tile_tracer: TileTracer,
    ray_tracer: RayTracer,
}

impl TaskMemory {
    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        let lists: usize = self.lists.iter().map(Candidates::memory_usage).sum();
        lists
            + self.ray_list.memory_usage()
            + self.tile_tracer.memory_usage()
            + self.ray_tracer.memory_usage()
    }
}

/// A level on the path from the root to the node at work.
struct Visit {
    /// Nodes of the level below that are still to be visited.
    children: Range<usize>,
    /// Whether the level's list holds the candidates; otherwise they are all primitives.
    listed: bool,
}

impl<F: Fn(usize) -> f32 + Sync> Pass<'_, F> {
    /// Answers all rays; `nearest` has sixteen entries a tile.
    pub(super) fn run(&self, nearest: &mut [Nearest]) -> TraceStats {
        if nearest.is_empty() {
            return TraceStats::default();
        }
        let wanted = TASKS_PER_THREAD * rayon::current_num_threads();
        let has_enough = |level: &usize| self.tree.nodes(*level).len() >= wanted;
        let level = (0..self.tree.level_count()).rev().find(has_enough).unwrap_or(0);
        self.run_nodes(level, 0..self.tree.nodes(level).len(), nearest)
    }

    /// Runs a range of nodes of a level, in parallel.
    fn run_nodes(&self, level: usize, nodes: Range<usize>, nearest: &mut [Nearest]) -> TraceStats {
        if nodes.len() == 1 {
            return self.run_task(level, nodes.start, nearest);
        }
        let middle = nodes.start + nodes.len() / 2;
        let first_tile = |node_idx| self.tree.first_tile(level, node_idx);
        let split = (first_tile(middle) - first_tile(nodes.start)) * LANES;
        let (left, right) = nearest.split_at_mut(split);
        let (left, right) = rayon::join(
            || self.run_nodes(level, nodes.start..middle, left),
            || self.run_nodes(level, middle..nodes.end, right),
        );
        left + right
    }

    fn run_task(&self, level: usize, node_idx: usize, nearest: &mut [Nearest]) -> TraceStats {
        let _span = debug_span!("refine").entered();
        nearest.fill(Nearest::NONE);
        let mut scratch = self.scratch.take();
        if scratch.lists.len() <= level {
            scratch.lists.resize_with(level + 1, Candidates::default);
        }
        let mut stats = TraceStats::default();
        dispatch!(self.simd.level(), simd => {
            self.walk(simd, level, node_idx, &mut scratch, nearest, &mut stats);
        });
        self.scratch.give_back(scratch);
        stats
    }

    /// Walks the subtree of a node depth first.
    #[inline(always)]
    fn walk<S: Simd>(
        &self,
        simd: S,
        root_level: usize,
        root_idx: usize,
        scratch: &mut TaskMemory,
        nearest: &mut [Nearest],
        stats: &mut TraceStats,
    ) {
        let first_tile = self.tree.first_tile(root_level, root_idx);
        let mut path = [const { Visit { children: 0..0, listed: false } }; MAX_LEVELS];
        let mut level = root_level + 1;
        path[level].children = root_idx..root_idx + 1;
        loop {
            let Some(node_idx) = path[level].children.next() else {
                if level == root_level + 1 {
                    return;
                }
                level += 1;
                continue;
            };
            let node = &self.tree.nodes(level - 1)[node_idx];
            let parent_listed = path[level].listed;
            let Some(listed) = self.select(simd, node, level - 1, parent_listed, scratch, stats)
            else {
                continue;
            };
            if level == 1 {
                let tile_idx = node.first_tile as usize;
                let place = (tile_idx - first_tile) * LANES;
                let nearest = &mut nearest[place..place + LANES];
                if listed && scratch.lists[0].len() <= LONGEST_TILE_LIST {
                    self.trace_tile(simd, tile_idx, scratch, nearest, stats);
                } else {
                    self.trace_rays(simd, tile_idx, listed, scratch, nearest, stats);
                }
            } else {
                level -= 1;
                path[level] = Visit { children: node.children(), listed };
            }
        }
    }

    /// Selects the candidates of a node: `Some(true)` when they are in the level's list,
    /// `Some(false)` when they are still all primitives, `None` when there are none.
    ///
    /// A wide node lies below nodes without a list only, and is not worth one itself.
    #[inline(always)]
    fn select<S: Simd>(
        &self,
        simd: S,
        node: &RayNode,
        level: usize,
        parent_listed: bool,
        scratch: &mut TaskMemory,
        stats: &mut TraceStats,
    ) -> Option<bool> {
        if !node.is_active() {
            return None;
        }
        if node.is_wide() && !parent_listed {
            return Some(false);
        }
        if parent_listed {
            let (lists, parent) = scratch.lists.split_at_mut(level + 1);
            let (list, slack) = (&mut lists[level], self.table.slack());
            keep_of_list(simd, &parent[0], &node.cone, node.reach, slack, list, stats);
        } else {
            let list = &mut scratch.lists[level];
            keep_of_all(simd, self.table, &node.cone, node.reach, list, stats);
            let is_long = list.len() > LONGEST_TILE_LIST;
            if is_long && list.len() * LARGEST_SHARE > self.table.block_count() * LANES {
                return Some(false);
            }
        }
        (scratch.lists[level].len() > 0).then_some(true)
    }

    /// Traces the rays of a tile together against the candidates in the lowest list.
    #[inline(always)]
    fn trace_tile<S: Simd>(
        &self,
        simd: S,
        tile_idx: usize,
        scratch: &mut TaskMemory,
        nearest: &mut [Nearest],
        stats: &mut TraceStats,
    ) {
        let tracer = &mut scratch.tile_tracer;
        tracer.gather(self.rays, self.arrangement.tile(tile_idx), self.t_bound);
        tracer.trace(simd, self.table, &scratch.lists[0], self.question, stats);
        tracer.store(nearest);
    }

    /// Traces the rays of a tile one by one, each against what it touches of the candidates.
    #[inline(always)]
    fn trace_rays<S: Simd>(
        &self,
        simd: S,
        tile_idx: usize,
        listed: bool,
        scratch: &mut TaskMemory,
        nearest: &mut [Nearest],
        stats: &mut TraceStats,
    ) {
        let TaskMemory { lists, ray_list: list, ray_tracer, .. } = scratch;
        for (&ray_idx, nearest) in self.arrangement.tile(tile_idx).iter().zip(nearest) {
            let Some(ray) = active_ray(self.rays, ray_idx) else { continue };
            let ray = Ray { t_max: ray.t_max.min((self.t_bound)(ray_idx as usize)), ..ray };
            let (cone, reach) = bound_ray(&ray);
            if listed {
                keep_of_list(simd, &lists[0], &cone, reach, self.table.slack(), list, stats);
            } else {
                keep_of_all(simd, self.table, &cone, reach, list, stats);
            }
            *nearest = ray_tracer.trace(simd, self.table, &ray, self.question, list, stats);
        }
    }
}
