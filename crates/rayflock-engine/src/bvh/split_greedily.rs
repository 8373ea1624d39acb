//! Orders primitives that stay for many frames: worth more time than a curve takes.
//!
//! The tree over an order is given: runs of sixteen are leaves, sixteen leaves a node, and so on.
//! So all that is to be chosen is where what lies. From the top, primitives are cut in two between
//! runs that fill a child, along the axis and at the place where both parts have the least surface
//! for their primitives, until each part is one child; then children are cut likewise.
//!
//! **Source.** Y. Garcia, M. Lopez, S. Leutenegger, "A Greedy Algorithm for Bulk Loading R-trees",
//! GIS 1998; the costs are those of J. Goldsmith, J. Salmon, "Automatic Creation of Object
//! Hierarchies for Ray Tracing", 1987.
//!
//! **Cost.** Three or four sorts for each halving; on one thread, about half a microsecond a
//! primitive.

use std::ops::Range;

use glam::Vec3;
use rayflock_geom::simd::LANES;
use tracing::debug_span;

use crate::primitives::PrimitiveTable;

/// Primitives that are worth a task of their own.
const PRIMS_PER_TASK: usize = 2048;

/// A primitive and the box around it.
#[derive(Clone, Copy, Debug)]
struct Boxed {
    min: Vec3,
    max: Vec3,
    slot: u32,
}

impl Boxed {
    /// The triangle in a slot; one that is not finite is somewhere.
    fn new(table: &PrimitiveTable, slot: u32) -> Self {
        let (corners, _) = table.read_triangle(slot);
        let is_finite = corners.iter().all(|corner| corner.is_finite());
        let [a, b, c] = if is_finite { corners } else { [Vec3::ZERO; 3] };
        Self { min: a.min(b).min(c), max: a.max(b).max(c), slot }
    }
}

/// Orders primitives, keeping its memory.
#[derive(Debug, Default)]
pub(super) struct GreedySplitter {
    prims: Vec<Boxed>,
    spare: Vec<Boxed>,
    keyed: Vec<u64>,
}

impl GreedySplitter {
    /// Brings the triangles in `slots` into the order of a good tree.
    pub(super) fn order<'a>(
        &'a mut self,
        table: &PrimitiveTable,
        slots: &[u32],
    ) -> impl Iterator<Item = u32> + 'a {
        let _span = debug_span!("split_greedily").entered();
        self.prims.clear();
        self.prims.extend(slots.iter().map(|&slot| Boxed::new(table, slot)));
        self.spare.clone_from(&self.prims);
        self.keyed.resize(slots.len(), 0);
        let mut capacity = LANES;
        while capacity < slots.len() {
            capacity *= LANES;
        }
        split(
            Part { prims: &mut self.prims, spare: &mut self.spare, keyed: &mut self.keyed },
            capacity,
        );
        self.prims.iter().map(|prim| prim.slot)
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        (self.prims.capacity() + self.spare.capacity()) * size_of::<Boxed>()
            + 8 * self.keyed.capacity()
    }
}

/// Neighbours of the order, and memory for as many.
struct Part<'a> {
    prims: &'a mut [Boxed],
    spare: &'a mut [Boxed],
    /// Places along an axis, and which of `prims` is there.
    keyed: &'a mut [u64],
}

/// Brings primitives into an order in which runs of `capacity` and of less make good nodes.
fn split(mut part: Part<'_>, mut capacity: usize) {
    while part.prims.len() <= capacity {
        if capacity == LANES {
            return;
        }
        capacity /= LANES;
    }
    let mut best = (f32::INFINITY, 0, capacity);
    for axis in 0..3 {
        part.sort(axis);
        let (cost, middle) = part.cheapest_cut(capacity);
        if cost < best.0 {
            best = (cost, axis, middle);
        }
    }
    let (_, axis, middle) = best;
    if axis != 2 {
        part.sort(axis);
    }
    part.reorder();
    let (left, right) = part.split_at(middle);
    if left.prims.len().min(right.prims.len()) < PRIMS_PER_TASK {
        split(left, capacity);
        split(right, capacity);
    } else {
        rayon::join(|| split(left, capacity), || split(right, capacity));
    }
}

