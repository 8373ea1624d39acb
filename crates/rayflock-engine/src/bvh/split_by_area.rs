//! Finds the shape of a tree for primitives that many rays will ask about: worth more time than a
//! curve takes.
//!
//! ```text
//!   split       cuts primitives in two, each part again, down to leaves    (cut, cheapest_cut)
//!   Costs       on the way back: what it costs to have a part as one child of a node, as two ...
//!   push_node   from the root: each node gets the children that cost least
//!   write_shape nodes by height, leaves in the order of their primitives
//! ```
//!
//! **Source.** I. Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", IRT 2007
//! (bins); H. Ylitie, T. Karras, S. Laine, "Efficient Incoherent Ray Traversal on GPUs Through
//! Compressed Wide BVHs", HPG 2017 (the cheapest wide nodes of a binary tree); the costs are those
//! of J. Goldsmith, J. Salmon, "Automatic Creation of Object Hierarchies for Ray Tracing", 1987.
//!
//! **Departures.** A leaf costs the same with one primitive as with sixteen, for these are tested
//! at once. So cuts count leaves, not primitives, and what fits into one leaf is one.

use glam::{UVec3, Vec3A};
use rayflock_geom::simd::LANES;
use rayon::prelude::*;
use tracing::debug_span;

use super::tree_shape::{Child, Links, TreeShape};
use crate::primitives::PrimitiveTable;

/// The most bins an axis.
const BINS: usize = 32;

/// Primitives that are worth a task of their own.
const PRIMS_PER_TASK: usize = 4096;

/// What a node costs, where a leaf costs 1.
const NODE_COST: f32 = 1.0;

/// From this depth on, parts are cut in halves: nothing of use is as uneven.
const DEEPEST: usize = 64;

/// A primitive and the box around it.
#[derive(Clone, Copy, Debug)]
struct Boxed {
    bounds: Bounds,
    slot: u32,
}

/// A box by its corners.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    min: Vec3A,
    max: Vec3A,
}

/// Primitives that are a leaf, or are cut in two: a part comes right before the two that it is cut
/// into, and a part of `n` primitives has room for `2 n - 1` parts, itself included.
#[derive(Clone, Copy, Debug)]
struct Part {
    /// Primitives of the first of both, none if this is a leaf.
    left_len: u32,
    /// How many children the first of both gives where this one gives one (and is a node of
    /// sixteen), two, three ... to a node; none where one child fewer costs no more, or, for one
    /// child, where it is a leaf.
    left_children: [u8; LANES],
}

/// What a part costs as one child of a node, as up to two, three ...
type Costs = [f32; LANES];

/// A part, where it lies and which primitives it has.
#[derive(Clone, Copy, Debug)]
struct PartRef {
    part_idx: usize,
    first: usize,
    end: usize,
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

/// Finds shapes, keeping its memory.
#[derive(Debug, Default)]
pub(super) struct AreaSplitter {
    prims: Vec<Boxed>,
    parts: Vec<Part>,
    /// Each before its children.
    nodes: Vec<SplitNode>,
    /// For each primitive that is the first of a leaf, that leaf.
    leaves: Vec<u32>,
}

impl AreaSplitter {
    /// Brings the triangles in `slots`, at least one, into an order, and gives `shape` leaves and
    /// nodes over it.
    pub(super) fn split(
        &mut self,
        table: &PrimitiveTable,
        slots: &mut [u32],
        shape: &mut TreeShape,
    ) {
        let _span = debug_span!("split_by_area").entered();
        self.prims.resize(slots.len(), Boxed::EMPTY);
        let prims = self.prims.par_iter_mut().zip(&*slots).with_min_len(PRIMS_PER_TASK);
        prims.for_each(|(prim, &slot)| *prim = Boxed::new(table, slot));
        self.split_prims(shape);
        for (slot, prim) in slots.iter_mut().zip(&self.prims) {
            *slot = prim.slot;
        }
    }

