//! Places on a Hilbert curve through a cube of cells: neighbours on the curve are neighbours in
//! space, so consecutive runs of points have small bounds.
//!
//! **Source.** J. Skilling, "Programming the Hilbert curve", AIP Conference Proceedings 707, 2004.
//!
//! **Departures.** Sixteen points at a time; the parity at the end by halving shifts.
//!
//! **Cost.** About 13 operations for each bit of each axis, for sixteen points.

use super::{Select, Simd, SimdBase, SimdFloat, f32x16, u32x16};

/// The most bits an axis can have.
pub const MOST_BITS: u32 = 10;

/// The places of sixteen points of the cube from 0 to `2^bits`, as numbers of `3 * bits` bits;
/// `bits` from 1 to [`MOST_BITS`]. Points outside, and those that are no numbers, count as some
/// point of the cube.
#[inline(always)]
pub fn hilbert_codes<S: Simd>(simd: S, points: [f32x16<S>; 3], bits: u32) -> u32x16<S> {
    let largest = u32x16::splat(simd, (1 << bits) - 1);
    let mut x = cell(simd, points[0], largest);
    let mut y = cell(simd, points[1], largest);
    let mut z = cell(simd, points[2], largest);

    // Undo the turns and mirrorings of the cubes that hold the point, from the largest down.
    let mut bit = bits;
    while bit > 1 {
        bit -= 1;
        let (set, below) = (u32x16::splat(simd, 1 << bit), u32x16::splat(simd, (1 << bit) - 1));
        x = mirrored(simd, x, x & set, below);
        [x, y] = mirrored_or_swapped(simd, x, y, set, below);
        [x, z] = mirrored_or_swapped(simd, x, z, set, below);
    }

    // Gray code.
    y ^= x;
    z ^= y;
    let mut parity = z >> 1;
    parity ^= parity >> 1;
    parity ^= parity >> 2;
    parity ^= parity >> 4;
    parity ^= parity >> 8;
    let (x, y, z) = (x ^ parity, y ^ parity, z ^ parity);
    (spread(simd, x) << 2) | (spread(simd, y) << 1) | spread(simd, z)
}

/// The cell of a coordinate.
#[inline(always)]
fn cell<S: Simd>(simd: S, coordinate: f32x16<S>, largest: u32x16<S>) -> u32x16<S> {
    let in_range =
        coordinate.max(f32x16::splat(simd, 0.0)).min(f32x16::splat(simd, (1 << MOST_BITS) as f32));
    in_range.to_int::<u32x16<S>>().min(largest)
}

/// The lower bits of `x` flipped where `chosen` is not zero.
#[inline(always)]
fn mirrored<S: Simd>(simd: S, x: u32x16<S>, chosen: u32x16<S>, below: u32x16<S>) -> u32x16<S> {
    let zero = u32x16::splat(simd, 0);
    x ^ chosen.simd_eq(zero).select(zero, below)
}

/// Where `other` has the bit `set`, the lower bits of `x` flipped; elsewhere those of both swapped.
#[inline(always)]
fn mirrored_or_swapped<S: Simd>(
    simd: S,
    x: u32x16<S>,
    other: u32x16<S>,
    set: u32x16<S>,
    below: u32x16<S>,
) -> [u32x16<S>; 2] {
    let zero = u32x16::splat(simd, 0);
    let swap = (other & set).simd_eq(zero);
    let difference = (x ^ other) & below;
    [x ^ swap.select(difference, below), other ^ swap.select(difference, zero)]
}

/// Moves bit i to bit 3i.
#[inline(always)]
fn spread<S: Simd>(simd: S, value: u32x16<S>) -> u32x16<S> {
    let keep = |bits: u32| u32x16::splat(simd, bits);
    let value = (value | (value << 16)) & keep(0x0300_00ff);
    let value = (value | (value << 8)) & keep(0x0300_f00f);
    let value = (value | (value << 4)) & keep(0x030c_30c3);
    (value | (value << 2)) & keep(0x0924_9249)
}

#[cfg(test)]
mod tests {
    use super::super::{LANES, Lanes, SimdLevel, dispatch};
    use super::*;

    /// Codes of sixteen points at one level.
    fn codes(level: SimdLevel, points: &[Lanes; 3], bits: u32) -> [u32; LANES] {
        dispatch!(level.level(), simd => {
            let axis = |column: &Lanes| f32x16::from_slice(simd, column);
            let points = [axis(&points[0]), axis(&points[1]), axis(&points[2])];
            *hilbert_codes(simd, points, bits)
        })
    }

    /// Each cell of a cube has a place of its own, and the next place is a neighbour.
    #[test]
    fn the_curve_visits_every_cell_and_goes_from_neighbour_to_neighbour() {
        for level in SimdLevel::available() {
            for bits in 1..=4_u32 {
                let side = 1_usize << bits;
                let mut cells = vec![None; side.pow(3)];
                for first in (0..side.pow(3)).step_by(8) {
                    let cell = |idx: usize| [idx % side, idx / side % side, idx / side / side];
                    let mut points = [[0.5; LANES]; 3];
                    for lane in 0..8 {
                        for (column, cell) in points.iter_mut().zip(cell(first + lane)) {
                            column[lane] = cell as f32 + 0.5;
                        }
                    }
                    let codes = codes(level, &points, bits);
                    for (lane, &code) in codes[..8].iter().enumerate() {
                        let place = &mut cells[code as usize];
                        assert_eq!(*place, None, "{level}");
                        *place = Some(cell(first + lane));
                    }
                }
                let cells: Vec<_> = cells.into_iter().flatten().collect();
                assert_eq!(cells.len(), side.pow(3));
                for pair in cells.windows(2) {
                    let steps: usize = (0..3).map(|i| pair[0][i].abs_diff(pair[1][i])).sum();
                    assert_eq!(steps, 1, "{level}, {bits} bits: {pair:?}");
                }
            }
        }
    }

    #[test]
    fn what_lies_outside_or_is_no_number_has_a_place_too() {
        let odd = [-1.0, 1e30, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.0, 1024.0, 1023.0];
        let mut column = [0.0; LANES];
        column[..8].copy_from_slice(&odd);
        for level in SimdLevel::available() {
            for bits in [1, 6, 10] {
                let codes = codes(level, &[column; 3], bits);
                assert!(codes.iter().all(|&code| code < 1 << (3 * bits)), "{level}");
            }
        }
    }
}