impl<'a> Part<'a> {
    /// Sorts `keyed` along an axis.
    fn sort(&mut self, axis: usize) {
        for (idx, (keyed, prim)) in self.keyed.iter_mut().zip(&*self.prims).enumerate() {
            *keyed = u64::from(ordered_bits(prim.min[axis] + prim.max[axis])) << 32 | idx as u64;
        }
        self.keyed.sort_unstable();
    }

    /// The primitive at a place of the sorted order.
    fn sorted(&self, place: usize) -> &Boxed {
        &self.prims[self.keyed[place] as u32 as usize]
    }

    /// Brings the primitives into the sorted order.
    fn reorder(&mut self) {
        for (place, keyed) in self.spare.iter_mut().zip(&*self.keyed) {
            *place = self.prims[*keyed as u32 as usize];
        }
        self.prims.copy_from_slice(self.spare);
    }

    fn split_at(self, middle: usize) -> (Self, Self) {
        let (prims, right_prims) = self.prims.split_at_mut(middle);
        let (spare, right_spare) = self.spare.split_at_mut(middle);
        let (keyed, right_keyed) = self.keyed.split_at_mut(middle);
        let right = Part { prims: right_prims, spare: right_spare, keyed: right_keyed };
        (Part { prims, spare, keyed }, right)
    }

    /// The best place to cut between runs of `capacity`, and what it costs.
    fn cheapest_cut(&self, capacity: usize) -> (f32, usize) {
        let len = self.prims.len();
        let run_count = len.div_ceil(capacity);
        let mut behind = [0.0; LANES];
        let mut bounds = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for run_idx in (1..run_count).rev() {
            let run = run_idx * capacity..len.min((run_idx + 1) * capacity);
            bounds = self.around(run, bounds);
            behind[run_idx] = half_area(bounds) * (len - run_idx * capacity) as f32;
        }
        let mut best = (f32::INFINITY, capacity);
        let mut bounds = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for (run_idx, &behind) in behind.iter().enumerate().take(run_count).skip(1) {
            let middle = run_idx * capacity;
            bounds = self.around(middle - capacity..middle, bounds);
            let cost = half_area(bounds) * middle as f32 + behind;
            if cost < best.0 {
                best = (cost, middle);
            }
        }
        best
    }

    fn around(&self, places: Range<usize>, bounds: (Vec3, Vec3)) -> (Vec3, Vec3) {
        places.fold(bounds, |(min, max), place| {
            let prim = self.sorted(place);
            (min.min(prim.min), max.max(prim.max))
        })
    }
}

/// Bits that are ordered as the numbers are.
fn ordered_bits(value: f32) -> u32 {
    let bits = value.to_bits();
    if bits >> 31 == 1 { !bits } else { bits | 1 << 31 }
}

fn half_area((min, max): (Vec3, Vec3)) -> f32 {
    let size = max - min;
    size.x * size.y + size.y * size.z + size.z * size.x
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four clusters of sixteen in disorder: each becomes a leaf.
    #[test]
    fn clusters_become_leaves() {
        let slots: Vec<u32> = (0..64).map(|idx| idx * 37 % 64).collect();
        let boxed = |slot: u32| {
            let cluster = slot / 16;
            let corner = Vec3::new((cluster % 2) as f32, (cluster / 2) as f32, 0.0) * 10.0;
            let min = corner + Vec3::splat((slot % 16) as f32 * 0.01);
            Boxed { min, max: min + 0.01, slot }
        };
        let mut prims: Vec<_> = slots.iter().map(|&slot| boxed(slot)).collect();
        let (mut spare, mut keyed) = (prims.clone(), vec![0; prims.len()]);
        split(Part { prims: &mut prims, spare: &mut spare, keyed: &mut keyed }, 256);
        for leaf in prims.chunks(LANES) {
            assert!(leaf.iter().all(|prim| prim.slot / 16 == leaf[0].slot / 16), "{leaf:?}");
        }
        let mut found: Vec<_> = prims.iter().map(|prim| prim.slot).collect();
        found.sort_unstable();
        assert!(found.into_iter().eq(0..64));
    }
}