    /// Brings the primitives into an order, and finds the shape of a tree over it.
    fn split_prims(&mut self, shape: &mut TreeShape) {
        let Self { prims, parts, nodes, leaves } = self;
        parts.resize(2 * prims.len() - 1, Part::LEAF);
        let bounds = measure(prims, |prim| prim.bounds);
        split(prims, bounds, parts, 0);
        nodes.clear();
        leaves.clear();
        leaves.resize(prims.len(), u32::MAX);
        self.push_node(PartRef { part_idx: 0, first: 0, end: self.prims.len() });
        self.write_shape(shape);
    }

    /// Adds the node that a part is, and those below it; returns its position.
    fn push_node(&mut self, part: PartRef) -> usize {
        let node_idx = self.nodes.len();
        self.nodes.push(SplitNode::EMPTY);
        match self.parts[part.part_idx].left_children[0] {
            // The root may be a leaf, but has a node all the same.
            0 => self.add_child(node_idx, part),
            left => {
                let [left_part, right_part] = part.cut(&self.parts);
                self.add_children(node_idx, left_part, left.into());
                self.add_children(node_idx, right_part, LANES - usize::from(left));
            }
        }
        node_idx
    }

    /// Gives a node up to so many children of a part.
    fn add_children(&mut self, node_idx: usize, part: PartRef, most: usize) {
        let left_children = &self.parts[part.part_idx].left_children;
        let chosen = (1..most).rev().find(|&idx| left_children[idx] > 0);
        match chosen.map(|idx| (idx + 1, usize::from(left_children[idx]))) {
            None => self.add_child(node_idx, part),
            Some((count, left)) => {
                let [left_part, right_part] = part.cut(&self.parts);
                self.add_children(node_idx, left_part, left);
                self.add_children(node_idx, right_part, count - left);
            }
        }
    }

    /// Gives a node a part as a child.
    fn add_child(&mut self, node_idx: usize, part: PartRef) {
        let is_leaf = self.parts[part.part_idx].left_children[0] == 0;
        let (child, height) = if is_leaf {
            self.leaves[part.first] = 0;
            (SplitChild::Leaf(part.first), 0)
        } else {
            let child_idx = self.push_node(part);
            (SplitChild::Node(child_idx), self.nodes[child_idx].height + 1)
        };
        let node = &mut self.nodes[node_idx];
        node.children[node.count] = child;
        node.count += 1;
        node.height = node.height.max(height);
    }

    /// Writes the nodes that were found, those of lower levels first.
    fn write_shape(&mut self, shape: &mut TreeShape) {
        let Self { prims, nodes, leaves, .. } = self;
        shape.clear();
        let firsts = leaves.iter_mut().enumerate().filter(|(_, leaf)| **leaf == 0);
        for (leaf_idx, (first, leaf)) in firsts.enumerate() {
            *leaf = leaf_idx as u32;
            shape.push_leaf(first);
        }
        shape.end_leaves(prims.len());
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
        self.prims.capacity() * size_of::<Boxed>()
            + self.parts.capacity() * size_of::<Part>()
            + self.nodes.capacity() * size_of::<SplitNode>()
            + self.leaves.capacity() * size_of::<u32>()
    }
}

impl Boxed {
    const EMPTY: Self = Self { bounds: Bounds { min: Vec3A::ZERO, max: Vec3A::ZERO }, slot: 0 };

    /// The triangle in a slot; one that is not finite is somewhere.
    fn new(table: &PrimitiveTable, slot: u32) -> Self {
        let (corners, _) = table.read_triangle(slot);
        let is_finite = corners.iter().all(|corner| corner.is_finite());
        if !is_finite {
            return Self { slot, ..Self::EMPTY };
        }
        let [a, b, c] = corners.map(Vec3A::from);
        Self { bounds: Bounds { min: a.min(b).min(c), max: a.max(b).max(c) }, slot }
    }
}

impl Bounds {
    /// Around nothing.
    const NONE: Self = Self { min: Vec3A::INFINITY, max: Vec3A::NEG_INFINITY };

    fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    fn middle(self) -> Vec3A {
        0.5 * self.min + 0.5 * self.max
    }

    fn half_area(self) -> f32 {
        let size = self.max - self.min;
        size.x * size.y + size.y * size.z + size.z * size.x
    }
}

impl Part {
    const LEAF: Self = Self { left_len: 0, left_children: [0; LANES] };

    /// How two parts together cost least, and what that is; `area` is the surface around both.
    fn join(&mut self, area: f32, left: &Costs, right: &Costs) -> Costs {
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
        let (left_idx, middle) = (self.part_idx + 1, self.first + left_len);
        [
            Self { part_idx: left_idx, first: self.first, end: middle },
            Self { part_idx: left_idx + 2 * left_len - 1, first: middle, end: self.end },
        ]
    }
}

impl SplitNode {
    const EMPTY: Self =
        Self { children: [SplitChild::Leaf(0); LANES], count: 0, height: 0, place: 0 };
}

/// Brings primitives, around which `bounds` lies, into an order in which parts are runs. Tells what
/// they cost.
fn split(prims: &mut [Boxed], bounds: Bounds, parts: &mut [Part], depth: usize) -> Costs {
    let area = bounds.half_area();
    let (part, parts) = parts.split_first_mut().expect("there is room for each cut and each leaf");
    *part = Part::LEAF;
    if prims.len() <= LANES {
        return [area; LANES];
    }
    let (left_len, [left, right]) = cut(prims, depth);
    part.left_len = left_len as u32;
    let is_one_task = left_len.min(prims.len() - left_len) < PRIMS_PER_TASK;
    let prims = prims.split_at_mut(left_len);
    let parts = parts.split_at_mut(2 * left_len - 1);
    let mut split_left = || split(prims.0, left, parts.0, depth + 1);
    let mut split_right = || split(prims.1, right, parts.1, depth + 1);
    let (left, right) = if is_one_task {
        (split_left(), split_right())
    } else {
        rayon::join(split_left, split_right)
    };
    part.join(area, &left, &right)
}

/// Brings primitives into two parts; tells how many are in the first, and the boxes around both.
fn cut(prims: &mut [Boxed], depth: usize) -> (usize, [Bounds; 2]) {
    let middles = measure(prims, |prim| {
        let middle = prim.bounds.middle();
        Bounds { min: middle, max: middle }
    });
    let grid = Grid::over(middles, prims.len());
    if depth < DEEPEST
        && let Some(cut) = Bins::of(prims, &grid).cheapest_cut(grid.bin_count)
    {
        let len = partition(prims, |prim| grid.bins(prim)[cut.axis] < cut.bin);
        return (len, cut.bounds);
    }
    let len = prims.len() / 2;
    let (left, right) = prims.split_at(len);
    (len, [left, right].map(|prims| measure(prims, |prim| prim.bounds)))
}

/// The box around what `of` makes of primitives.
fn measure(prims: &[Boxed], of: impl Fn(&Boxed) -> Bounds + Copy + Sync) -> Bounds {
    if prims.len() <= PRIMS_PER_TASK {
        return prims.iter().map(of).fold(Bounds::NONE, Bounds::union);
    }
    let (left, right) = prims.split_at(prims.len() / 2);
    let (left, right) = rayon::join(|| measure(left, of), || measure(right, of));
    left.union(right)
}

/// Moves primitives for which `is_first` holds before the others; returns their number.
fn partition(prims: &mut [Boxed], is_first: impl Fn(&Boxed) -> bool) -> usize {
    let (mut first, mut end) = (0, prims.len());
    while first < end {
        if is_first(&prims[first]) {
            first += 1;
        } else {
            end -= 1;
            prims.swap(first, end);
        }
    }
    first
}

/// Where bins are: in each axis as wide as each other.
#[derive(Clone, Copy, Debug)]
struct Grid {
    /// Bins an axis.
    bin_count: usize,
    min: Vec3A,
    bins_per_length: Vec3A,
}

impl Grid {
    /// Bins over a box; one bin alone along an axis in which it has no size, or more than there
    /// are numbers for.
    fn over(bounds: Bounds, prim_count: usize) -> Self {
        let bin_count = (prim_count / 4).next_power_of_two().clamp(8, BINS);
        let bins_per_length = bin_count as f32 / (bounds.max - bounds.min);
        let is_finite = bins_per_length.is_finite_mask();
        let bins_per_length = Vec3A::select(is_finite, bins_per_length, Vec3A::ZERO);
        Self { bin_count, min: bounds.min, bins_per_length }
    }

