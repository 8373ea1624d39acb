//! Builds a tree over some primitives: leaves in the order of a curve, nodes from the bottom up.

use glam::Vec3;
use rayflock_geom::simd::ray_boxes::{BoxBlock, BoxBounds};
use rayflock_geom::simd::triangle_boxes::{
    around_spheres, around_triangles, half_area_around_each,
};
use rayflock_geom::simd::triangle_rows::{ROW_COUNT, columns_of_rows};
use rayflock_geom::simd::{LANES, Simd, SimdLevel, SimdMask, dispatch};
use rayon::prelude::*;
use tracing::debug_span;

use super::leaf_order::{LeafOrder, Ordering};
use super::sort_slots::SlotSorter;
use super::split_greedily::GreedySplitter;
use super::stage_triangles::{StagedTriangles, TriangleReader};
use super::tree::{OtherLeaf, Tree};
use crate::primitives::PrimitiveTable;
use crate::triangle_leaf::TriangleLeaf;
use crate::wanted::Wanted;

/// Nodes of sixteen leaves that one task writes at least.
const NODES_PER_TASK: usize = 8;

/// How many triangles before their turn memory is asked for them.
const ROWS_AHEAD: usize = 2 * ROW_COUNT;

/// Builds trees, keeping its memory.
#[derive(Debug, Default)]
pub(super) struct TreeBuilder {
    triangles: SlotSorter,
    others: SlotSorter,
    greedy: GreedySplitter,
}

impl TreeBuilder {
    /// Builds `tree` over the wanted primitives.
    pub(super) fn build(
        &mut self,
        level: SimdLevel,
        table: &PrimitiveTable,
        wanted: &Wanted,
        tree: &mut Tree,
    ) {
        let ordering = tree.order.choose(&wanted.triangles);
        self.order(level, table, wanted, ordering, &mut tree.order);
        self.others.sort(level, table, &wanted.others);
        tree.resize(tree.order.slots.len().div_ceil(LANES), self.others.len().div_ceil(LANES));
        let writer = LeafWriter { level, table };
        let spread = writer.write_triangles(tree);
        if tree.order.judge(spread) {
            self.order(level, table, wanted, Ordering::Sort, &mut tree.order);
            let spread = writer.write_triangles(tree);
            tree.order.judge(spread);
        }
        let triangle_nodes = tree.triangle_node_count();
        writer.write_others(
            &self.others,
            &mut tree.other_leaves,
            &mut tree.nodes[triangle_nodes..],
        );
        let _span = debug_span!("bound_nodes").entered();
        for upper in 1..tree.level_count() {
            bound_level(level, tree, upper);
        }
        if let Some(root) = tree.nodes.last() {
            tree.bounds = dispatch!(level.level(), simd => root.around(simd));
        }
    }

    /// Orders the wanted triangles.
    fn order(
        &mut self,
        level: SimdLevel,
        table: &PrimitiveTable,
        wanted: &Wanted,
        ordering: Ordering,
        order: &mut LeafOrder,
    ) {
        match ordering {
            Ordering::Keep => {}
            Ordering::Improve => {
                let slots = self.greedy.order(table, &order.slots);
                order.replace(&wanted.triangles, slots, true);
            }
            Ordering::Sort => {
                self.triangles.sort(level, table, &wanted.triangles);
                order.replace(&wanted.triangles, self.triangles.slots(), false);
            }
        }
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.triangles.memory_usage() + self.others.memory_usage() + self.greedy.memory_usage()
    }
}

struct LeafWriter<'a> {
    level: SimdLevel,
    table: &'a PrimitiveTable,
}

impl LeafWriter<'_> {
    /// Writes the leaves of triangles and the nodes over them. Returns the spread of the leaves.
    fn write_triangles(&self, tree: &mut Tree) -> f32 {
        let _span = debug_span!("write_leaves").entered();
        let (nodes, slots) = (&mut tree.nodes, &tree.order.slots);
        let tasks = tree.triangle_leaves.par_chunks_mut(LANES).zip(nodes).enumerate();
        let areas = tasks.with_min_len(NODES_PER_TASK).map(|(node_idx, (leaves, node))| {
            let mut areas = [0.0; 2];
            dispatch!(self.level.level(), simd => {
                let mut reader = TriangleReader::new(self.table);
                let mut staged = StagedTriangles::EMPTY;
                let first = node_idx * LANES * LANES;
                for (pair_idx, pair) in leaves.chunks_mut(2).enumerate() {
                    let slots = &slots[first + pair_idx * ROW_COUNT..];
                    reader.ask_for(pair_ahead(slots));
                    reader.stage(slots, &mut staged);
                    write_pair(simd, &staged, pair);
                }
                for (lane, leaf) in leaves.iter().enumerate() {
                    let bounds = around_triangles(simd, &leaf.triangles);
                    node.set(lane, &bounds);
                    areas[0] += bounds.half_area();
                    areas[1] += half_area_around_each(simd, &leaf.triangles);
                }
            });
            node.pad(leaves.len());
            areas
        });
        let [leaf_area, own_area] = areas.reduce(|| [0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
        leaf_area / own_area
    }

    fn write_others(&self, sorter: &SlotSorter, leaves: &mut [OtherLeaf], nodes: &mut [BoxBlock]) {
        let tasks = leaves.par_chunks_mut(LANES).zip(nodes).enumerate();
        tasks.with_min_len(NODES_PER_TASK).for_each(|(node_idx, (leaves, node))| {
            dispatch!(self.level.level(), simd => {
                for (lane, leaf) in leaves.iter_mut().enumerate() {
                    let first = (node_idx * LANES + lane) * LANES;
                    node.set(lane, &self.write_other_leaf(simd, sorter, first, leaf));
                }
            });
            node.pad(leaves.len());
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

/// The slots of the pair of leaves that memory is to be asked for; fewer near the end.
#[inline(always)]
fn pair_ahead(slots: &[u32]) -> &[u32] {
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

/// Writes the boxes of a level's nodes: around those of the level below.
fn bound_level(level: SimdLevel, tree: &mut Tree, upper: usize) {
    let (range, below) = (tree.level(upper), tree.level(upper - 1));
    let (lower_nodes, nodes) = tree.nodes.split_at_mut(range.start);
    let nodes = nodes[..range.len()].par_iter_mut();
    let tasks = nodes.zip(lower_nodes[below].par_chunks(LANES));
    tasks.with_min_len(NODES_PER_TASK).for_each(|(node, children)| {
        dispatch!(level.level(), simd => {
            for (lane, child) in children.iter().enumerate() {
                node.set(lane, &child.around(simd));
            }
        });
        node.pad(children.len());
    });
}
