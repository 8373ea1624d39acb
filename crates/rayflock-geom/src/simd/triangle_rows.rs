//! Brings triangles from rows of nine coordinates into columns of sixteen triangles.
//!
//! Thirty-two triangles are a matrix of 32 x 9 coordinates, eighteen vectors long. A perfect
//! shuffle interleaves its first half with its second half: what stood at position i comes to
//! 2 i mod 287. After five of them it stands at 32 i mod 287, and as 32 * 9 = 1 mod 287, triangle
//! t's coordinate c comes from 9 t + c to t + 32 c: the matrix is transposed.
//!
//! ```text
//!   t0c0 t0c1 ... t0c8 t1c0 ... t31c8    288 coordinates, row by row
//!   t0c0 t1c0 ... t31c0 t0c1 ... t31c8   after five shuffles, column by column
//! ```
//!
//! **Source.** H. S. Stone, "Parallel Processing with the Perfect Shuffle", IEEE Transactions on
//! Computers 1971.
//!
//! **Invariants.** Bits move, nothing is computed.
//!
//! **Cost.** 90 shuffles of two vectors for 32 triangles, 18 loads and 18 stores; no gather.

use super::triangle_lanes::TriangleLanes;
use super::{LANES, Simd, SimdBase, f32x16};

/// Coordinates of a triangle.
const COORDINATES: usize = 9;

/// Triangles that are brought into columns together.
pub const ROW_COUNT: usize = 2 * LANES;

/// Vectors that the rows fill.
const VECTORS: usize = COORDINATES * ROW_COUNT / LANES;

/// One triangle: x, y and z of its three corners.
pub type TriangleRow = [f32; COORDINATES];

/// The triangles of two blocks, in the order of their rows.
#[inline(always)]
pub fn columns_of_rows<S: Simd>(simd: S, rows: &[TriangleRow; ROW_COUNT]) -> [TriangleLanes<S>; 2] {
    let coordinates = rows.as_flattened();
    let mut vectors = [f32x16::splat(simd, 0.0); VECTORS];
    for (idx, vector) in vectors.iter_mut().enumerate() {
        *vector = f32x16::from_slice(simd, &coordinates[idx * LANES..(idx + 1) * LANES]);
    }
    let v = shuffle(simd, shuffle(simd, shuffle(simd, shuffle(simd, shuffle(simd, vectors)))));
    // A column of 32 lies in two vectors, one a block.
    let first = [[v[0], v[2], v[4]], [v[6], v[8], v[10]], [v[12], v[14], v[16]]];
    let second = [[v[1], v[3], v[5]], [v[7], v[9], v[11]], [v[13], v[15], v[17]]];
    [TriangleLanes { corners: first }, TriangleLanes { corners: second }]
}

/// Interleaves the first half with the second half.
#[inline(always)]
fn shuffle<S: Simd>(simd: S, vectors: [f32x16<S>; VECTORS]) -> [f32x16<S>; VECTORS] {
    let mut shuffled = [f32x16::splat(simd, 0.0); VECTORS];
    for idx in 0..VECTORS / 2 {
        let (low, high) = vectors[idx].interleave(vectors[idx + VECTORS / 2]);
        shuffled[2 * idx] = low;
        shuffled[2 * idx + 1] = high;
    }
    shuffled
}

#[cfg(test)]
mod tests {
    use super::super::ray_triangle::TriangleBlock;
    use super::super::{SimdLevel, dispatch};
    use super::*;

    #[test]
    fn every_coordinate_comes_to_its_column() {
        let mut rows = [[0.0; COORDINATES]; ROW_COUNT];
        for (idx, coordinate) in rows.as_flattened_mut().iter_mut().enumerate() {
            *coordinate = idx as f32;
        }
        for level in SimdLevel::available() {
            let mut blocks = [TriangleBlock::EMPTY; 2];
            dispatch!(level.level(), simd => {
                for (lanes, block) in columns_of_rows(simd, &rows).iter().zip(&mut blocks) {
                    lanes.store(block);
                }
            });
            for (triangle_idx, row) in rows.iter().enumerate() {
                let corners = blocks[triangle_idx / LANES].get(triangle_idx % LANES);
                let found = corners.map(|corner| corner.to_array());
                assert_eq!(found.as_flattened(), row, "triangle {triangle_idx}, {level}");
            }
        }
    }
}
