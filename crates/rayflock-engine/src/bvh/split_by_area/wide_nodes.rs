//! Which parts of a binary tree become nodes of sixteen: those that cost least.
//!
//! On the way up, a part learns what it costs as one child of a node, and as up to two, three ...
//! children: it is a leaf or a node then, or gives its place to both that it is cut into. On the
//! way down, that is looked up.

use rayflock_geom::simd::LANES;

use crate::bvh::tree_shape::{Child, Links, TreeShape};

/// What a node costs, where a leaf costs 1. With 0.6, 1, 2 and 4, museum7 took 40.3, 40.3, 41.3 and
/// 41.3 ms a picture, 16K x 1M diffuse 62.5, 63.0, 61.9 and 61.8 (two AVX-512 server cores).
const NODE_COST: f32 = 1.0;

/// Primitives that are a leaf, or are cut in two: right behind a part comes the first of both and
/// all within it, then the second. A part of `n` primitives has room for `2 n - 1`, itself
/// included.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part {
    /// Primitives of the first of both, none if this is a leaf.
    pub(super) left_len: u32,
    /// How many children the first of both gives where this one gives one (and is a node of
    /// sixteen), two, three ... to a node; none where one child fewer costs no more, or, for one
    /// child, where it is a leaf.
    left_children: [u8; LANES],
}

/// What a part costs as one child of a node, as up to two, three ...
pub(super) type Costs = [f32; LANES];

/// A part, where it lies and its first primitive.
#[derive(Clone, Copy, Debug)]
struct PartRef {
    part_idx: usize,
    first: usize,
}

/// A node to be.
#[derive(Clone, Copy, Debug)]
struct SplitNode {
    children: [SplitChild; LANES],
    count: usize,
    /// Levels below.
    height: u32,
    /// Its place in the shape.
    place: usize,
}

#[derive(Clone, Copy, Debug)]
enum SplitChild {
    /// By its first primitive.
    Leaf(usize),
    Node(usize),
}

/// The nodes of a tree, chosen from parts; memory is kept.
#[derive(Debug, Default)]
pub(super) struct WideNodes {
    /// Each before its children.
    nodes: Vec<SplitNode>,
    /// For each primitive that is the first of a leaf, that leaf.
    leaves: Vec<u32>,
}

impl WideNodes {
    /// Chooses the nodes over the first of `parts`, which has so many primitives.
    pub(super) fn choose(&mut self, parts: &[Part], prim_count: usize) {
        self.nodes.clear();
        self.leaves.clear();
        self.leaves.resize(prim_count, u32::MAX);
        self.push_node(parts, PartRef { part_idx: 0, first: 0 });
    }

    /// Adds the node that a part is, and those below it; returns its position.
    fn push_node(&mut self, parts: &[Part], part: PartRef) -> usize {
        let node_idx = self.nodes.len();
        self.nodes.push(SplitNode::EMPTY);
        match parts[part.part_idx].left_children[0] {
            // The root may be a leaf, but has a node all the same.
            0 => self.add_child(parts, node_idx, part),
            left => {
                let [left_part, right_part] = part.cut(parts);
                self.add_children(parts, node_idx, left_part, left.into());
                self.add_children(parts, node_idx, right_part, LANES - usize::from(left));
            }
        }
        node_idx
    }

    /// Gives a node up to so many children of a part.
    fn add_children(&mut self, parts: &[Part], node_idx: usize, part: PartRef, most: usize) {
        let left_children = &parts[part.part_idx].left_children;
        let chosen = (1..most).rev().find(|&idx| left_children[idx] > 0);
        match chosen.map(|idx| (idx + 1, usize::from(left_children[idx]))) {
            None => self.add_child(parts, node_idx, part),
            Some((count, left)) => {
                let [left_part, right_part] = part.cut(parts);
                self.add_children(parts, node_idx, left_part, left);
                self.add_children(parts, node_idx, right_part, count - left);
            }
        }
    }

    /// Gives a node a part as a child.
    fn add_child(&mut self, parts: &[Part], node_idx: usize, part: PartRef) {
        let is_leaf = parts[part.part_idx].left_children[0] == 0;
        let (child, height) = if is_leaf {
            self.leaves[part.first] = 0;
            (SplitChild::Leaf(part.first), 0)
        } else {
            let child_idx = self.push_node(parts, part);
            (SplitChild::Node(child_idx), self.nodes[child_idx].height + 1)
        };
        let node = &mut self.nodes[node_idx];
        node.children[node.count] = child;
        node.count += 1;
        node.height = node.height.max(height);
    }

    /// Writes the nodes that were chosen, those of lower levels first.
    pub(super) fn write(&mut self, shape: &mut TreeShape) {
        let Self { nodes, leaves } = self;
        shape.clear();
        let firsts = leaves.iter_mut().enumerate().filter(|(_, leaf)| **leaf == 0);
        for (leaf_idx, (first, leaf)) in firsts.enumerate() {
            *leaf = leaf_idx as u32;
            shape.push_leaf(first);
        }
        shape.end_leaves(leaves.len());
        for height in 0..=nodes[0].height {
            for node_idx in 0..nodes.len() {
                if nodes[node_idx].height != height {
                    continue;
                }
                let mut links = Links::NONE;
                let node = &nodes[node_idx];
                for &child in &node.children[..node.count] {
                    links.push(match child {
                        SplitChild::Leaf(first) => Child::Leaf(leaves[first] as usize),
                        SplitChild::Node(child_idx) => Child::Node(nodes[child_idx].place),
                    });
                }
                nodes[node_idx].place = shape.push_node(links);
            }
            shape.end_level();
        }
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.nodes.capacity() * size_of::<SplitNode>() + self.leaves.capacity() * size_of::<u32>()
    }
}

impl Part {
    pub(super) const LEAF: Self = Self { left_len: 0, left_children: [0; LANES] };

    /// How two parts together cost least, and what that is; `area` is the surface around both.
    pub(super) fn join(&mut self, area: f32, left: &Costs, right: &Costs) -> Costs {
        let mut costs = [0.0; LANES];
        // As one child, it is a node with as many children as there can be.
        let (cost, left_children) = cheapest_shares(LANES, left, right);
        (costs[0], self.left_children[0]) = (NODE_COST * area + cost, left_children);
        for count in 2..=LANES {
            let (cost, left_children) = cheapest_shares(count, left, right);
            costs[count - 1] = costs[count - 2];
            if cost < costs[count - 1] {
                (costs[count - 1], self.left_children[count - 1]) = (cost, left_children);
            }
        }
        costs
    }
}

/// What `count` children cost at least, and how many of them the left one of two parts gives then.
fn cheapest_shares(count: usize, left: &Costs, right: &Costs) -> (f32, u8) {
    let mut best = (f32::INFINITY, 1);
    for left_count in 1..count {
        let cost = left[left_count - 1] + right[count - left_count - 1];
        if cost < best.0 {
            best = (cost, left_count as u8);
        }
    }
    best
}

impl PartRef {
    /// Both that it is cut into.
    fn cut(self, parts: &[Part]) -> [Self; 2] {
        let left_len = parts[self.part_idx].left_len as usize;
        let left_idx = self.part_idx + 1;
        [
            Self { part_idx: left_idx, first: self.first },
            Self { part_idx: left_idx + 2 * left_len - 1, first: self.first + left_len },
        ]
    }
}

impl SplitNode {
    const EMPTY: Self =
        Self { children: [SplitChild::Leaf(0); LANES], count: 0, height: 0, place: 0 };
}
