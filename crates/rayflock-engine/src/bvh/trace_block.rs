//! Sends the rays of a block through the trees: breadth-wise, a list of rays a node.
//!
//! ```text
//!   visit(node, list)   each ray of the list against the sixteen boxes of the node's children
//!                       -> one bit a child; then for each child that any ray crosses, a list
//!   visit(leaf, list)   each ray of the list against the sixteen primitives of the leaf
//! ```
//!
//! Lists lie in one stack: a node's below those of its children. The rays of a
//! list leave through one face of a cube; children are visited from near to far along its axis, so
//! that hits shorten rays early.

use rayflock_geom::simd::aligned_rays::{FACES, face_axes, goes_along};
use rayflock_geom::simd::ray_boxes::{BoxBlock, BoxBounds, BoxLanes, crosses};
use rayflock_geom::simd::ray_triangle::{AlignedBlock, intersect_aligned};
use rayflock_geom::simd::{LANES, Simd, SimdBase, SimdMask, mask32x16, u32x16};
use rayflock_geom::{Ray, RayBatch};

use super::ray_block::RayBlock;
use super::tree::{Child, Tree, TriangleLeaf};
use crate::TraceStats;
use crate::packet::{Nearest, Question, TracePacket};
use crate::primitives::{PrimitiveTable, SPHERE_BYTES, TRIANGLE_BYTES};

/// What one block of rays asks.
pub(super) struct BlockQuestion<'a> {
    pub(super) table: &'a PrimitiveTable,
    pub(super) batch: &'a RayBatch<'a>,
    /// In the order in which they are traced.
    pub(super) trees: [&'a Tree; 2],
    /// The box around everything in the trees.
    pub(super) bounds: BoxBounds,
    pub(super) question: Question,
}

/// What a task works with.
#[derive(Debug)]
pub(super) struct BlockTracer {
    pub(super) rays: RayBlock,
    /// Lists of rays, by their positions in the block.
    lists: Vec<u32>,
    /// Which children each ray of a list crosses, one bit a child.
    crossed: Vec<u32>,
    visits: Vec<Visit>,
    /// Holds rays for primitives that are not triangles.
    packet: TracePacket,
}

/// A child of a tree that is still to be visited, by the rays in `first..first + len` of the
/// lists.
#[derive(Clone, Copy, Debug)]
struct Visit {
    child: Child,
    first: usize,
    len: usize,
}

impl Default for BlockTracer {
    fn default() -> Self {
        Self {
            rays: RayBlock::default(),
            lists: Vec::new(),
            crossed: Vec::new(),
            visits: Vec::new(),
            packet: TracePacket::EMPTY,
        }
    }
}

impl BlockTracer {
    /// Finds the nearest hits of the block's rays, one for each entry of `nearest`.
    #[inline(always)]
    pub(super) fn trace<S: Simd>(
        &mut self,
        simd: S,
        asked: &BlockQuestion<'_>,
        nearest: &mut [Nearest],
        stats: &mut TraceStats,
    ) {
        for face in 0..FACES {
            let len = self.rays.faces[face].len();
            for tree in asked.trees {
                if len == 0 || tree.is_empty() {
                    continue;
                }
                self.lists.clear();
                self.lists.extend_from_slice(&self.rays.faces[face]);
                self.lists.resize(len.next_multiple_of(LANES), 0);
                let child = Child::Node(tree.level_count() - 1, 0);
                self.visits.push(Visit { child, first: 0, len });
                self.trace_tree(simd, asked, tree, face, nearest, stats);
            }
        }
    }

    #[inline(always)]
    fn trace_tree<S: Simd>(
        &mut self,
        simd: S,
        asked: &BlockQuestion<'_>,
        tree: &Tree,
        face: usize,
        nearest: &mut [Nearest],
        stats: &mut TraceStats,
    ) {
        while let Some(visit) = self.visits.pop() {
            match visit.child {
                Child::Node(level, node_idx) => {
                    self.visit_node(simd, tree, [level, node_idx], face, visit, stats);
                }
                Child::Triangles(leaf_idx) => {
                    let leaf = &tree.triangle_leaves[leaf_idx];
                    let asked = (face, asked.question);
                    self.test_triangles(simd, leaf, asked, visit, nearest, stats);
                }
                Child::Others(leaf_idx) => {
                    let leaf = &tree.other_leaves[leaf_idx];
                    let slots = &leaf.slots[..leaf.count];
                    self.test_others(simd, asked, slots, visit, nearest, stats);
                }
            }
        }
    }

    /// Asks which rays cross which children, and writes the children's lists.
    #[inline(always)]
    fn visit_node<S: Simd>(
        &mut self,
        simd: S,
        tree: &Tree,
        [level, node_idx]: [usize; 2],
        face: usize,
        visit: Visit,
        stats: &mut TraceStats,
    ) {
        let boxes = tree.boxes(level, node_idx);
        let any = self.cross(simd, &boxes.load(simd, face_axes(face)), visit);
        let child_count = tree.child_count(level, node_idx);
        let any = any & (u32::MAX >> (32 - child_count));
        stats.box_tests += (visit.len * LANES) as u64;
        stats.bytes += size_of_val(boxes) as u64;

        // Whoever is visited first lies on top of the stack.
        let order = far_to_near(boxes, face, any);
        let mut top = visit.first + visit.len.next_multiple_of(LANES);
        let before = top;
        for lane in order {
            let len = self.append_list(simd, visit, lane, top);
            let child = tree.child(level, node_idx, lane);
            self.visits.push(Visit { child, first: top, len });
            top += len;
        }
        stats.pairs += (top - before) as u64;
        stats.bytes += 4 * (top - before) as u64;
    }

