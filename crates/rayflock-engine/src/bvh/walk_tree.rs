//! The way of lists through a tree: whoever is in a list of a node is asked about its children, and
//! each child gets a list of those that cross it.
//!
//! ```text
//!   visit(node, list)   each traveller of the list against the sixteen boxes of the node's children
//!                       -> one bit a child; then for each child that any crosses, a list
//!   visit(leaf, list)   each traveller of the list against the sixteen primitives of the leaf
//! ```
//!
//! Travellers are single rays (`trace_rays`) or groups of rays that go similar ways
//! (`trace_groups`). Lists lie in one stack: a node's below those of its children. Travellers of a
//! list leave through one face of a cube; children are visited from near to far along its axis, so
//! that hits shorten rays early.

use rayflock_geom::simd::aligned_rays::{face_axes, goes_along};
use rayflock_geom::simd::ray_boxes::{BoxBlock, BoxLanes};
use rayflock_geom::simd::triangle_boxes::sphere_boxes;
use rayflock_geom::simd::{LANES, Simd, SimdBase, SimdMask, u32x16};

use super::tree::{Kind, Nodes, OtherLeaf, Tree};
use super::tree_shape::Child;
use crate::TraceStats;
use crate::triangle_leaf::TriangleLeaf;

/// Whoever goes through a tree, by numbers.
pub(super) trait Travellers<S: Simd> {
    /// Sixteen boxes, made ready for many travellers.
    type Boxes;

    /// Makes the boxes of a node ready.
    fn ready(boxes: BoxLanes<S>) -> Self::Boxes;

    /// Which boxes a traveller may cross, one bit a box.
    fn crosses(&self, simd: S, traveller: u32, boxes: &Self::Boxes) -> u32;

    /// All of a list against the triangles of a leaf.
    fn meet_triangles(
        &mut self,
        simd: S,
        leaf: &TriangleLeaf,
        face: usize,
        list: &[u32],
        stats: &mut TraceStats,
    );

    /// All of a list against the other primitives of a leaf, which lie in `boxes`.
    fn meet_others(
        &mut self,
        simd: S,
        leaf: &OtherLeaf,
        boxes: &Self::Boxes,
        list: &[u32],
        stats: &mut TraceStats,
    );
}

/// Lists on their way through a tree; memory is kept.
#[derive(Debug, Default)]
pub(super) struct TreeWalk {
    /// Lists of travellers.
    lists: Vec<u32>,
    /// Which children each traveller of a list crosses, one bit a child.
    crossed: Vec<u32>,
    visits: Vec<Visit>,
}

/// A child of a tree that is still to be visited, by the travellers in `first..first + len` of
/// the lists.
#[derive(Clone, Copy, Debug)]
struct Visit {
    child: Child,
    first: usize,
    len: usize,
}

impl TreeWalk {
    /// Sends the travellers in `list`, who leave through one face, through a tree.
    #[inline(always)]
    pub(super) fn walk<S: Simd, T: Travellers<S>>(
        &mut self,
        simd: S,
        tree: &Tree,
        face: usize,
        list: &[u32],
        travellers: &mut T,
        stats: &mut TraceStats,
    ) {
        if list.is_empty() {
            return;
        }
        self.lists.clear();
        self.lists.extend_from_slice(list);
        self.lists.resize(list.len().next_multiple_of(LANES), 0);
        for half in tree.halves() {
            let (kind, nodes) = half;
            if nodes.is_empty() {
                continue;
            }
            let root = Child::Node(nodes.boxes.len() - 1);
            self.visits.push(Visit { child: root, first: 0, len: list.len() });
            while let Some(visit) = self.visits.pop() {
                let list = visit.first..visit.first + visit.len;
                match (visit.child, kind) {
                    (Child::Node(node_idx), _) => {
                        self.visit_node(
                            simd,
                            (tree, half),
                            node_idx,
                            face,
                            visit,
                            travellers,
                            stats,
                        );
                    }
                    (Child::Leaf(leaf_idx), Kind::Triangles) => {
                        let leaf = &tree.triangle_leaves[leaf_idx];
                        travellers.meet_triangles(simd, leaf, face, &self.lists[list], stats);
                    }
                    (Child::Leaf(leaf_idx), Kind::Others) => {
                        let leaf = &tree.other_leaves[leaf_idx];
                        let boxes = T::ready(sphere_boxes(simd, &leaf.bounds, face_axes(face)));
                        travellers.meet_others(simd, leaf, &boxes, &self.lists[list], stats);
                    }
                }
            }
        }
    }

    /// Asks who crosses which children, and writes the children's lists.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "all of a visit, which exists only here")]
    fn visit_node<S: Simd, T: Travellers<S>>(
        &mut self,
        simd: S,
        (tree, half): (&Tree, (Kind, &Nodes)),
        node_idx: usize,
        face: usize,
        visit: Visit,
        travellers: &T,
        stats: &mut TraceStats,
    ) {
        let (boxes, links) = (&half.1.boxes[node_idx], &half.1.shape.links[node_idx]);
        let any = self.cross(simd, &T::ready(boxes.load(simd, face_axes(face))), visit, travellers);
        let any = any & (u32::MAX >> (32 - links.count));
        stats.box_tests += (visit.len * LANES) as u64;
        stats.bytes += size_of_val(boxes) as u64;

        // Whoever is visited first lies on top of the stack.
        let order = far_to_near(boxes, face, any);
        let mut top = visit.first + visit.len.next_multiple_of(LANES);
        let before = top;
        for lane in order {
            let len = self.append_list(simd, visit, lane, top);
            let child = links.child(lane);
            tree.ask_for(half, child);
            self.visits.push(Visit { child, first: top, len });
            top += len;
        }
        stats.pairs += (top - before) as u64;
        stats.bytes += 4 * (top - before) as u64;
    }

    /// Which children each traveller of a list crosses; returns those that any does.
    #[inline(always)]
    fn cross<S: Simd, T: Travellers<S>>(
        &mut self,
        simd: S,
        boxes: &T::Boxes,
        visit: Visit,
        travellers: &T,
    ) -> u32 {
        let padded = visit.len.next_multiple_of(LANES);
        if self.crossed.len() < padded {
            self.crossed.resize(padded, 0);
        }
        let mut any = 0;
        let list = &self.lists[visit.first..visit.first + visit.len];
        for (&traveller, crossed) in list.iter().zip(&mut self.crossed) {
            let bits = travellers.crosses(simd, traveller, boxes);
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
        for (travellers, crossed) in list.chunks_exact(LANES).zip(self.crossed.chunks_exact(LANES))
        {
            let crossed = u32x16::from_slice(simd, crossed) & bit;
            let kept = !crossed.simd_eq(u32x16::splat(simd, 0));
            let travellers = u32x16::from_slice(simd, travellers);
            simd.compress_u32x16(travellers, kept).store_slice(&mut free[len..len + LANES]);
            len += kept.to_bitmask().count_ones() as usize;
        }
        len
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        (self.lists.capacity() + self.crossed.capacity()) * size_of::<u32>()
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
