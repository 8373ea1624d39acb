//! Cuts primitives in two where that is cheapest: between bins along an axis, or, where these tell
//! nothing or depth has no end, in halves.

use glam::{UVec3, Vec3A};
use rayflock_geom::simd::LANES;

use super::PRIMS_PER_TASK;
use crate::primitives::PrimitiveTable;

/// The most bins an axis.
const BINS: usize = 32;

/// From this depth on, primitives are cut in halves: nothing of use is as uneven.
const DEEPEST: usize = 64;

/// A primitive and the box around it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Boxed {
    pub(super) bounds: Bounds,
    pub(super) slot: u32,
}

/// A box by its corners.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) min: Vec3A,
    pub(super) max: Vec3A,
}

impl Boxed {
    pub(super) const EMPTY: Self =
        Self { bounds: Bounds { min: Vec3A::ZERO, max: Vec3A::ZERO }, slot: 0 };

    /// The triangle in a slot; one that is not finite is somewhere.
    pub(super) fn new(table: &PrimitiveTable, slot: u32) -> Self {
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

    /// Half its surface.
    pub(super) fn half_area(self) -> f32 {
        let size = self.max - self.min;
        size.x * size.y + size.y * size.z + size.z * size.x
    }
}

/// Brings primitives into two parts; tells how many are in the first, and the boxes around both.
#[inline(never)] // Bins are large, and callers recursive.
pub(super) fn cut(prims: &mut [Boxed], depth: usize) -> (usize, [Bounds; 2]) {
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
pub(super) fn measure(prims: &[Boxed], of: impl Fn(&Boxed) -> Bounds + Copy + Sync) -> Bounds {
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
