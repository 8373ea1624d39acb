//! Builds a tree over some primitives: their order and its shape, leaves, boxes from the bottom up.

use glam::Vec3;
use rayflock_geom::simd::ray_boxes::BoxBounds;
use rayflock_geom::simd::triangle_boxes::{
    around_spheres, around_triangles, half_area_around_each,
};
use rayflock_geom::simd::triangle_rows::{ROW_COUNT, columns_of_rows};
use rayflock_geom::simd::{LANES, Simd, SimdLevel, SimdMask, dispatch};
use rayon::prelude::*;
use tracing::debug_span;

use super::leaf_order::{LeafOrder, Ordering};
use super::sort_slots::SlotSorter;
use super::split_by_area::AreaSplitter;
use super::stage_triangles::{StagedTriangles, TriangleReader};
use super::tree::{Nodes, OtherLeaf, Tree};
use crate::primitives::PrimitiveTable;
use crate::triangle_leaf::TriangleLeaf;
use crate::wanted::{Wanted, WantedLanes};

/// Leaves that are written one after the other.
const LEAVES_PER_CHUNK: usize = 16;

/// Chunks that one task writes at least.
const CHUNKS_PER_TASK: usize = 8;

/// How many triangles before their turn memory is asked for them.
const ROWS_AHEAD: usize = 2 * ROW_COUNT;

/// Builds trees, keeping its memory.
#[derive(Debug, Default)]
pub(super) struct TreeBuilder {
    triangles: SlotSorter,
    others: SlotSorter,
    splitter: AreaSplitter,
}

impl TreeBuilder {
    /// Builds `tree` over the wanted primitives, with so many rays to come.
    pub(super) fn build(
        &mut self,
        level: SimdLevel,
        table: &PrimitiveTable,
        wanted: &Wanted,
        ray_count: usize,
        tree: &mut Tree,
    ) {
        let triangles = &wanted.triangles;
        let ordering = tree.order.choose(triangles, ray_count);
        self.order(level, table, triangles, ordering, tree);
        let writer = LeafWriter { level, table };
        let spread = writer.write_triangles(tree);
        if tree.order.judge(spread) {
            let ordering = LeafOrder::make_for(tree.order.slots.len(), ray_count);
            self.order(level, table, triangles, ordering, tree);
            let spread = writer.write_triangles(tree);
            tree.order.judge(spread);
        }
        self.others.sort(level, table, &wanted.others);
        tree.others.shape.fill(self.others.len());
        writer.write_others(&self.others, tree);
        let _span = debug_span!("bound_nodes").entered();
        tree.triangles.bound(level);
        tree.others.bound(level);
    }

    /// Makes the order of the triangles of a tree that is built a better one.
    pub(super) fn improve(&mut self, level: SimdLevel, table: &PrimitiveTable, tree: &mut Tree) {
        self.splitter.split(table, &mut tree.order.slots, &mut tree.triangles.shape);
        tree.order.improved();
        let spread = LeafWriter { level, table }.write_triangles(tree);
        tree.order.judge(spread);
        let _span = debug_span!("bound_nodes").entered();
        tree.triangles.bound(level);
    }

    /// Orders the wanted triangles.
    fn order(
        &mut self,
        level: SimdLevel,
        table: &PrimitiveTable,
        wanted: &[WantedLanes],
        ordering: Ordering,
        tree: &mut Tree,
    ) {
        let (slots, shape) = (&mut tree.order.slots, &mut tree.triangles.shape);
        match ordering {
            Ordering::Keep => return,
            Ordering::Split => {
                slots.clear();
                slots.extend(wanted.iter().flat_map(WantedLanes::slots));
                self.splitter.split(table, slots, shape);
            }
            Ordering::Sort => {
                self.triangles.sort(level, table, wanted);
                slots.clear();
                slots.extend(self.triangles.slots());
                shape.fill(slots.len());
            }
        }
        tree.order.replaced(wanted, ordering == Ordering::Split);
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.triangles.memory_usage() + self.others.memory_usage() + self.splitter.memory_usage()
    }
}

struct LeafWriter<'a> {
    level: SimdLevel,
    table: &'a PrimitiveTable,
}

