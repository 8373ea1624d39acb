//! Finds the shape of a tree for primitives that many rays will ask about: worth more time than a
//! curve takes.
//!
//! ```text
//!   split       cuts primitives in two, each part again, down to leaves           (cut_in_two)
//!   join        on the way back: what a part costs as one child of a node, as two ...
//!   choose      from the root: each node gets the children that cost least        (wide_nodes)
//!   write       nodes by height, leaves in the order of their primitives
//! ```
//!
//! **Source.** I. Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", IRT 2007
//! (bins); H. Ylitie, T. Karras, S. Laine, "Efficient Incoherent Ray Traversal on GPUs Through
//! Compressed Wide BVHs", HPG 2017 (the cheapest wide nodes of a binary tree); the costs are those
//! of J. Goldsmith, J. Salmon, "Automatic Creation of Object Hierarchies for Ray Tracing", 1987.
//!
//! **Departures.** A leaf costs the same with one primitive as with sixteen, for these are tested
//! at once. So cuts count leaves, not primitives, and what fits into one leaf is one.
//!
//! **Invariants.** Each primitive is in one leaf, of 1 to 16; each leaf and each node but the root
//! hangs in one place, and nodes come after what hangs from them.
//!
//! **Cost.** 130 ns a primitive on two AVX-512 server cores; some 95 bytes a primitive, kept.

mod cut_in_two;
mod wide_nodes;

#[cfg(test)]
mod tests;

use rayflock_geom::simd::LANES;
use rayon::prelude::*;
use tracing::debug_span;

use self::cut_in_two::{Bounds, Boxed, cut, measure};
use self::wide_nodes::{Costs, Part, WideNodes};
use super::tree_shape::TreeShape;
use crate::primitives::PrimitiveTable;

/// Primitives that are worth a task of their own.
const PRIMS_PER_TASK: usize = 1024;

/// Finds shapes, keeping its memory.
#[derive(Debug, Default)]
pub(super) struct AreaSplitter {
    prims: Vec<Boxed>,
    parts: Vec<Part>,
    nodes: WideNodes,
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
        let Self { prims, parts, nodes } = self;
        parts.resize(2 * prims.len() - 1, Part::LEAF);
        let bounds = measure(prims, |prim| prim.bounds);
        split(prims, bounds, parts, 0);
        nodes.choose(parts, prims.len());
        nodes.write(shape);
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.prims.capacity() * size_of::<Boxed>()
            + self.parts.capacity() * size_of::<Part>()
            + self.nodes.memory_usage()
    }
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
