//! Triangles on their way to strips of rays on a face: all that a task with some strips needs to
//! know, a line of the cache each.
//!
//! **Cost.** 64 shuffles of two vectors to make rows of 16 triangles, and as many to take them up.

use glam::Vec3;

use super::face_triangle::transpose;
use super::{Bytes, LANES, Lanes, Simd, SimdBase, f32x16, u32x16};

/// A triangle that may be hit, a line of the cache.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct StripRow {
    /// Nine coordinates of the corners; then bits: slot, rank, mask, first and last strip.
    row: Lanes,
}

const SLOT: usize = 9;
const RANK: usize = 10;
const MASK: usize = 11;
const STRIPS: usize = 12;

/// Stands for strips of rows that are known by their slot: no first one is behind the last.
const BY_SLOT: u32 = u16::MAX as u32;

impl StripRow {
    /// Nothing, to be overwritten.
    pub const EMPTY: Self = Self { row: [0.0; LANES] };

    /// A primitive that is known by its slot alone.
    pub fn of_slot(slot: u32) -> Self {
        let mut row = Self::EMPTY;
        row.row[SLOT] = f32::from_bits(slot);
        row.row[STRIPS] = f32::from_bits(BY_SLOT);
        row
    }

    /// Whether there is nothing but a slot.
    #[inline(always)]
    pub fn is_by_slot(&self) -> bool {
        self.row[STRIPS].to_bits() == BY_SLOT
    }

    /// A triangle by its corners; slot, rank and mask.
    pub fn of_triangle(corners: [Vec3; 3], identity: [u32; 3]) -> Self {
        let mut row = Self::EMPTY;
        for (place, corner) in row.row.chunks_exact_mut(3).zip(corners) {
            place.copy_from_slice(&corner.to_array());
        }
        for (place, bits) in row.row[SLOT..].iter_mut().zip(identity) {
            *place = f32::from_bits(bits);
        }
        row
    }

    /// The corners.
    #[inline(always)]
    pub fn corners(&self) -> [Vec3; 3] {
        let corner = |first: usize| Vec3::from_slice(&self.row[first..first + 3]);
        [corner(0), corner(3), corner(6)]
    }

    /// The slot.
    #[inline(always)]
    pub fn slot(&self) -> u32 {
        self.row[SLOT].to_bits()
    }

    /// The rank.
    #[inline(always)]
    pub fn rank(&self) -> u32 {
        self.row[RANK].to_bits()
    }

    /// The object mask.
    #[inline(always)]
    pub fn mask(&self) -> u32 {
        self.row[MASK].to_bits()
    }

    /// The first and the last strip.
    #[inline(always)]
    pub fn strips(&self) -> [usize; 2] {
        let bits = self.row[STRIPS].to_bits() as usize;
        [bits & 0xffff, bits >> 16]
    }
}

/// Makes rows of sixteen triangles.
#[inline(always)]
pub fn write_strip_rows<S: Simd>(
    simd: S,
    [a, b, c]: [[f32x16<S>; 3]; 3],
    [slots, ranks, masks, strips]: [u32x16<S>; 4],
    rows: &mut [StripRow; LANES],
) {
    let zero = f32x16::splat(simd, 0.0);
    let transposed = transpose([
        a[0],
        a[1],
        a[2],
        b[0],
        b[1],
        b[2],
        c[0],
        c[1],
        c[2],
        slots.bitcast(),
        ranks.bitcast(),
        masks.bitcast(),
        strips.bitcast(),
        zero,
        zero,
        zero,
    ]);
    for (row, vector) in rows.iter_mut().zip(transposed) {
        vector.store_slice(&mut row.row);
    }
}

/// Corners, the first and the last strip of sixteen rows as columns.
#[inline(always)]
pub fn row_columns<S: Simd>(
    simd: S,
    rows: &[StripRow; LANES],
) -> ([[f32x16<S>; 3]; 3], [u32x16<S>; 2]) {
    let mut vectors = [f32x16::splat(simd, 0.0); LANES];
    for (vector, row) in vectors.iter_mut().zip(rows) {
        *vector = f32x16::from_slice(simd, &row.row);
    }
    let c = transpose(vectors);
    let strips: u32x16<S> = c[STRIPS].bitcast();
    let strips = [strips & u32x16::splat(simd, 0xffff), strips >> 16];
    ([[c[0], c[1], c[2]], [c[3], c[4], c[5]], [c[6], c[7], c[8]]], strips)
}

#[cfg(test)]
mod tests {
    use super::super::{SimdLevel, dispatch};
    use super::*;

    #[test]
    fn rows_hold_what_they_are_made_of() {
        for level in SimdLevel::available() {
            dispatch!(level.level(), simd => {
                let column = |axis: usize| f32x16::from_fn(simd, |lane| (10 * lane + axis) as f32);
                let corners = [0, 3, 6].map(|first| [0, 1, 2].map(|axis| column(first + axis)));
                let bits = [100, 200, 300, 65_536 * 7]
                    .map(|first| u32x16::from_fn(simd, |lane| first + lane as u32));
                let mut rows = [StripRow::EMPTY; LANES];
                write_strip_rows(simd, corners, bits, &mut rows);
                let third = rows[3];
                assert_eq!(third.corners()[2], Vec3::new(36.0, 37.0, 38.0));
                assert_eq!([third.slot(), third.rank(), third.mask()], [103, 203, 303]);
                assert_eq!(third.strips(), [3, 7]);
                assert!(!third.is_by_slot() && StripRow::of_slot(5).is_by_slot());
                let (again, strips) = row_columns(simd, &rows);
                assert_eq!([strips[0][3], strips[1][3]], [3, 7]);
                for (corner, again) in corners.iter().zip(again) {
                    for (axis, again) in corner.iter().zip(again) {
                        assert_eq!(**axis, *again);
                    }
                }
            });
        }
    }
}
