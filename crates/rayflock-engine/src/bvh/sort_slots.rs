//! Sorts primitives along a space-filling curve, so that runs of sixteen have small boxes.
//!
//! ```text
//!   measure    bounds of the middles, number of primitives       one task a chunk of blocks
//!   encode     place of each middle on the curve, with its slot  the same
//!   scatter    two or three passes of a radix sort, lowest digit first:
//!              count digits a chunk, sum, move                   one task a chunk of entries
//! ```
//!
//! **Source.** C. Lauterbach et al., "Fast BVH Construction on GPUs", Eurographics 2009 (sorted
//! codes); I. Kamel, C. Faloutsos, "On Packing R-trees", CIKM 1993 (the Hilbert curve instead of
//! the Morton curve).
//!
//! **Departures.** Cells are cubes, as many bits as the number of primitives is worth.
//!
//! **Invariants.** Each wanted primitive that can be hit has one entry; no other has.
//!
//! **Cost.** Two passes over the corners, 24 bytes moved an entry and pass.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use glam::Vec3;
use rayflock_geom::simd::space_curve::{MOST_BITS, hilbert_codes};
use rayflock_geom::simd::{
    LANES, Select, Simd, SimdBase, SimdLevel, SimdMask, dispatch, f32x16, mask32x16, u32x16,
};
use rayon::prelude::*;

use crate::primitives::PrimitiveTable;

/// Blocks of sixteen that are worth a task of their own.
const BLOCKS_PER_CHUNK: usize = 512;

/// Chunks a thread, so that all finish at about the same time.
const CHUNKS_PER_THREAD: usize = 2;

/// Some primitives of a block of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct WantedLanes {
    pub(super) block_idx: u32,
    /// One bit a lane.
    pub(super) lanes: u32,
}

/// Sorts slots, keeping its memory.
#[derive(Debug, Default)]
pub(super) struct SlotSorter {
    /// Places on the curve and slots: `code << 32 | slot`. Atomic because several tasks write
    /// each part of it, at places that are not known to differ but by arithmetic.
    sorted: Vec<AtomicU64>,
    unsorted: Vec<AtomicU64>,
    chunks: Vec<Chunk>,
    /// How often each digit occurs in each chunk; then where its next entry goes.
    counts: Vec<u32>,
    len: usize,
}

/// What a task found in its share of the blocks.
#[derive(Clone, Copy, Debug)]
struct Chunk {
    /// Bounds of the middles.
    min: Vec3,
    max: Vec3,
    len: usize,
    /// Entries in the chunks before.
    first: usize,
}

/// How middles become places on the curve.
#[derive(Clone, Copy, Debug)]
struct Cells {
    min: Vec3,
    /// Cells a unit of length.
    density: f32,
    /// Bits an axis.
    bits: u32,
}

impl SlotSorter {
    /// Sorts what can be hit of the `wanted` primitives. The order is then in [`Self::slot`].
    pub(super) fn sort(
        &mut self,
        level: SimdLevel,
        table: &PrimitiveTable,
        wanted: &[WantedLanes],
    ) {
        let most_chunks = CHUNKS_PER_THREAD * rayon::current_num_threads();
        let blocks_per_chunk = wanted.len().div_ceil(most_chunks).max(BLOCKS_PER_CHUNK);
        self.measure(level, table, wanted, blocks_per_chunk);
        if self.len == 0 {
            return;
        }
        let cells = self.cells();
        let passes = passes(cells.bits);
        self.encode(level, table, wanted, blocks_per_chunk, &cells, passes[0]);
        for (idx, pass) in passes.iter().enumerate().filter(|(_, pass)| pass.bits > 0) {
            std::mem::swap(&mut self.sorted, &mut self.unsorted);
            if idx > 0 {
                self.count(*pass);
            }
            self.scatter(*pass);
        }
    }