    /// Which children each ray of a list crosses; returns those that any does.
    #[inline(always)]
    fn cross<S: Simd>(&mut self, simd: S, boxes: &BoxLanes<S>, visit: Visit) -> u32 {
        let padded = visit.len.next_multiple_of(LANES);
        if self.crossed.len() < padded {
            self.crossed.resize(padded, 0);
        }
        let mut any = 0;
        let list = &self.lists[visit.first..visit.first + visit.len];
        for (&ray_idx, crossed) in list.iter().zip(&mut self.crossed) {
            let ray = &self.rays.rays[ray_idx as usize];
            let bits = crosses(simd, ray.origin, &ray.box_ray, boxes).to_bitmask() as u32;
            *crossed = bits;
            any |= bits;
        }
        self.crossed[visit.len..padded].fill(0);
        any
    }

    /// Writes the list of one child from `top` on; returns its length.
    #[inline(always)]
    fn append_list<S: Simd>(&mut self, simd: S, visit: Visit, lane: usize, top: usize) -> usize {
        let padded = visit.len.next_multiple_of(LANES);
        if self.lists.len() < top + padded + LANES {
            self.lists.resize(top + padded + LANES, 0);
        }
        let (list, free) = self.lists.split_at_mut(top);
        let list = &list[visit.first..visit.first + padded];
        let bit = u32x16::splat(simd, 1 << lane);
        let mut len = 0;
        for (rays, crossed) in list.chunks_exact(LANES).zip(self.crossed.chunks_exact(LANES)) {
            let crossed = u32x16::from_slice(simd, crossed) & bit;
            let kept = !crossed.simd_eq(u32x16::splat(simd, 0));
            let rays = u32x16::from_slice(simd, rays);
            simd.compress_u32x16(rays, kept).store_slice(&mut free[len..len + LANES]);
            len += kept.to_bitmask().count_ones() as usize;
        }
        len
    }

    /// Each ray of a list against sixteen triangles.
    #[inline(always)]
    fn test_triangles<S: Simd>(
        &mut self,
        simd: S,
        leaf: &TriangleLeaf,
        (face, question): (usize, Question),
        visit: Visit,
        nearest: &mut [Nearest],
        stats: &mut TraceStats,
    ) {
        let masks = u32x16::from_slice(simd, &leaf.masks);
        let triangles = AlignedBlock::load(simd, &leaf.triangles, face_axes(face));
        let mut test_count = 0;
        for &idx in &self.lists[visit.first..visit.first + visit.len] {
            let idx = idx as usize;
            let ray = &self.rays.rays[idx];
            if ray.is_done() {
                continue;
            }
            test_count += 1;
            let seen = masks & u32x16::splat(simd, ray.mask);
            let active: mask32x16<S> = !seen.simd_eq(u32x16::splat(simd, 0));
            let interval = [ray.t_min, ray.t_max];
            let hits = intersect_aligned(simd, ray.origin, ray.shear, interval, &triangles, active);
            if hits.accepted.any_true() {
                nearest[idx].offer_lanes(&hits, &leaf.ranks);
                self.rays.shorten(idx, &nearest[idx], question);
            }
        }
        stats.triangle_tests += (test_count * LANES) as u64;
        stats.bytes += (test_count * LANES) as u64 * TRIANGLE_BYTES;
    }

    /// Sixteen rays of a list at a time against each primitive of a leaf.
    #[inline(always)]
    fn test_others<S: Simd>(
        &mut self,
        simd: S,
        asked: &BlockQuestion<'_>,
        slots: &[u32],
        visit: Visit,
        nearest: &mut [Nearest],
        stats: &mut TraceStats,
    ) {
        let mut tests = TraceStats::default();
        for first in (visit.first..visit.first + visit.len).step_by(LANES) {
            let count = (visit.first + visit.len - first).min(LANES);
            self.packet.clear();
            for lane in 0..count {
                let idx = self.lists[first + lane] as usize;
                let t_max = self.rays.rays[idx].t_max;
                if !self.rays.rays[idx].is_done() {
                    let ray = asked.batch.ray(self.rays.first_ray + idx);
                    self.packet.set(lane, &Ray { t_max, ..ray }, f32::INFINITY);
                }
            }
            for &slot in slots {
                if !self.packet.is_done() {
                    self.packet.test(simd, asked.table, slot, asked.question, &mut tests);
                }
            }
            for lane in 0..count {
                let idx = self.lists[first + lane] as usize;
                let found = self.packet.nearest(lane);
                if !found.is_none() {
                    nearest[idx].offer(found);
                    self.rays.shorten(idx, &nearest[idx], asked.question);
                }
            }
        }
        tests.bytes = tests.sphere_tests / LANES as u64 * SPHERE_BYTES;
        *stats += tests;
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.rays.memory_usage()
            + (self.lists.capacity() + self.crossed.capacity()) * size_of::<u32>()
            + self.visits.capacity() * size_of::<Visit>()
    }
}

/// The children in `lanes` from the farthest to the nearest, for directions through a face.
#[inline(always)]
fn far_to_near(boxes: &BoxBlock, face: usize, lanes: u32) -> impl Iterator<Item = usize> {
    let [.., kz] = face_axes(face);
    let along = if goes_along(face) { -1.0 } else { 1.0 };
    let mut order = [(0.0, 0); LANES];
    let (mut count, mut remaining) = (0, lanes);
    while remaining != 0 {
        let lane = remaining.trailing_zeros() as usize;
        remaining &= remaining - 1;
        let place = along * boxes.center[kz][lane];
        let mut idx = count;
        while idx > 0 && order[idx - 1].0 > place {
            order[idx] = order[idx - 1];
            idx -= 1;
        }
        order[idx] = (place, lane);
        count += 1;
    }
    order.into_iter().take(count).map(|(_, lane)| lane)
}
