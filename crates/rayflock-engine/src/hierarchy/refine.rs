//! Refines candidates down the ray tree: a node's children keep what their own cones touch.
//!
//! One task for each node of a level with enough nodes to keep all threads busy; it filters all
//! primitives once, then walks its subtree depth first with one list a level.

use std::ops::Range;
use std::sync::Mutex;

use rayflock_geom::RayBatch;
use rayflock_geom::simd::cone_sphere::touches;
use rayflock_geom::simd::{LANES, Simd, SimdBase, SimdLevel, dispatch, u32x16};

use super::arrange::Arrangement;
use super::candidates::Candidates;
use super::ray_tree::{RayNode, RayTree};
use super::trace_tile::TileTracer;
use crate::TraceStats;
use crate::packet::{Nearest, Question};
use crate::primitives::PrimitiveTable;

/// Tasks wanted for each thread, so that all finish at about the same time.
const TASKS_PER_THREAD: usize = 16;

/// One question about one batch, on its way through the tree.
pub(super) struct Pass<'a, F> {
    pub(super) simd: SimdLevel,
    pub(super) table: &'a PrimitiveTable,
    pub(super) tree: &'a RayTree,
    pub(super) arrangement: &'a Arrangement,
    pub(super) rays: &'a RayBatch<'a>,
    pub(super) t_bound: &'a F,
    pub(super) question: Question,
    /// Memory of tasks that are not running.
    pub(super) scratch: &'a Mutex<Vec<Scratch>>,
}

/// What one task works with.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    /// Candidates of the node at work, one list a level.
    lists: Vec<Candidates>,
    tracer: TileTracer,
}

impl Scratch {
    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        let lists: usize = self.lists.iter().map(Candidates::memory_usage).sum();
        lists + self.tracer.memory_usage()
    }
}