    /// Number of sorted primitives.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// The slots of all primitives in order, from a place on.
    #[inline(always)]
    pub(super) fn slots(&self, first: usize) -> impl ExactSizeIterator<Item = u32> + Clone + '_ {
        self.sorted[first..self.len].iter().map(|entry| entry.load(Relaxed) as u32)
    }

    /// The slot of the primitive at a place of the order.
    #[inline(always)]
    pub(super) fn slot(&self, place: usize) -> u32 {
        self.sorted[place].load(Relaxed) as u32
    }

    fn measure(
        &mut self,
        level: SimdLevel,
        table: &PrimitiveTable,
        wanted: &[WantedLanes],
        blocks_per_chunk: usize,
    ) {
        let empty = Chunk { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY, len: 0, first: 0 };
        self.chunks.clear();
        self.chunks.resize(wanted.len().div_ceil(blocks_per_chunk), empty);
        let tasks = self.chunks.par_iter_mut().zip(wanted.par_chunks(blocks_per_chunk));
        tasks.for_each(|(chunk, wanted)| {
            *chunk = dispatch!(level.level(), simd => measure_chunk(simd, table, wanted));
        });
        self.len = 0;
        for chunk in &mut self.chunks {
            chunk.first = self.len;
            self.len += chunk.len;
        }
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        self.chunks.iter().fold(empty, |(min, max), chunk| (min.min(chunk.min), max.max(chunk.max)))
    }

    fn cells(&self) -> Cells {
        let (min, max) = self.bounds();
        let bits = match self.len {
            0..0x2000 => 6,
            0x2000..0x10000 => 7,
            0x10000..0x40_0000 => 8,
            _ => MOST_BITS,
        };
        let density = (1 << bits) as f32 / (max - min).max_element();
        // Where all is one point, or too far apart, there is no order.
        Cells { min, density: if density.is_finite() { density } else { 0.0 }, bits }
    }

    fn encode(
        &mut self,
        level: SimdLevel,
        table: &PrimitiveTable,
        wanted: &[WantedLanes],
        blocks_per_chunk: usize,
        cells: &Cells,
        pass: Pass,
    ) {
        for column in [&mut self.sorted, &mut self.unsorted] {
            if column.len() < self.len {
                column.resize_with(self.len, AtomicU64::default);
            }
        }
        self.counts.clear();
        self.counts.resize(self.chunks.len() << pass.bits, 0);
        let counts = self.counts.par_chunks_mut(1 << pass.bits).zip(&self.chunks);
        let entries = &self.sorted;
        counts.zip(wanted.par_chunks(blocks_per_chunk)).for_each(|((counts, chunk), wanted)| {
            let entries = &entries[chunk.first..chunk.first + chunk.len];
            dispatch!(level.level(), simd => {
                encode_chunk(simd, table, wanted, cells, entries);
            });
            count_digits(entries, pass, counts);
        });
    }

    fn count(&mut self, pass: Pass) {
        self.counts.clear();
        self.counts.resize(self.chunks.len() << pass.bits, 0);
        let counts = self.counts.par_chunks_mut(1 << pass.bits).zip(&self.chunks);
        let entries = &self.unsorted;
        counts.for_each(|(counts, chunk)| {
            count_digits(&entries[chunk.first..chunk.first + chunk.len], pass, counts);
        });
    }

    /// Moves all entries to where their digit sends them.
    fn scatter(&mut self, pass: Pass) {
        sum_counts(&mut self.counts, 1 << pass.bits);
        let places = self.counts.par_chunks_mut(1 << pass.bits).zip(&self.chunks);
        let (unsorted, sorted) = (&self.unsorted, &self.sorted);
        places.for_each(|(places, chunk)| {
            for entry in &unsorted[chunk.first..chunk.first + chunk.len] {
                let entry = entry.load(Relaxed);
                let place = &mut places[pass.digit(entry)];
                sorted[*place as usize].store(entry, Relaxed);
                *place += 1;
            }
        });
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        (self.sorted.capacity() + self.unsorted.capacity()) * size_of::<AtomicU64>()
            + self.chunks.capacity() * size_of::<Chunk>()
            + self.counts.capacity() * size_of::<u32>()
    }
}

/// The digit of one pass of the radix sort; without bits, there is no such pass.
#[derive(Clone, Copy, Debug)]
struct Pass {
    shift: u32,
    bits: u32,
}

impl Pass {
    #[inline(always)]
    fn digit(self, entry: u64) -> usize {
        (entry >> self.shift) as usize & ((1 << self.bits) - 1)
    }
}

/// The passes for codes of so many bits an axis: few digits, and small enough that the places
/// they send to stay in the second-level cache.
fn passes(bits: u32) -> [Pass; 3] {
    let code_bits = 3 * bits;
    let widths = if code_bits <= 24 {
        [code_bits.div_ceil(2), code_bits / 2, 0]
    } else {
        [code_bits.div_ceil(3), code_bits.div_ceil(3), code_bits - 2 * code_bits.div_ceil(3)]
    };
    let mut shift = u32::BITS;
    widths.map(|bits| {
        shift += bits;
        Pass { shift: shift - bits, bits }
    })
}

