//! Is there any ray near? A pyramid of bits over the points of a face.
//!
//! ```text
//!   level n   2^n x 2^n cells, some 256 a ray; a bit says that a ray is in the cell or in one of
//!             the fifteen to the right of it and above it that make a square of four by four
//!   level k   the same for squares of cells, down to 64 x 64
//!   exact     level n once more, where a bit says that a ray is in the cell: a word for each square
//!             of eight by eight
//! ```
//!
//! A box that is not larger than three cells of its level lies in at most four by four of them, so
//! one bit answers for it. The level follows from the box's size, the bit from its lower left
//! corner. Boxes that are left and lie in at most two by two words of the exact bits are asked cell
//! by cell.
//!
//! **Source.** After N. Greene, M. Kass, G. Miller, "Hierarchical Z-Buffer Visibility", SIGGRAPH
//! 1993. **Departures.** Bits instead of depths, dilated so that one is enough.
//!
//! **Invariants.** Points and corners of boxes become cells by the same monotone operations, so a
//! point in a box has a cell between those of the box's corners. Points outside the window count
//! for its border.
//!
//! **Cost.** Three bits a cell; two passes over the bits.

use std::array::from_fn;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayflock_geom::simd::{
    Bytes, Simd, SimdBase, SimdCvtFloat, SimdCvtTruncate, SimdMask, f32x16, mask32x16, u32x16,
};

/// The coarsest level: rows of a word.
const COARSEST: u32 = 6;

/// The finest level, 1 MiB with all above it.
const FINEST: u32 = 11;

/// Cells along a side of the square that has a word of its own, and its logarithm.
const SQUARE: usize = 1 << SQUARE_BITS;
const SQUARE_BITS: u32 = 3;

/// A third, rounded up.
const THIRD: f32 = 0.333_333_4;

/// Bits over the points of one face.
#[derive(Debug, Default)]
pub(super) struct Occupancy {
    /// Level k from bit 4^k on. Atomic because several tasks note rays.
    words: Vec<AtomicU64>,
    /// The finest level before bits were brought to neighbours, row after row of squares, and in each
    /// of these row after row of cells.
    exact: Vec<u64>,
    finest: u32,
    low: [f32; 2],
    scale: [f32; 2],
}

impl Occupancy {
    /// Makes room for about `ray_count` points within the window (least and largest x, least and
    /// largest y), none of which is noted yet.
    pub(super) fn clear(&mut self, [x0, x1, y0, y1]: [f32; 4], ray_count: usize) {
        let bits = usize::BITS - ray_count.leading_zeros();
        self.finest = (bits.div_ceil(2) + 3).clamp(COARSEST, FINEST);
        let cells = (1 << self.finest) as f32;
        self.low = [x0, y0];
        self.scale = [x1 - x0, y1 - y0].map(|size| {
            let scale = cells / size;
            if scale.is_finite() && scale > 0.0 { scale } else { 0.0 }
        });
        self.words.clear();
        self.words.resize_with((2 << (2 * self.finest)) / 64, AtomicU64::default);
    }

    /// Notes the `active` points.
    #[inline(always)]
    pub(super) fn note<S: Simd>(&self, simd: S, x: f32x16<S>, y: f32x16<S>, active: mask32x16<S>) {
        let (column, row) = (self.cells(simd, x, 0), self.cells(simd, y, 1));
        let first = u32x16::splat(simd, 1 << (2 * self.finest));
        let bits = first | (row << self.finest) | column;
        let mut lanes = active.to_bitmask();
        while lanes != 0 {
            let bit = bits[lanes.trailing_zeros() as usize];
            lanes &= lanes - 1;
            let word = &self.words[bit as usize / 64];
            let flag = 1 << (bit % 64);
            if word.load(Relaxed) & flag == 0 {
                word.fetch_or(flag, Relaxed);
            }
        }
    }

    /// Builds the coarser levels, then spreads each bit to the cells that answer for it.
    pub(super) fn finish(&mut self) {
        for level in (COARSEST..self.finest).rev() {
            self.halve(level);
        }
        self.note_squares();
        for level in COARSEST..=self.finest {
            self.dilate(level);
        }
    }

