//! Primitives that the rays of a node may hit.

use rayflock_geom::simd::cone_sphere::SphereLanes;
use rayflock_geom::simd::{LANES, Simd, SimdBase, SimdMask, f32x16, mask32x16, u32x16};

/// Slots with their bounding spheres, as columns that compressing stores append to.
#[derive(Debug, Default)]
pub(super) struct Candidates {
    center: [Vec<f32>; 3],
    radius: Vec<f32>,
    slots: Vec<u32>,
    /// Lower bounds on the distance from the origins of the node's rays.
    nearest: Vec<f32>,
    len: usize,
}

impl Candidates {
    /// Empties the list and makes room for `capacity` candidates.
    #[inline(always)]
    pub(super) fn clear(&mut self, capacity: usize) {
        self.len = 0;
        let room = (capacity + LANES).next_multiple_of(LANES);
        if self.slots.len() < room {
            for column in self.center.iter_mut().chain([&mut self.radius, &mut self.nearest]) {
                column.resize(room, 0.0);
            }
            self.slots.resize(room, 0);
        }
    }

    /// Appends the lanes in `kept`.
    #[inline(always)]
    pub(super) fn append<S: Simd>(
        &mut self,
        simd: S,
        spheres: &SphereLanes<S>,
        slots: u32x16<S>,
        nearest: f32x16<S>,
        kept: mask32x16<S>,
    ) {
        let count = kept.to_bitmask().count_ones() as usize;
        if count == 0 {
            return;
        }
        let place = self.len..self.len + LANES;
        for (column, center) in self.center.iter_mut().zip(spheres.center) {
            simd.compress_f32x16(center, kept).store_slice(&mut column[place.clone()]);
        }
        simd.compress_f32x16(spheres.radius, kept).store_slice(&mut self.radius[place.clone()]);
        simd.compress_f32x16(nearest, kept).store_slice(&mut self.nearest[place.clone()]);
        simd.compress_u32x16(slots, kept).store_slice(&mut self.slots[place]);
        self.len += count;
    }

    /// Ends appending: fills the last block with spheres that nothing touches.
    #[inline(always)]
    pub(super) fn seal(&mut self) {
        self.radius[self.len..self.len.next_multiple_of(LANES)].fill(f32::NEG_INFINITY);
    }

    /// Number of candidates.
    pub(super) const fn len(&self) -> usize {
        self.len
    }

    /// Bytes written when the list was filled: six columns.
    pub(super) const fn written_bytes(&self) -> u64 {
        (6 * size_of::<f32>() * self.len) as u64
    }

    /// Bytes read when all blocks are loaded: five columns.
    pub(super) const fn loaded_bytes(&self) -> u64 {
        (5 * size_of::<f32>() * LANES * self.block_count()) as u64
    }

    /// Bytes that [`Self::sort_by_distance`] reads and writes, moves while sorting not included.
    pub(super) const fn sorted_bytes(&self) -> u64 {
        (2 * size_of::<u64>() * self.len) as u64
    }

    /// Number of blocks of sixteen.
    pub(super) const fn block_count(&self) -> usize {
        self.len.div_ceil(LANES)
    }

    /// A block: bounding spheres and slots.
    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S, block_idx: usize) -> (SphereLanes<S>, u32x16<S>) {
        let place = block_idx * LANES..(block_idx + 1) * LANES;
        let load = |column: &[f32]| f32x16::from_slice(simd, &column[place.clone()]);
        let [x, y, z] = &self.center;
        let spheres =
            SphereLanes { center: [load(x), load(y), load(z)], radius: load(&self.radius) };
        (spheres, u32x16::from_slice(simd, &self.slots[place]))
    }

    /// Writes the candidates into `sorted`, nearest first, each as `distance bits << 32 | slot`.
    pub(super) fn sort_by_distance(&self, sorted: &mut Vec<u64>) {
        // Bits of distances that are not negative sort as the distances do; max takes NaN to 0.
        let key = |(&slot, &nearest): (&u32, &f32)| {
            (u64::from(nearest.max(0.0).to_bits()) << 32) | u64::from(slot)
        };
        sorted.clear();
        sorted.extend(self.slots[..self.len].iter().zip(&self.nearest[..self.len]).map(key));
        sorted.sort_unstable();
    }

    /// The slot of a sorted candidate.
    #[inline(always)]
    pub(super) const fn slot(key: u64) -> u32 {
        key as u32
    }

    /// The distance bound of a sorted candidate.
    #[inline(always)]
    pub(super) const fn distance(key: u64) -> f32 {
        f32::from_bits((key >> 32) as u32)
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        6 * size_of::<f32>() * self.slots.capacity()
    }
}
