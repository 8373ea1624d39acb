//! A tree of boxes over primitives, without pointers.
//!
//! ```text
//!   level 2                 [root]                     node n of a level has as children the nodes
//!   level 1      [node 0]  ...  [node 15]              16 n .. 16 n + 15 of the level below
//!   level 0   [node 0] ... [node 15] ... [node 255]
//!   leaves    16 a node, 16 primitives a leaf
//! ```
//!
//! All nodes are full but for the last of each level. Nodes of level 0 over leaves of triangles
//! come before those over leaves of other primitives.

use std::ops::Range;

use rayflock_geom::prefetch;
use rayflock_geom::simd::LANES;
use rayflock_geom::simd::cone_sphere::SphereBlock;
use rayflock_geom::simd::ray_boxes::{BoxBlock, BoxBounds};

use super::leaf_order::LeafOrder;
use crate::triangle_leaf::TriangleLeaf;

/// Up to sixteen spheres or user primitives.
#[derive(Clone, Copy, Debug)]
pub(super) struct OtherLeaf {
    /// Their bounding spheres.
    pub(super) bounds: SphereBlock,
    pub(super) slots: [u32; LANES],
    pub(super) count: usize,
}

impl OtherLeaf {
    /// A leaf without primitives.
    pub(super) const EMPTY: Self = Self { bounds: SphereBlock::EMPTY, slots: [0; LANES], count: 0 };

    /// Those of some lanes that hold a primitive.
    #[inline(always)]
    pub(super) const fn among(&self, lanes: u32) -> u32 {
        lanes & ((1 << self.count) - 1)
    }
}

/// What a child of a node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Child {
    /// A node, by its level and its place there.
    Node(usize, usize),
    /// A leaf of triangles.
    Triangles(usize),
    /// A leaf of other primitives.
    Others(usize),
}

/// Boxes over leaves over primitives. See the [module](self).
#[derive(Debug, Default)]
pub(super) struct Tree {
    pub(super) triangle_leaves: Vec<TriangleLeaf>,
    pub(super) other_leaves: Vec<OtherLeaf>,
    /// The boxes of each node's children, level after level.
    pub(super) nodes: Vec<BoxBlock>,
    /// How the leaves of triangles are ordered.
    pub(super) order: LeafOrder,
    /// Where each level begins among the nodes; after the last level, their number.
    level_starts: Vec<usize>,
    /// The box around everything.
    pub(super) bounds: BoxBounds,
}

impl Tree {
    /// Makes room for so many leaves and the nodes above them; what they hold is to be written.
    pub(super) fn resize(&mut self, triangle_leaves: usize, other_leaves: usize) {
        self.triangle_leaves.resize(triangle_leaves, TriangleLeaf::EMPTY);
        self.other_leaves.resize(other_leaves, OtherLeaf::EMPTY);
        self.level_starts.clear();
        self.level_starts.push(0);
        let mut count = triangle_leaves.div_ceil(LANES) + other_leaves.div_ceil(LANES);
        let mut node_count = count;
        while count > 0 {
            self.level_starts.push(node_count);
            if count == 1 {
                break;
            }
            count = count.div_ceil(LANES);
            node_count += count;
        }
        self.nodes.resize(node_count, BoxBlock::ZERO);
    }

    /// Whether there is nothing to hit.
    pub(super) fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Number of leaves of any kind.
    pub(super) fn leaf_count(&self) -> usize {
        self.triangle_leaves.len() + self.other_leaves.len()
    }

    /// Number of levels of nodes.
    pub(super) fn level_count(&self) -> usize {
        self.level_starts.len().saturating_sub(1)
    }

    /// The nodes of a level among all nodes.
    pub(super) fn level(&self, level: usize) -> Range<usize> {
        self.level_starts[level]..self.level_starts[level + 1]
    }

    /// Number of nodes of level 0 over leaves of triangles.
    pub(super) fn triangle_node_count(&self) -> usize {
        self.triangle_leaves.len().div_ceil(LANES)
    }

    /// The boxes of a node's children.
    #[inline(always)]
    pub(super) fn boxes(&self, level: usize, node_idx: usize) -> &BoxBlock {
        &self.nodes[self.level_starts[level] + node_idx]
    }

    /// Number of children of a node.
    #[inline(always)]
    pub(super) fn child_count(&self, level: usize, node_idx: usize) -> usize {
        let (below, node_idx) = if level > 0 {
            (self.level(level - 1).len(), node_idx)
        } else if node_idx < self.triangle_node_count() {
            (self.triangle_leaves.len(), node_idx)
        } else {
            (self.other_leaves.len(), node_idx - self.triangle_node_count())
        };
        (below - node_idx * LANES).min(LANES)
    }

    /// A child of a node.
    #[inline(always)]
    pub(super) fn child(&self, level: usize, node_idx: usize, lane: usize) -> Child {
        if level > 0 {
            Child::Node(level - 1, node_idx * LANES + lane)
        } else if node_idx < self.triangle_node_count() {
            Child::Triangles(node_idx * LANES + lane)
        } else {
            Child::Others((node_idx - self.triangle_node_count()) * LANES + lane)
        }
    }

    /// Asks for a child that will be visited soon, so that it is in the cache by then.
    #[inline(always)]
    pub(super) fn ask_for(&self, child: Child) {
        match child {
            Child::Node(level, node_idx) => prefetch(self.boxes(level, node_idx)),
            Child::Triangles(leaf_idx) => prefetch(&self.triangle_leaves[leaf_idx]),
            Child::Others(leaf_idx) => prefetch(&self.other_leaves[leaf_idx]),
        }
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.triangle_leaves.capacity() * size_of::<TriangleLeaf>()
            + self.other_leaves.capacity() * size_of::<OtherLeaf>()
            + self.nodes.capacity() * size_of::<BoxBlock>()
            + self.order.memory_usage()
    }
}