fn count_digits(entries: &[AtomicU64], pass: Pass, counts: &mut [u32]) {
    for entry in entries {
        counts[pass.digit(entry.load(Relaxed))] += 1;
    }
}

/// Turns counts of each digit in each chunk into places: all of the lowest digit first, in the
/// order of the chunks.
fn sum_counts(counts: &mut [u32], digits: usize) {
    let mut place = 0;
    for digit in 0..digits {
        for count in counts[digit..].iter_mut().step_by(digits) {
            (*count, place) = (place, place + *count);
        }
    }
}

#[inline(always)]
fn measure_chunk<S: Simd>(simd: S, table: &PrimitiveTable, wanted: &[WantedLanes]) -> Chunk {
    let infinite = f32x16::splat(simd, f32::INFINITY);
    let (mut min, mut max) = ([infinite; 3], [-infinite; 3]);
    let mut len = 0;
    for wanted in wanted {
        let there = there(simd, table, wanted);
        len += there.to_bitmask().count_ones() as usize;
        let middles = middles(simd, table, wanted.block_idx as usize);
        for axis in 0..3 {
            min[axis] = min[axis].min(there.select(middles[axis], infinite));
            max[axis] = max[axis].max(there.select(middles[axis], -infinite));
        }
    }
    Chunk {
        min: Vec3::new(min[0].reduce_min(), min[1].reduce_min(), min[2].reduce_min()),
        max: Vec3::new(max[0].reduce_max(), max[1].reduce_max(), max[2].reduce_max()),
        len,
        first: 0,
    }
}

#[inline(always)]
fn encode_chunk<S: Simd>(
    simd: S,
    table: &PrimitiveTable,
    wanted: &[WantedLanes],
    cells: &Cells,
    entries: &[AtomicU64],
) {
    let min = cells.min.to_array();
    let density = f32x16::splat(simd, cells.density);
    let mut written = 0;
    for wanted in wanted {
        let mut points = middles(simd, table, wanted.block_idx as usize);
        for axis in 0..3 {
            points[axis] = (points[axis] - f32x16::splat(simd, min[axis])) * density;
        }
        let codes = *hilbert_codes(simd, points, cells.bits);
        let mut there = there(simd, table, wanted).to_bitmask();
        let first_slot = u64::from(wanted.block_idx) * LANES as u64;
        while there != 0 {
            let lane = there.trailing_zeros();
            there &= there - 1;
            let code = u64::from(codes[lane as usize]);
            let entry = (code << u32::BITS) | (first_slot + u64::from(lane));
            entries[written].store(entry, Relaxed);
            written += 1;
        }
    }
}

/// The wanted lanes that can be hit.
#[inline(always)]
fn there<S: Simd>(simd: S, table: &PrimitiveTable, wanted: &WantedLanes) -> mask32x16<S> {
    let masks = u32x16::from_slice(simd, table.masks(wanted.block_idx as usize));
    !masks.simd_eq(u32x16::splat(simd, 0)) & mask32x16::from_bitmask(simd, wanted.lanes.into())
}

/// The middles of the boxes around a block's primitives.
#[inline(always)]
fn middles<S: Simd>(simd: S, table: &PrimitiveTable, block_idx: usize) -> [f32x16<S>; 3] {
    if block_idx >= table.triangle_block_count() {
        return table.bounds(block_idx).load(simd).center;
    }
    let [a, b, c] = &table.triangle_block(block_idx).corners;
    [
        middle(simd, &a[0], &b[0], &c[0]),
        middle(simd, &a[1], &b[1], &c[1]),
        middle(simd, &a[2], &b[2], &c[2]),
    ]
}

#[inline(always)]
fn middle<S: Simd>(simd: S, a: &[f32; LANES], b: &[f32; LANES], c: &[f32; LANES]) -> f32x16<S> {
    let load = f32x16::from_slice;
    let (a, b, c) = (load(simd, a), load(simd, b), load(simd, c));
    let half = f32x16::splat(simd, 0.5);
    a.min(b).min(c) * half + a.max(b).max(c) * half
}
