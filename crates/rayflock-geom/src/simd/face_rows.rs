//! Triangles of a face as rows: all that a tile of the face needs to know, a line of the cache each.
//!
//! A window of the face is divided into 2^16 x 2^16 cells. Points of rays and corners of boxes come
//! to cells by the same operations, so tiles, which are squares of cells, can be found by shifts.
//!
//! **Invariants.** Operations are monotone: a point between two others has a cell between theirs.
//! Points outside the window count for its border.
//!
//! **Cost.** 64 shuffles of two vectors and some 60 operations for 16 triangles.

use super::face::FaceTriangles;
use super::face_triangle::transpose;
use super::triangle_lanes::TriangleLanes;
use super::{Bytes, LANES, Lanes, Simd, SimdBase, SimdCvtTruncate, f32x16, u32x16};

/// Bits of a cell's number along an axis.
pub const CELL_BITS: u32 = 16;

/// The part of a face that is divided into cells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Window {
    /// Least x and least y.
    pub low: [f32; 2],
    /// Cells for each unit of x and of y.
    pub scale: [f32; 2],
}

impl Window {
    /// The window around a box: least and largest x, least and largest y.
    pub fn around([x0, x1, y0, y1]: [f32; 4]) -> Self {
        let cells = (1_u32 << CELL_BITS) as f32;
        let scale = [x1 - x0, y1 - y0].map(|size| {
            let scale = cells / size;
            if scale.is_finite() && scale > 0.0 { scale } else { 0.0 }
        });
        let low = [x0, y0].map(|low| if low.is_finite() { low } else { 0.0 });
        Self { low, scale }
    }

    /// The cell of a coordinate along an axis.
    pub fn cell(&self, value: f32, axis: usize) -> u32 {
        let most = ((1_u32 << CELL_BITS) - 1) as f32;
        ((value - self.low[axis]) * self.scale[axis]).max(0.0).min(most) as u32
    }

    /// The cells of coordinates along an axis.
    #[inline(always)]
    pub fn cells<S: Simd>(&self, simd: S, value: f32x16<S>, axis: usize) -> u32x16<S> {
        let most = f32x16::splat(simd, ((1_u32 << CELL_BITS) - 1) as f32);
        let cell = (value - self.low[axis]) * self.scale[axis];
        u32x16::truncate_from(cell.max(f32x16::splat(simd, 0.0)).min(most))
    }
}

/// A triangle on its way to the tiles of a face.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct FaceRow {
    /// Corners, nine coordinates; the largest nearness of a hit, the least; then bits: the first
    /// and last column of cells, the first and last row, rank, mask; one is free.
    row: Lanes,
}

/// Places in [`FaceRow::row`].
const NEAREST: usize = 9;
const FARTHEST: usize = 10;
const COLUMNS: usize = 11;
const ROWS: usize = 12;
const RANK: usize = 13;
const MASK: usize = 14;

impl FaceRow {
    /// Nothing, to be overwritten.
    pub const EMPTY: Self = Self { row: [0.0; LANES] };

    /// The nine coordinates of the corners.
    #[inline(always)]
    pub fn corners(&self) -> &[f32] {
        &self.row[..9]
    }

    /// The largest nearness of a hit.
    #[inline(always)]
    pub fn nearest(&self) -> f32 {
        self.row[NEAREST]
    }

    /// The least nearness of a hit.
    #[inline(always)]
    pub fn farthest(&self) -> f32 {
        self.row[FARTHEST]
    }

    /// The first and the last column of cells.
    #[inline(always)]
    pub fn columns(&self) -> [u32; 2] {
        let bits = self.row[COLUMNS].to_bits();
        [bits & 0xffff, bits >> 16]
    }