impl<F: Fn(usize) -> f32 + Sync> Pass<'_, F> {
    /// Answers all rays; `nearest` has sixteen entries a tile.
    pub(super) fn run(&self, nearest: &mut [Nearest]) -> TraceStats {
        let wanted = TASKS_PER_THREAD * rayon::current_num_threads();
        let levels = (0..self.tree.level_count()).rev();
        let level = levels.into_iter().find(|&level| self.tree.nodes(level).len() >= wanted);
        let level = level.unwrap_or(0);
        self.run_nodes(level, 0..self.tree.nodes(level).len(), nearest)
    }

    /// Runs a range of nodes of a level, in parallel.
    fn run_nodes(&self, level: usize, nodes: Range<usize>, nearest: &mut [Nearest]) -> TraceStats {
        match nodes.len() {
            0 => TraceStats::default(),
            1 => self.run_task(level, nodes.start, nearest),
            count => {
                let middle = nodes.start + count / 2;
                let tile = |node_idx| self.tree.first_tile(level, node_idx);
                let split = (tile(middle) - tile(nodes.start)) * LANES;
                let (left, right) = nearest.split_at_mut(split);
                let (left, right) = rayon::join(
                    || self.run_nodes(level, nodes.start..middle, left),
                    || self.run_nodes(level, middle..nodes.end, right),
                );
                left + right
            }
        }
    }

    fn run_task(&self, level: usize, node_idx: usize, nearest: &mut [Nearest]) -> TraceStats {
        let mut scratch = self.take_scratch();
        if scratch.lists.len() <= level {
            scratch.lists.resize_with(level + 1, Candidates::default);
        }
        let root = &self.tree.nodes(level)[node_idx];
        let mut stats = TraceStats::default();
        if root.is_active() {
            dispatch!(self.simd.level(), simd => {
                self.walk(simd, level, root, &mut scratch, nearest, &mut stats);
            });
        }
        self.give_back(scratch);
        stats
    }

    /// Walks the subtree of `root` depth first.
    #[inline(always)]
    fn walk<S: Simd>(
        &self,
        simd: S,
        root_level: usize,
        root: &RayNode,
        scratch: &mut Scratch,
        nearest: &mut [Nearest],
        stats: &mut TraceStats,
    ) {
        self.keep_touched(simd, root, &mut scratch.lists[root_level], stats);
        if root_level == 0 {
            self.trace_tile(simd, root, root, scratch, nearest, stats);
            return;
        }
        let mut children = [const { 0..0 }; MAX_LEVELS];
        let mut level = root_level;
        children[level] = root.children();
        loop {
            let Some(child_idx) = children[level].next() else {
                if level == root_level {
                    return;
                }
                level += 1;
                continue;
            };
            let child = &self.tree.nodes(level - 1)[child_idx];
            let (lists, parent_list) = scratch.lists.split_at_mut(level);
            refine_list(
                simd,
                child,
                self.table.slack(),
                &parent_list[0],
                &mut lists[level - 1],
                stats,
            );
            if lists[level - 1].len() == 0 {
                continue;
            }
            if level == 1 {
                self.trace_tile(simd, root, child, scratch, nearest, stats);
            } else {
                level -= 1;
                children[level] = child.children();
            }
        }
    }

    /// Fills `list` with all primitives that the rays of `node` may hit.
    #[inline(always)]
    fn keep_touched<S: Simd>(
        &self,
        simd: S,
        node: &RayNode,
        list: &mut Candidates,
        stats: &mut TraceStats,
    ) {
        let block_count = self.table.block_count();
        list.clear(block_count * LANES);
        let lane_numbers =
            u32x16::from_slice(simd, &std::array::from_fn::<u32, LANES, _>(|i| i as u32));
        for block_idx in 0..block_count {
            let spheres = self.table.bounds(block_idx).load(simd);
            let slots = lane_numbers + u32x16::splat(simd, (block_idx * LANES) as u32);
            let (kept, nearest) =
                touches(simd, &node.cone, node.reach, self.table.slack(), &spheres);
            list.append(simd, &spheres, slots, nearest, kept);
        }
        list.seal();
        stats.cone_tests += (block_count * LANES) as u64;
    }

    /// Traces the rays of a tile against the candidates in the lowest list.
    #[inline(always)]
    fn trace_tile<S: Simd>(
        &self,
        simd: S,
        root: &RayNode,
        tile: &RayNode,
        scratch: &mut Scratch,
        nearest: &mut [Nearest],
        stats: &mut TraceStats,
    ) {
        let tile_idx = tile.first_tile as usize;
        let ray_idx = &self.arrangement.ray_idx[tile_idx * LANES..(tile_idx + 1) * LANES];
        let place = (tile_idx - root.first_tile as usize) * LANES;
        let nearest = &mut nearest[place..place + LANES];
        let tracer = &mut scratch.tracer;
        tracer.gather(self.rays, ray_idx, self.t_bound);
        tracer.trace(simd, self.table, &scratch.lists[0], self.question, stats);
        tracer.store(nearest);
    }

    fn take_scratch(&self) -> Scratch {
        let pooled = self.scratch.lock().ok().and_then(|mut pool| pool.pop());
        pooled.unwrap_or_default()
    }

    fn give_back(&self, scratch: Scratch) {
        if let Ok(mut pool) = self.scratch.lock() {
            pool.push(scratch);
        }
    }
}

/// More levels than a tree of fanout 4 over 32-bit codes can have.
const MAX_LEVELS: usize = 18;

/// Keeps what the rays of `node` may hit of its parent's candidates.
#[inline(always)]
fn refine_list<S: Simd>(
    simd: S,
    node: &RayNode,
    slack: f32,
    parent: &Candidates,
    list: &mut Candidates,
    stats: &mut TraceStats,
) {
    list.clear(parent.len());
    if !node.is_active() {
        return;
    }
    for block_idx in 0..parent.block_count() {
        let (spheres, slots) = parent.load(simd, block_idx);
        let (kept, nearest) = touches(simd, &node.cone, node.reach, slack, &spheres);
        list.append(simd, &spheres, slots, nearest, kept);
    }
    list.seal();
    stats.cone_tests += (parent.block_count() * LANES) as u64;
}