    /// The bin of a primitive along each axis.
    fn bins(&self, prim: &Boxed) -> [usize; 3] {
        let bins = (prim.bounds.middle() - self.min) * self.bins_per_length;
        bins.as_uvec3()
            .min(UVec3::splat(self.bin_count as u32 - 1))
            .to_array()
            .map(|bin| bin as usize)
    }
}

/// What lies in the bins of each axis.
struct Bins {
    bounds: [[Bounds; BINS]; 3],
    counts: [[usize; BINS]; 3],
}

/// A cut across an axis, before a bin.
#[derive(Clone, Copy, Debug)]
struct Cut {
    axis: usize,
    bin: usize,
    /// Around what is before it and behind.
    bounds: [Bounds; 2],
}

impl Bins {
    const EMPTY: Self = Self { bounds: [[Bounds::NONE; BINS]; 3], counts: [[0; BINS]; 3] };

    fn of(prims: &[Boxed], grid: &Grid) -> Self {
        let mut bins = Self::EMPTY;
        if prims.len() <= PRIMS_PER_TASK {
            for prim in prims {
                for (axis, bin) in grid.bins(prim).into_iter().enumerate() {
                    bins.bounds[axis][bin] = bins.bounds[axis][bin].union(prim.bounds);
                    bins.counts[axis][bin] += 1;
                }
            }
            return bins;
        }
        let (left, right) = prims.split_at(prims.len() / 2);
        let (left, right) = rayon::join(|| Self::of(left, grid), || Self::of(right, grid));
        for axis in 0..3 {
            for bin in 0..BINS {
                let bounds = left.bounds[axis][bin].union(right.bounds[axis][bin]);
                bins.bounds[axis][bin] = bounds;
                bins.counts[axis][bin] = left.counts[axis][bin] + right.counts[axis][bin];
            }
        }
        bins
    }