    /// The first and the last row of cells.
    #[inline(always)]
    pub fn rows(&self) -> [u32; 2] {
        let bits = self.row[ROWS].to_bits();
        [bits & 0xffff, bits >> 16]
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
}

/// Writes sixteen triangles with a place on the face as rows.
#[inline(always)]
pub fn write_rows<S: Simd>(
    simd: S,
    triangles: &TriangleLanes<S>,
    placed: &FaceTriangles<S>,
    window: &Window,
    [ranks, masks]: [u32x16<S>; 2],
    rows: &mut [FaceRow; LANES],
) {
    let [a, b, c] = triangles.corners;
    let [n0, n1, n2] = placed.near;
    let nearest = n0.max(n1).max(n2) + placed.near_margin;
    let farthest = n0.min(n1).min(n2) - placed.near_margin;
    let [x0, x1, y0, y1] = placed.bounds;
    let columns = window.cells(simd, x0, 0) | (window.cells(simd, x1, 0) << CELL_BITS);
    let row_pair = window.cells(simd, y0, 1) | (window.cells(simd, y1, 1) << CELL_BITS);
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
        nearest,
        farthest,
        columns.bitcast(),
        row_pair.bitcast(),
        ranks.bitcast(),
        masks.bitcast(),
        zero,
    ]);
    for (row, vector) in rows.iter_mut().zip(transposed) {
        vector.store_slice(&mut row.row);
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use proptest::prelude::*;

    use super::super::face::{Face, FaceKind};
    use super::super::ray_triangle::TriangleBlock;
    use super::super::{SimdLevel, dispatch};
    use super::*;

    const FACE: Face = Face {
        kind: FaceKind::Parallel { reach: 0.0 },
        center: Vec3::ZERO,
        rows: [Vec3::X, Vec3::Y, Vec3::Z],
    };

    fn corner() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-2.0..2.0_f32).prop_map(Vec3::from)
    }

    proptest! {
        #[test]
        fn rows_hold_what_triangles_are_and_cover_their_cells(
            triangles in prop::collection::vec(prop::array::uniform3(corner()), LANES),
        ) {
            let window = Window::around([-1.0, 1.5, -1.25, 1.0]);
            let mut block = TriangleBlock::EMPTY;
            for (lane, &corners) in triangles.iter().enumerate() {
                block.set(lane, corners);
            }
            for level in SimdLevel::available() {
                let mut rows = [FaceRow::EMPTY; LANES];
                dispatch!(level.level(), simd => {
                    let lanes = TriangleLanes::load(simd, &block);
                    let placed = FACE.project_triangles(simd, &lanes.corners);
                    let ranks = u32x16::from_fn(simd, |lane| 100 + lane as u32);
                    let masks = u32x16::from_fn(simd, |lane| 1 << lane);
                    write_rows(simd, &lanes, &placed, &window, [ranks, masks], &mut rows);
                });
                for (lane, (row, corners)) in rows.iter().zip(&triangles).enumerate() {
                    let coordinates = corners.map(|corner| corner.to_array());
                    prop_assert_eq!(row.corners(), coordinates.as_flattened());
                    prop_assert_eq!((row.rank(), row.mask()), (100 + lane as u32, 1 << lane));
                    for corner in corners {
                        let (column, line) = (window.cell(corner.x, 0), window.cell(corner.y, 1));
                        let ([first, last], [low, high]) = (row.columns(), row.rows());
                        prop_assert!(first <= column && column <= last, "{level}: {corner}");
                        prop_assert!(low <= line && line <= high, "{level}: {corner}");
                        prop_assert!(row.farthest() <= -corner.z && -corner.z <= row.nearest());
                    }
                }
            }
        }

        #[test]
        fn one_coordinate_and_sixteen_come_to_the_same_cell(value in -3.0..3.0_f32) {
            let window = Window::around([-1.0, 1.5, -1.25, 1.0]);
            for level in SimdLevel::available() {
                for axis in 0..2 {
                    let cells = dispatch!(level.level(), simd => {
                        *window.cells(simd, f32x16::splat(simd, value), axis)
                    });
                    prop_assert_eq!(cells, [window.cell(value, axis); LANES]);
                }
            }
        }
    }
}
