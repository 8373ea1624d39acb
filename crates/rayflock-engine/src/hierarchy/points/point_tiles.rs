//! Tiles of rays that are close on a face, and the boxes around them.

use rayflock_geom::simd::LANES;
use rayflock_geom::simd::Simd;

use super::occupancy::Occupancy;
use rayflock_geom::simd::face::Face;
use rayflock_geom::simd::face_triangle::FaceTriangle;
use rayflock_geom::simd::point_boxes::{PointBox, PointBoxes};

/// The tiles of one face under boxes of boxes, sixteen each.
#[derive(Debug)]
pub(super) struct FaceTiles {
    pub(super) face: Face,
    /// Around all rays.
    pub(super) bound: PointBox,
    /// The first tile among those of all faces.
    first_tile: usize,
    /// Boxes of tiles.
    tiles: Vec<PointBoxes>,
    /// Boxes of the entries of `tiles`.
    upper: Vec<PointBoxes>,
    /// Where rays are, if it is worth asking.
    pub(super) occupancy: Occupancy,
    pub(super) has_occupancy: bool,
}

impl FaceTiles {
    /// A face without tiles.
    pub(super) fn new(face: Face) -> Self {
        Self {
            face,
            bound: PointBox::EMPTY,
            first_tile: 0,
            tiles: Vec::new(),
            upper: Vec::new(),
            occupancy: Occupancy::default(),
            has_occupancy: false,
        }
    }

    /// Takes the boxes of consecutive tiles.
    pub(super) fn assign(&mut self, face: Face, first_tile: usize, boxes: &[PointBox]) {
        self.face = face;
        self.first_tile = first_tile;
        group(boxes.iter().copied(), &mut self.tiles);
        group(self.tiles.iter().map(PointBoxes::union), &mut self.upper);
        self.bound = self.upper.iter().fold(PointBox::EMPTY, |all, one| all.union(&one.union()));
    }

    /// Calls `visit` with each tile that the triangle may touch.
    #[inline(always)]
    pub(super) fn for_touched<S: Simd>(
        &self,
        simd: S,
        triangle: &FaceTriangle,
        lists: &mut [Vec<u32>],
        entry: u32,
    ) {
        for (upper_idx, upper) in self.upper.iter().enumerate() {
            let mut groups = upper.touched(simd, triangle);
            while groups != 0 {
                let group_idx = upper_idx * LANES + groups.trailing_zeros() as usize;
                groups &= groups - 1;
                let mut tiles = self.tiles[group_idx].touched(simd, triangle);
                while tiles != 0 {
                    let tile_idx = group_idx * LANES + tiles.trailing_zeros() as usize;
                    tiles &= tiles - 1;
                    lists[self.first_tile + tile_idx].push(entry);
                }
            }
        }
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        (self.tiles.capacity() + self.upper.capacity()) * size_of::<PointBoxes>()
            + self.occupancy.memory_usage()
    }
}

/// Brings boxes into columns, sixteen an entry.
fn group(boxes: impl Iterator<Item = PointBox>, groups: &mut Vec<PointBoxes>) {
    groups.clear();
    for (idx, one) in boxes.enumerate() {
        if idx % LANES == 0 {
            groups.push(PointBoxes::EMPTY);
        }
        if let Some(group) = groups.last_mut() {
            group.set(idx % LANES, &one);
        }
    }
}
