//! What hangs where in a tree: which primitives are a leaf, and which children a node has.
//!
//! ```text
//!   level 2              [root]                 a node's children are leaves and nodes of lower
//!   level 1     [node]     |    [node]          levels, and nodes come after their children
//!   level 0   [node] [node] [node] ...
//!   leaves    up to 16 a node, up to 16 primitives a leaf
//! ```
//!
//! Over an order along a curve the shape is [full](TreeShape::fill): runs of sixteen are leaves,
//! sixteen leaves a node, sixteen nodes a node. Where it is worth more time, `split_by_area` finds
//! one that fits the geometry. Either is written from the bottom: all leaves, their end, then level
//! after level.

use std::ops::Range;

use rayflock_geom::simd::LANES;

/// A child of a node, by its position among nodes or among leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Child {
    /// A node.
    Node(usize),
    /// A leaf.
    Leaf(usize),
}

/// The children of a node, one a lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Links {
    children: [u32; LANES],
    pub(super) count: usize,
}

/// Set in what stands for a leaf among [`Links`].
const LEAF: u32 = 1 << 31;

impl Links {
    /// No children.
    pub(super) const NONE: Self = Self { children: [0; LANES], count: 0 };

    /// Adds a child.
    pub(super) fn push(&mut self, child: Child) {
        self.children[self.count] = match child {
            Child::Node(idx) => idx as u32,
            Child::Leaf(idx) => idx as u32 | LEAF,
        };
        self.count += 1;
    }

    /// The child of a lane.
    #[inline(always)]
    pub(super) const fn child(&self, lane: usize) -> Child {
        let child = self.children[lane];
        if child & LEAF == 0 {
            Child::Node(child as usize)
        } else {
            Child::Leaf((child ^ LEAF) as usize)
        }
    }

    /// All children.
    pub(super) fn children(&self) -> impl Iterator<Item = Child> {
        (0..self.count).map(|lane| self.child(lane))
    }
}

/// Leaves and nodes of a tree, without their boxes. See the [module](self).
#[derive(Debug, Default)]
pub(super) struct TreeShape {
    /// Where each leaf begins among the primitives; after the last leaf, their number.
    leaf_starts: Vec<u32>,
    /// Nodes, the root last.
    pub(super) links: Vec<Links>,
    /// Where each level begins among the nodes; after the last level, their number.
    level_starts: Vec<usize>,
}

impl TreeShape {
    /// Takes the shape of a tree over so many primitives whose leaves and nodes are all full, but
    /// for the last of each level.
    pub(super) fn fill(&mut self, prim_count: usize) {
        self.clear();
        (0..prim_count).step_by(LANES).for_each(|first| self.push_leaf(first));
        self.end_leaves(prim_count);
        let mut below = 0..self.leaf_count();
        let mut child: fn(usize) -> Child = Child::Leaf;
        while !below.is_empty() {
            for first in below.clone().step_by(LANES) {
                let mut links = Links::NONE;
                (first..below.end.min(first + LANES)).for_each(|idx| links.push(child(idx)));
                self.push_node(links);
            }
            let first_node = self.level_starts[self.level_starts.len() - 1];
            self.end_level();
            (below, child) = (first_node..self.links.len(), Child::Node);
            if below.len() == 1 {
                break;
            }
        }
    }

    /// Forgets all.
    pub(super) fn clear(&mut self) {
        self.leaf_starts.clear();
        self.links.clear();
        self.level_starts.clear();
    }

    /// Adds a leaf, which begins at a primitive and ends where the next one begins.
    pub(super) fn push_leaf(&mut self, first: usize) {
        self.leaf_starts.push(first as u32);
    }

    /// Ends the last leaf, and begins the lowest level of nodes.
    pub(super) fn end_leaves(&mut self, prim_count: usize) {
        self.leaf_starts.push(prim_count as u32);
        self.level_starts.push(0);
    }

    /// Adds a node above leaves and nodes that are there; returns its position.
    pub(super) fn push_node(&mut self, links: Links) -> usize {
        self.links.push(links);
        self.links.len() - 1
    }

    /// Ends a level of nodes, and begins the next.
    pub(super) fn end_level(&mut self) {
        self.level_starts.push(self.links.len());
    }

    /// Number of leaves.
    pub(super) fn leaf_count(&self) -> usize {
        self.leaf_starts.len().saturating_sub(1)
    }

    /// The primitives of a leaf.
    #[inline(always)]
    pub(super) fn leaf(&self, leaf_idx: usize) -> Range<usize> {
        self.leaf_starts[leaf_idx] as usize..self.leaf_starts[leaf_idx + 1] as usize
    }

    /// The nodes of each level, from the lowest.
    pub(super) fn levels(&self) -> impl Iterator<Item = Range<usize>> {
        self.level_starts.windows(2).map(|bounds| bounds[0]..bounds[1])
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.leaf_starts.capacity() * size_of::<u32>()
            + self.links.capacity() * size_of::<Links>()
            + self.level_starts.capacity() * size_of::<usize>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn full_shapes_hold_all_leaves_and_nodes_once() {
        for prim_count in [0, 1, 16, 17, 256, 257, 4097] {
            let mut shape = TreeShape::default();
            shape.fill(prim_count);
            assert_eq!(shape.leaf_count(), prim_count.div_ceil(LANES));
            let prims = (0..shape.leaf_count()).flat_map(|leaf_idx| shape.leaf(leaf_idx));
            assert!(prims.eq(0..prim_count), "{prim_count} primitives");
            let children: Vec<_> = shape.links.iter().flat_map(Links::children).collect();
            let leaves = (0..shape.leaf_count()).map(Child::Leaf);
            let nodes = (0..shape.links.len().saturating_sub(1)).map(Child::Node);
            assert!(children.into_iter().eq(leaves.chain(nodes)), "{prim_count} primitives");
            assert!(shape.levels().flatten().eq(0..shape.links.len()));
        }
    }
}