    /// Copies the finest level, square by square.
    fn note_squares(&mut self) {
        let side_words = (1 << self.finest) / 64;
        let words = &mut self.words[(1 << (2 * self.finest)) / 64..];
        self.exact.resize(words.len(), 0);
        let bands = words.chunks_exact_mut(SQUARE * side_words);
        for (band, exact) in bands.zip(self.exact.chunks_exact_mut(SQUARE * side_words)) {
            for (idx, squares) in exact.chunks_exact_mut(SQUARE).enumerate() {
                let row = |row: usize| *band[row * side_words + idx].get_mut();
                squares.copy_from_slice(&squares_of(from_fn(row)));
            }
        }
    }

    /// Fills a level from the one below it.
    fn halve(&mut self, level: u32) {
        let side_words = (1 << level) / 64;
        let (above, below) = self.words.split_at_mut((4 << (2 * level)) / 64);
        let above = &mut above[(1 << (2 * level)) / 64..];
        for row in 0..1 << level {
            for word_idx in 0..side_words {
                let mut halves = [0; 2];
                for (half, bits) in halves.iter_mut().enumerate() {
                    let place = 2 * row * (2 * side_words) + 2 * word_idx + half;
                    let upper = *below[place + 2 * side_words].get_mut();
                    *bits = pairs(*below[place].get_mut() | upper);
                }
                *above[row * side_words + word_idx].get_mut() = halves[0] | (halves[1] << 32);
            }
        }
    }

    /// Brings each cell's bit to its neighbours to the left and below.
    fn dilate(&mut self, level: u32) {
        let side_words = (1 << level) / 64;
        let first = (1 << (2 * level)) / 64;
        let words = &mut self.words[first..2 * first];
        for place in 0..words.len() {
            let is_last = place % side_words == side_words - 1;
            let next = if is_last { 0 } else { *words[place + 1].get_mut() };
            let here = *words[place].get_mut();
            let pair = here | (here >> 1) | (next << 63);
            let next_pair = next | (next >> 1);
            *words[place].get_mut() = pair | (pair >> 2) | (next_pair << 62);
        }
        // Rows above are as they were when a row takes them.
        for place in 0..words.len() {
            let mut bits = *words[place].get_mut();
            for above in words[place..].iter_mut().step_by(side_words).skip(1).take(3) {
                bits |= *above.get_mut();
            }
            *words[place].get_mut() = bits;
        }
    }