    /// The cut after which both parts have the least surface for their leaves.
    fn cheapest_cut(&self, bin_count: usize) -> Option<Cut> {
        let mut best = (f32::INFINITY, None);
        for axis in 0..3 {
            let (bounds, counts) = (&self.bounds[axis], &self.counts[axis]);
            let mut behind = [(Bounds::NONE, 0); BINS];
            let mut sum = (Bounds::NONE, 0);
            for bin in (0..bin_count).rev() {
                sum = (sum.0.union(bounds[bin]), sum.1 + counts[bin]);
                behind[bin] = sum;
            }
            let mut before = (Bounds::NONE, 0);
            for bin in 1..bin_count {
                before = (before.0.union(bounds[bin - 1]), before.1 + counts[bin - 1]);
                if before.1 == 0 || behind[bin].1 == 0 {
                    continue;
                }
                let cost = cost(before) + cost(behind[bin]);
                if cost < best.0 {
                    best = (cost, Some(Cut { axis, bin, bounds: [before.0, behind[bin].0] }));
                }
            }
        }
        best.1
    }
}

/// What a box with so many primitives costs: its surface for each leaf.
fn cost((bounds, count): (Bounds, usize)) -> f32 {
    bounds.half_area() * count.div_ceil(LANES) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn boxed(slot: u32, min: Vec3A, size: f32) -> Boxed {
        Boxed { bounds: Bounds { min, max: min + size }, slot }
    }

    /// The shape of a tree over `prims`, and in which order they are then.
    fn split(prims: Vec<Boxed>) -> (TreeShape, Vec<u32>) {
        let mut splitter = AreaSplitter { prims, ..AreaSplitter::default() };
        let mut shape = TreeShape::default();
        splitter.split_prims(&mut shape);
        (shape, splitter.prims.iter().map(|prim| prim.slot).collect())
    }

    /// Checks that each leaf hangs in one place, has up to sixteen primitives, and that all nodes
    /// come after what hangs from them.
    fn check_shape(shape: &TreeShape, prim_count: usize) {
        let mut has_parent = (vec![false; shape.links.len()], vec![false; shape.leaf_count()]);
        for (idx, links) in shape.links.iter().enumerate() {
            for child in links.children() {
                let had_parent = match child {
                    Child::Node(child) => {
                        assert!(child < idx, "node {child} below {idx}");
                        std::mem::replace(&mut has_parent.0[child], true)
                    }
                    Child::Leaf(leaf) => std::mem::replace(&mut has_parent.1[leaf], true),
                };
                assert!(!had_parent, "{child:?} hangs in two places");
            }
        }
        assert_eq!(has_parent.0.iter().filter(|&&has_parent| !has_parent).count(), 1);
        assert!(has_parent.1.iter().all(|&has_parent| has_parent));
        let lens: Vec<_> = (0..shape.leaf_count()).map(|leaf| shape.leaf(leaf).len()).collect();
        assert!(lens.iter().all(|len| (1..=LANES).contains(len)), "{lens:?}");
        assert_eq!(lens.iter().sum::<usize>(), prim_count);
    }

    /// Four clusters of sixteen in disorder: each becomes a leaf.
    #[test]
    fn clusters_become_leaves() {
        let prims = (0..64).map(|idx| {
            let slot = idx * 37 % 64;
            let cluster = slot / 16;
            let corner = Vec3A::new((cluster % 2) as f32, (cluster / 2) as f32, 0.0) * 10.0;
            boxed(slot, corner + (slot % 16) as f32 * 0.01, 1.0)
        });
        let (shape, slots) = split(prims.collect());
        check_shape(&shape, 64);
        for leaf in 0..shape.leaf_count() {
            let slots = &slots[shape.leaf(leaf)];
            assert!(slots.iter().all(|slot| slot / 16 == slots[0] / 16), "{slots:?}");
        }
    }

    #[test]
    fn any_number_of_primitives_has_a_tree() {
        for count in [1_u32, 2, 15, 16, 17, 31, 32, 33, 255, 256, 257, 300, 1000, 20_000] {
            let prims = (0..count).map(|slot| {
                let place = |factor: u32| (slot.wrapping_mul(factor) >> 8) as f32 * 1e-6;
                let min = Vec3A::new(place(2_654_435_761), place(40_503_001), place(97_001));
                boxed(slot, min, 0.1)
            });
            let (shape, mut slots) = split(prims.collect());
            check_shape(&shape, count as usize);
            slots.sort_unstable();
            assert!(slots.into_iter().eq(0..count), "{count} primitives");
        }
    }

    /// Primitives in one place, at places ever farther apart, and too far for areas to be finite.
    #[test]
    fn uneven_primitives_have_a_tree() {
        let places: [fn(u32) -> f32; 3] =
            [|_| 1.0, |slot| 1.05_f32.powi(slot as i32 - 1000), |slot| slot as f32 * 3e34];
        for (idx, place) in places.iter().enumerate() {
            let prims = (0..2000).map(|slot| boxed(slot, Vec3A::splat(place(slot)), 0.5));
            let (shape, _) = split(prims.collect());
            check_shape(&shape, 2000);
            assert!(shape.levels().count() < 40, "kind {idx}: {} levels", shape.levels().count());
        }
    }
}