impl LeafWriter<'_> {
    /// Writes the leaves of triangles and their boxes. Returns the spread of the leaves.
    fn write_triangles(&self, tree: &mut Tree) -> f32 {
        let _span = debug_span!("write_leaves").entered();
        tree.triangles.resize();
        let Nodes { shape, leaf_bounds, .. } = &mut tree.triangles;
        tree.triangle_leaves.resize(shape.leaf_count(), TriangleLeaf::EMPTY);
        let slots = &tree.order.slots;
        let leaves = tree.triangle_leaves.par_chunks_mut(LEAVES_PER_CHUNK);
        let tasks = leaves.zip(leaf_bounds.par_chunks_mut(LEAVES_PER_CHUNK)).enumerate();
        let areas =
            tasks.with_min_len(CHUNKS_PER_TASK).map(|(chunk_idx, (leaves, leaf_bounds))| {
                let mut areas = [0.0; 2];
                dispatch!(self.level.level(), simd => {
                    let mut reader = TriangleReader::new(self.table);
                    let mut staged = StagedTriangles::EMPTY;
                    for (pair_idx, pair) in leaves.chunks_mut(2).enumerate() {
                        let first = chunk_idx * LEAVES_PER_CHUNK + 2 * pair_idx;
                        reader.ask_for(rows_ahead(&slots[shape.leaf(first).start..]));
                        for (idx, leaf_idx) in (first..first + pair.len()).enumerate() {
                            reader.stage(&slots[shape.leaf(leaf_idx)], idx, &mut staged);
                        }
                        write_pair(simd, &staged, pair);
                    }
                    for (leaf, bounds) in leaves.iter().zip(leaf_bounds) {
                        *bounds = around_triangles(simd, &leaf.triangles);
                        areas[0] += bounds.half_area();
                        areas[1] += half_area_around_each(simd, &leaf.triangles);
                    }
                });
                areas
            });
        let [leaf_area, own_area] = areas.reduce(|| [0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
        leaf_area / own_area
    }

    /// Writes the leaves of other primitives and their boxes.
    fn write_others(&self, sorter: &SlotSorter, tree: &mut Tree) {
        tree.others.resize();
        let Nodes { shape, leaf_bounds, .. } = &mut tree.others;
        tree.other_leaves.resize(shape.leaf_count(), OtherLeaf::EMPTY);
        let tasks = tree.other_leaves.par_iter_mut().zip(leaf_bounds).enumerate();
        let tasks = tasks.with_min_len(LEAVES_PER_CHUNK * CHUNKS_PER_TASK);
        tasks.for_each(|(leaf_idx, (leaf, bounds))| {
            *bounds = dispatch!(self.level.level(), simd => {
                self.write_other_leaf(simd, sorter, leaf_idx * LANES, leaf)
            });
        });
    }

    #[inline(always)]
    fn write_other_leaf<S: Simd>(
        &self,
        simd: S,
        sorter: &SlotSorter,
        first: usize,
        leaf: &mut OtherLeaf,
    ) -> BoxBounds {
        leaf.count = (sorter.len() - first).min(LANES);
        for lane in 0..LANES {
            let slot = sorter.slot(first + if lane < leaf.count { lane } else { 0 });
            leaf.slots[lane] = slot;
            leaf.bounds.set(lane, &self.table.bound(slot));
        }
        around_spheres(simd, &leaf.bounds)
    }
}

/// The slots of two leaves that memory is to be asked for; fewer near the end.
#[inline(always)]
fn rows_ahead(slots: &[u32]) -> &[u32] {
    let [first, end] = [ROWS_AHEAD, ROWS_AHEAD + ROW_COUNT].map(|row| slots.len().min(row));
    &slots[first..end]
}

/// Writes staged triangles as one or two leaves.
#[inline(always)]
fn write_pair<S: Simd>(simd: S, staged: &StagedTriangles, leaves: &mut [TriangleLeaf]) {
    let triangles = columns_of_rows(simd, &staged.rows);
    for (idx, (leaf, mut triangles)) in leaves.iter_mut().zip(triangles).enumerate() {
        if let Some(transform) = &staged.transforms[idx] {
            triangles = triangles.transformed(simd, transform);
        }
        triangles.store(&mut leaf.triangles);
        leaf.masks = staged.masks[idx];
        leaf.ranks = staged.ranks[idx];
        let solid = triangles.solid(simd);
        if !solid.all_true() {
            leave_out(leaf, !solid.to_bitmask());
        }
    }
}

/// Hides those of the triangles of a leaf that are ignored, so that its box is not theirs.
#[cold]
fn leave_out(leaf: &mut TriangleLeaf, ignored: u64) {
    let solid = (0..LANES).find(|lane| ignored & (1 << lane) == 0);
    let instead = solid.map_or([Vec3::ZERO; 3], |lane| leaf.triangles.get(lane));
    for lane in (0..LANES).filter(|lane| ignored & (1 << lane) != 0) {
        leaf.triangles.set(lane, instead);
        leaf.masks[lane] = 0;
    }
}
