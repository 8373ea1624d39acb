//! Sorts primitives along a space-filling curve, so that runs of sixteen have small boxes.
//!
//! ```text
//!   measure   bounds of the middles, number of primitives       one task a chunk of blocks
//!   encode    place of each middle on the curve, with its slot  the same
//!   sort      by place: `sort_keyed`
//! ```
//!
//! **Source.** C. Lauterbach et al., "Fast BVH Construction on GPUs", Eurographics 2009 (sorted
//! codes); I. Kamel, C. Faloutsos, "On Packing R-trees", CIKM 1993 (the Hilbert curve instead of
//! the Morton curve).
//!
//! **Departures.** Cells are cubes, as many bits as the number of primitives is worth.
//!
//! **Invariants.** Each wanted triangle has one entry, those that are ignored, too; so has each
//! other wanted primitive that can be hit; nothing else has.
//!
//! **Cost.** Two passes over the corners and a sort of 8 bytes a primitive.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use glam::Vec3;
use rayflock_geom::simd::ray_triangle::TriangleBlock;
use rayflock_geom::simd::space_curve::{MOST_BITS, hilbert_codes};
use rayflock_geom::simd::{
    LANES, Select, Simd, SimdBase, SimdLevel, SimdMask, dispatch, f32x16, mask32x16, u32x16,
};
use rayon::prelude::*;
use tracing::debug_span;

use crate::primitives::{BLOCKS_PER_READ, BlockReader, PrimitiveTable};
use crate::sort_keyed::KeyedSorter;
use crate::wanted::WantedLanes;

/// Blocks of sixteen that are worth a task of their own.
const BLOCKS_PER_CHUNK: usize = 512;

/// Chunks a thread, so that all finish at about the same time.
const CHUNKS_PER_THREAD: usize = 2;

/// Sorts slots, keeping its memory.
#[derive(Debug, Default)]
pub(super) struct SlotSorter {
    /// Places on the curve and slots: `code << 32 | slot`.
    keyed: KeyedSorter,
    chunks: Vec<Chunk>,
    len: usize,
}

/// What a task found in its share of the blocks.
#[derive(Clone, Copy, Debug)]
struct Chunk {
    /// Bounds of the middles.
    min: Vec3,
    max: Vec3,
    len: usize,
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
    /// Sorts the `wanted` primitives, without spheres and the like that cannot be hit. The order is
    /// then in [`Self::slot`].
    pub(super) fn sort(
        &mut self,
        level: SimdLevel,
        table: &PrimitiveTable,
        wanted: &[WantedLanes],
    ) {
        let most_chunks = CHUNKS_PER_THREAD * rayon::current_num_threads();
        let blocks_per_chunk = wanted.len().div_ceil(most_chunks).max(BLOCKS_PER_CHUNK);
        let span = debug_span!("measure_middles").entered();
        self.measure(level, table, wanted, blocks_per_chunk);
        span.exit();
        let span = debug_span!("encode_middles").entered();
        let cells = self.cells();
        let encoder = Encoder { level, table, blocks_per_chunk, cells };
        encoder.encode(wanted, &self.chunks, self.keyed.entries(self.len));
        span.exit();
        self.keyed.sort(3 * cells.bits);
    }

    /// Number of sorted primitives.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// The slots of all primitives in order.
    #[inline(always)]
    pub(super) fn slots(&self) -> impl ExactSizeIterator<Item = u32> + '_ {
        self.keyed.sorted().iter().map(|entry| entry.load(Relaxed) as u32)
    }

    /// The slot of the primitive at a place of the order.
    #[inline(always)]
    pub(super) fn slot(&self, place: usize) -> u32 {
        self.keyed.sorted()[place].load(Relaxed) as u32
    }

    fn measure(
        &mut self,
        level: SimdLevel,
        table: &PrimitiveTable,
        wanted: &[WantedLanes],
        blocks_per_chunk: usize,
    ) {
        let empty = Chunk { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY, len: 0 };
        self.chunks.clear();
        self.chunks.resize(wanted.len().div_ceil(blocks_per_chunk), empty);
        let tasks = self.chunks.par_iter_mut().zip(wanted.par_chunks(blocks_per_chunk));
        tasks.for_each(|(chunk, wanted)| {
            *chunk = dispatch!(level.level(), simd => measure_chunk(simd, table, wanted));
        });
        self.len = self.chunks.iter().map(|chunk| chunk.len).sum();
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

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.keyed.memory_usage() + self.chunks.capacity() * size_of::<Chunk>()
    }
}

/// Writes entries.
struct Encoder<'a> {
    level: SimdLevel,
    table: &'a PrimitiveTable,
    blocks_per_chunk: usize,
    cells: Cells,
}