    /// Keeps those of the `asked` boxes (least and largest x, least and largest y) that a ray may
    /// be in.
    #[inline(always)]
    pub(super) fn keep<S: Simd>(
        &self,
        simd: S,
        bounds: &[f32x16<S>; 4],
        asked: mask32x16<S>,
    ) -> mask32x16<S> {
        let splat = u32x16::splat;
        let [left, right, low, high] = self.box_cells(simd, bounds);

        // Three times 2^rise is at least the number of cells from one corner to the other.
        let size = (right - left).max(high - low);
        let third = (f32x16::float_from(size) - 0.5) * f32x16::splat(simd, THIRD);
        let size = third.max(f32x16::splat(simd, 0.5));
        let exponent: u32x16<S> = size.bitcast();
        let rise = (exponent >> 23) - splat(simd, 126);
        let most = splat(simd, self.finest - COARSEST);
        let is_large = rise.simd_gt(most);
        let rise = rise.min(most);
        let level = splat(simd, self.finest) - rise;
        let place = ((low >> rise) << level) | (left >> rise);
        let bits = (splat(simd, 1) << (level + level)) | place;

        let mut kept = (asked & is_large).to_bitmask();
        let mut lanes = (asked & !is_large).to_bitmask();
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let bit = bits[lane];
            let word = self.words[bit as usize / 64].load(Relaxed);
            kept |= ((word >> (bit % 64)) & 1) << lane;
        }
        mask32x16::from_bitmask(simd, kept)
    }

    /// The same by the cells of the finest level, unless a box is large.
    #[inline(always)]
    pub(super) fn keep_closely<S: Simd>(
        &self,
        simd: S,
        bounds: &[f32x16<S>; 4],
        asked: mask32x16<S>,
    ) -> mask32x16<S> {
        let [left, right, low, high] = self.box_cells(simd, bounds);
        let [left_square, right_square, low_square, high_square] =
            [left >> SQUARE_BITS, right >> SQUARE_BITS, low >> SQUARE_BITS, high >> SQUARE_BITS];
        let two = u32x16::splat(simd, 2);
        let is_small =
            (right_square - left_square).simd_lt(two) & (high_square - low_square).simd_lt(two);
        let mut kept = (asked & !is_small).to_bitmask();
        let mut lanes = (asked & is_small).to_bitmask();
        let (left, right, low, high) = (*left, *right, *low, *high);
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let has_any = self.has_any([left[lane], right[lane]], [low[lane], high[lane]]);
            kept |= u64::from(has_any) << lane;
        }
        mask32x16::from_bitmask(simd, kept)
    }

    /// Whether a ray is in the cells of a box in at most two by two squares, given the first and the
    /// last column and row.
    #[inline(always)]
    fn has_any(&self, columns: [u32; 2], rows: [u32; 2]) -> bool {
        let [left, right] = columns.map(|column| column >> SQUARE_BITS);
        let [low, high] = rows.map(|row| row >> SQUARE_BITS << (self.finest - SQUARE_BITS));
        // Columns are bits of every byte of a word, rows whole bytes.
        let columns = within_squares(columns, 1).map(|bits| bits * (u64::MAX / 0xff));
        let rows = within_squares(rows, SQUARE as u32);
        let word = |square: u32| self.exact[square as usize];
        let found = word(low + left) & rows[0] & columns[0]
            | word(low + right) & rows[0] & columns[1]
            | word(high + left) & rows[1] & columns[0]
            | word(high + right) & rows[1] & columns[1];
        found != 0
    }

    /// The first and the last column of boxes, the first and the last row.
    #[inline(always)]
    fn box_cells<S: Simd>(&self, simd: S, [x0, x1, y0, y1]: &[f32x16<S>; 4]) -> [u32x16<S>; 4] {
        [
            self.cells(simd, *x0, 0),
            self.cells(simd, *x1, 0),
            self.cells(simd, *y0, 1),
            self.cells(simd, *y1, 1),
        ]
    }

    /// The cells of coordinates along an axis.
    #[inline(always)]
    fn cells<S: Simd>(&self, simd: S, value: f32x16<S>, axis: usize) -> u32x16<S> {
        let most = f32x16::splat(simd, ((1 << self.finest) - 1) as f32);
        let cell = (value - self.low[axis]) * self.scale[axis];
        u32x16::truncate_from(cell.max(f32x16::splat(simd, 0.0)).min(most))
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        8 * (self.words.capacity() + self.exact.capacity())
    }
}

/// Eight rows of 64 cells as eight squares: what were rows of bytes become columns.
fn squares_of(mut rows: [u64; SQUARE]) -> [u64; SQUARE] {
    let steps =
        [(4, 0x0000_0000_ffff_ffff_u64), (2, 0x0000_ffff_0000_ffff), (1, 0x00ff_00ff_00ff_00ff)];
    for (step, low) in steps {
        for idx in (0..SQUARE).filter(|idx| idx & step == 0) {
            let (first, second) = (rows[idx], rows[idx + step]);
            rows[idx] = (first & low) | (second & low) << (8 * step);
            rows[idx + step] = (first >> (8 * step)) & low | second & !low;
        }
    }
    rows
}

/// The cells from the first to the last, in the square of the first and in that of the last, as so
/// many bits each.
#[inline(always)]
fn within_squares([first, last]: [u32; 2], bits: u32) -> [u64; 2] {
    let side = SQUARE as u32 - 1;
    let all = u64::MAX >> (u64::BITS - bits * SQUARE as u32);
    let from = (all << (bits * (first & side))) & all;
    let to = all >> (bits * (side - (last & side)));
    if first >> SQUARE_BITS == last >> SQUARE_BITS { [from & to; 2] } else { [from, to] }
}

/// Whether either of bits 2i and 2i + 1 is set, in bit i.
fn pairs(word: u64) -> u64 {
    let bits = (word | (word >> 1)) & 0x5555_5555_5555_5555;
    let bits = (bits | (bits >> 1)) & 0x3333_3333_3333_3333;
    let bits = (bits | (bits >> 2)) & 0x0f0f_0f0f_0f0f_0f0f;
    let bits = (bits | (bits >> 4)) & 0x00ff_00ff_00ff_00ff;
    let bits = (bits | (bits >> 8)) & 0x0000_ffff_0000_ffff;
    (bits | (bits >> 16)) & 0x0000_0000_ffff_ffff
}

#[cfg(test)]
#[path = "occupancy_tests.rs"]
mod tests;
