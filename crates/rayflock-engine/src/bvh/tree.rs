//! A tree of boxes over primitives: over triangles and over others, as two halves.

use rayflock_geom::prefetch;
use rayflock_geom::simd::cone_sphere::SphereBlock;
use rayflock_geom::simd::ray_boxes::{BoxBlock, BoxBounds};
use rayflock_geom::simd::{LANES, SimdLevel, dispatch};
use rayon::prelude::*;

use super::leaf_order::LeafOrder;
use super::tree_shape::{Child, TreeShape};
use crate::triangle_leaf::TriangleLeaf;

/// Nodes that one task writes at least.
const NODES_PER_TASK: usize = 8;

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

/// What the leaves of a half hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Triangles,
    Others,
}

/// Boxes over leaves of one kind.
#[derive(Debug, Default)]
pub(super) struct Nodes {
    pub(super) shape: TreeShape,
    /// The box around each leaf.
    pub(super) leaf_bounds: Vec<BoxBounds>,
    /// The boxes of each node's children.
    pub(super) boxes: Vec<BoxBlock>,
    /// The box around everything.
    pub(super) bounds: BoxBounds,
}

/// Boxes over leaves over primitives.
#[derive(Debug, Default)]
pub(super) struct Tree {
    pub(super) triangle_leaves: Vec<TriangleLeaf>,
    pub(super) triangles: Nodes,
    pub(super) other_leaves: Vec<OtherLeaf>,
    pub(super) others: Nodes,
    /// How the leaves of triangles are ordered.
    pub(super) order: LeafOrder,
}

impl Nodes {
    /// Whether there is nothing to hit.
    pub(super) const fn is_empty(&self) -> bool {
        self.boxes.is_empty()
    }

    /// Makes room for the boxes of all leaves and nodes, which are to be written.
    pub(super) fn resize(&mut self) {
        self.leaf_bounds.resize(self.shape.leaf_count(), BoxBounds::default());
        self.boxes.resize(self.shape.links.len(), BoxBlock::ZERO);
    }

    /// Writes the boxes of nodes, those of leaves being known.
    pub(super) fn bound(&mut self, level: SimdLevel) {
        let Self { shape, leaf_bounds, boxes, .. } = self;
        for nodes in shape.levels() {
            let (below, boxes) = boxes.split_at_mut(nodes.start);
            let tasks = boxes[..nodes.len()].par_iter_mut().zip(&shape.links[nodes]);
            tasks.with_min_len(NODES_PER_TASK).for_each(|(boxes, links)| {
                dispatch!(level.level(), simd => {
                    for (lane, child) in links.children().enumerate() {
                        boxes.set(lane, &match child {
                            Child::Leaf(leaf_idx) => leaf_bounds[leaf_idx],
                            Child::Node(node_idx) => below[node_idx].around(simd),
                        });
                    }
                });
                boxes.pad(links.count);
            });
        }
        if let Some(root) = boxes.last() {
            self.bounds = dispatch!(level.level(), simd => root.around(simd));
        }
    }

    /// Bytes held.
    fn memory_usage(&self) -> usize {
        self.shape.memory_usage()
            + self.leaf_bounds.capacity() * size_of::<BoxBounds>()
            + self.boxes.capacity() * size_of::<BoxBlock>()
    }
}

impl Tree {
    /// Both halves.
    pub(super) const fn halves(&self) -> [(Kind, &Nodes); 2] {
        [(Kind::Triangles, &self.triangles), (Kind::Others, &self.others)]
    }

    /// Number of leaves of any kind.
    pub(super) fn leaf_count(&self) -> usize {
        self.triangle_leaves.len() + self.other_leaves.len()
    }

    /// The box around everything, where there is anything.
    pub(super) fn bounds(&self) -> Option<BoxBounds> {
        let halves = self.halves().into_iter().filter(|(_, nodes)| !nodes.is_empty());
        halves.map(|(_, nodes)| nodes.bounds).reduce(|bounds, other| bounds.union(&other))
    }

    /// Asks for a child of a half that will be visited soon, so that it is in the cache by then.
    #[inline(always)]
    pub(super) fn ask_for(&self, (kind, nodes): (Kind, &Nodes), child: Child) {
        match (child, kind) {
            (Child::Node(node_idx), _) => prefetch(&nodes.boxes[node_idx]),
            (Child::Leaf(leaf_idx), Kind::Triangles) => prefetch(&self.triangle_leaves[leaf_idx]),
            (Child::Leaf(leaf_idx), Kind::Others) => prefetch(&self.other_leaves[leaf_idx]),
        }
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.triangle_leaves.capacity() * size_of::<TriangleLeaf>()
            + self.other_leaves.capacity() * size_of::<OtherLeaf>()
            + self.triangles.memory_usage()
            + self.others.memory_usage()
            + self.order.memory_usage()
    }
}