impl Encoder<'_> {
    /// Writes the entries of some chunks, in parallel.
    fn encode(&self, wanted: &[WantedLanes], chunks: &[Chunk], entries: &mut [AtomicU64]) {
        if chunks.len() > 1 {
            let middle = chunks.len() / 2;
            let (left, right) = chunks.split_at(middle);
            let (left_wanted, right_wanted) = wanted.split_at(middle * self.blocks_per_chunk);
            let left_len = left.iter().map(|chunk| chunk.len).sum();
            let (left_entries, right_entries) = entries.split_at_mut(left_len);
            rayon::join(
                || self.encode(left_wanted, left, left_entries),
                || self.encode(right_wanted, right, right_entries),
            );
            return;
        }
        dispatch!(self.level.level(), simd => {
            encode_chunk(simd, self.table, wanted, &self.cells, entries);
        });
    }
}

#[inline(always)]
fn measure_chunk<S: Simd>(simd: S, table: &PrimitiveTable, wanted: &[WantedLanes]) -> Chunk {
    let infinite = f32x16::splat(simd, f32::INFINITY);
    let (mut min, mut max) = ([infinite; 3], [-infinite; 3]);
    let mut len = 0;
    for_each_block(simd, table, wanted, |there, middles, _| {
        len += there.to_bitmask().count_ones() as usize;
        // What is not finite is somewhere.
        let counts = there & is_finite(simd, &middles);
        for axis in 0..3 {
            min[axis] = min[axis].min(counts.select(middles[axis], infinite));
            max[axis] = max[axis].max(counts.select(middles[axis], -infinite));
        }
    });
    Chunk {
        min: Vec3::new(min[0].reduce_min(), min[1].reduce_min(), min[2].reduce_min()),
        max: Vec3::new(max[0].reduce_max(), max[1].reduce_max(), max[2].reduce_max()),
        len,
    }
}

#[inline(always)]
fn encode_chunk<S: Simd>(
    simd: S,
    table: &PrimitiveTable,
    wanted: &[WantedLanes],
    cells: &Cells,
    entries: &mut [AtomicU64],
) {
    let min = cells.min.to_array();
    let density = f32x16::splat(simd, cells.density);
    let mut written = 0;
    for_each_block(simd, table, wanted, |there, middles, block_idx| {
        let mut points = middles;
        for axis in 0..3 {
            points[axis] = (points[axis] - f32x16::splat(simd, min[axis])) * density;
        }
        let codes = *hilbert_codes(simd, points, cells.bits);
        let mut there = there.to_bitmask();
        let first_slot = (block_idx * LANES) as u64;
        while there != 0 {
            let lane = there.trailing_zeros();
            there &= there - 1;
            let code = u64::from(codes[lane as usize]);
            let entry = (code << u32::BITS) | (first_slot + u64::from(lane));
            *entries[written].get_mut() = entry;
            written += 1;
        }
    });
}

/// Hands over the wanted blocks: which lanes count, the middles of the boxes around their
/// primitives, and which block it is.
#[inline(always)]
fn for_each_block<S: Simd>(
    simd: S,
    table: &PrimitiveTable,
    wanted: &[WantedLanes],
    mut each: impl FnMut(mask32x16<S>, [f32x16<S>; 3], usize),
) {
    let Some(first) = wanted.first() else { return };
    let mut reader = BlockReader::new(table, first.block_idx as usize);
    let mut rest = wanted;
    while let [first, ..] = rest {
        let block_idx = first.block_idx as usize;
        let lanes = |wanted: &WantedLanes| mask32x16::from_bitmask(simd, wanted.lanes.into());
        if block_idx >= table.triangle_block_count() {
            let masks = u32x16::from_slice(simd, table.masks(block_idx));
            let there = lanes(first) & !masks.simd_eq(u32x16::splat(simd, 0));
            each(there, table.bounds(block_idx).load(simd).center, block_idx);
            rest = &rest[1..];
            continue;
        }
        let is_next =
            |&(idx, next): &(usize, &WantedLanes)| next.block_idx as usize == block_idx + idx;
        let count = rest.iter().take(BLOCKS_PER_READ).enumerate().take_while(is_next).count();
        let read = reader.read(simd, block_idx..block_idx + count);
        for ((idx, wanted), triangles) in rest[..count].iter().enumerate().zip(read.corners) {
            each(lanes(wanted), triangle_middles(simd, triangles), block_idx + idx);
        }
        rest = &rest[count..];
    }
}

/// Where no coordinate is NaN or infinite.
#[inline(always)]
fn is_finite<S: Simd>(simd: S, [x, y, z]: &[f32x16<S>; 3]) -> mask32x16<S> {
    let most = f32x16::splat(simd, f32::MAX);
    x.abs().simd_le(most) & y.abs().simd_le(most) & z.abs().simd_le(most)
}

/// The middles of the boxes around triangles.
#[inline(always)]
fn triangle_middles<S: Simd>(simd: S, triangles: &TriangleBlock) -> [f32x16<S>; 3] {
    let [a, b, c] = &triangles.corners;
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
