//! Brings the triangles of a block to its tiles.
//!
//! ```text
//!   choose   how many tiles, from how many there would be in each
//!   sort     triangles from near to far, unless they are to be a list
//!   list     them by tile: count, sum up, place
//!   write    leaves of sixteen
//! ```

use rayflock_geom::simd::LANES;
use rayflock_geom::simd::face_rows::{CELL_BITS, FaceRow};

use super::bin_triangles::{OtherRow, TileSettings};
use super::config::TileOrder;
use super::tile_grid::TileBlock;
use crate::triangle_leaf::TriangleLeaf;

/// Tiles are made smaller as long as there are no more than so many entries for each triangle.
const MOST_COPIES: f32 = 4.0;

/// Tiles along the side of a block are at most 2 to the power of this.
const FINEST_LEVEL: u32 = 7;

/// The depths of a leaf that no ray may leave out.
const ANYWHERE: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];

/// Bits of a triangle's place in its share.
const PLACE_BITS: u32 = 26;

/// Works out the tiles of one block after the other; memory is kept.
#[derive(Debug, Default)]
pub(super) struct BlockFiller {
    /// Triangles from near to far: nearness above share and place in it.
    sorted: Vec<u64>,
    /// For each tile, where its entries end.
    ends: Vec<u32>,
    /// Triangles by tile: share and place in it.
    entries: Vec<u32>,
}

/// Where a block is among the cells.
#[derive(Clone, Copy)]
struct Place {
    /// First column and row.
    first: [u32; 2],
    /// Cells along a side.
    cell_bits: u32,
}

impl BlockFiller {
    /// Fills a block, given its position and that there are `2^block_bits` a side, with its
    /// triangles, share by share.
    pub(super) fn fill<'a>(
        &mut self,
        block: &mut TileBlock,
        [block_idx, block_bits]: [usize; 2],
        tiles: TileSettings,
        shares: &[&[FaceRow]],
        others: impl Iterator<Item = &'a OtherRow> + Clone,
    ) {
        let block_bits = block_bits as u32;
        let cell_bits = CELL_BITS - block_bits;
        let (row, column) = (block_idx >> block_bits, block_idx & ((1 << block_bits) - 1));
        let first = [(column << cell_bits) as u32, (row << cell_bits) as u32];
        let place = Place { first, cell_bits };
        block.level = place.choose_level(tiles.fewest, shares, others.clone().count());
        self.sort(tiles.order, shares);
        self.list(&place, block.level, shares);
        self.write(block, tiles.order, shares);
        self.write_others(&place, block, others);
    }

    /// Sorts the triangles from near to far, unless they may stand as they come.
    fn sort(&mut self, order: TileOrder, shares: &[&[FaceRow]]) {
        self.sorted.clear();
        for (share_idx, share) in shares.iter().enumerate() {
            let first = (share_idx as u32) << PLACE_BITS;
            let keyed = share.iter().zip(first..);
            self.sorted.extend(keyed.map(|(row, entry)| {
                (u64::from(far_to_near(row.nearest())) << 32) | u64::from(entry)
            }));
        }
        if order == TileOrder::Depth {
            self.sorted.sort_unstable();
        }
    }

    /// Lists the triangles of each tile.
    fn list(&mut self, place: &Place, level: u32, shares: &[&[FaceRow]]) {
        self.ends.clear();
        self.ends.resize(1 << (2 * level), 0);
        for row in shares.iter().copied().flatten() {
            let cells = [row.columns(), row.rows()];
            place.for_tiles(cells, level, |tile_idx| self.ends[tile_idx] += 1);
        }
        sum_up(&mut self.ends);

        // Entries are placed from behind, so ends become beginnings.
        self.entries.resize(self.ends.last().copied().unwrap_or(0) as usize, 0);
        for &sorted in self.sorted.iter().rev() {
            let entry = sorted as u32;
            let row = row_of(shares, entry);
            place.for_tiles([row.columns(), row.rows()], level, |tile_idx| {
                self.ends[tile_idx] -= 1;
                self.entries[self.ends[tile_idx] as usize] = entry;
            });
        }
    }

    /// Lists the spheres and user primitives of all tiles.
    fn write_others<'a>(
        &mut self,
        place: &Place,
        block: &mut TileBlock,
        others: impl Iterator<Item = &'a OtherRow> + Clone,
    ) {
        block.first_others.clear();
        block.others.clear();
        if others.clone().next().is_none() {
            return;
        }
        let level = block.level;
        self.ends.clear();
        self.ends.resize((1 << (2 * level)) + 1, 0);
        for other in others.clone() {
            let cells = [other.columns, other.rows];
            place.for_tiles(cells, level, |tile_idx| self.ends[tile_idx] += 1);
        }
        sum_up(&mut self.ends);
        block.others.resize(self.ends.last().copied().unwrap_or(0) as usize, 0);
        for other in others {
            place.for_tiles([other.columns, other.rows], level, |tile_idx| {
                self.ends[tile_idx] -= 1;
                block.others[self.ends[tile_idx] as usize] = other.slot;
            });
        }
        block.first_others.extend_from_slice(&self.ends);
    }

    /// Writes the leaves of all tiles.
    fn write(&mut self, block: &mut TileBlock, order: TileOrder, shares: &[&[FaceRow]]) {
        block.first_leaves.clear();
        block.depths.clear();
        let mut leaf_count = 0;
        let begins = self.ends.iter().copied();
        let ends = begins.clone().skip(1).chain([self.entries.len() as u32]);
        for (begin, end) in begins.zip(ends) {
            block.first_leaves.push(leaf_count as u32);
            let entries = &self.entries[begin as usize..end as usize];
            for entries in entries.chunks(LANES) {
                if block.leaves.len() <= leaf_count {
                    block.leaves.push(TriangleLeaf::EMPTY);
                }
                let depths = write_leaf(&mut block.leaves[leaf_count], entries, shares);
                block.depths.push(match order {
                    TileOrder::Depth => depths,
                    TileOrder::List => ANYWHERE,
                });
                leaf_count += 1;
            }
        }
        block.first_leaves.push(leaf_count as u32);
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        (self.ends.capacity() + self.entries.capacity()) * size_of::<u32>()
            + self.sorted.capacity() * size_of::<u64>()
    }
}

/// Makes counts ends.
fn sum_up(counts: &mut [u32]) {
    let mut end = 0;
    for count in counts {
        end += *count;
        *count = end;
    }
}

impl Place {
    /// The finest level at which there are still enough primitives in a tile.
    fn choose_level(&self, fewest: u16, shares: &[&[FaceRow]], other_count: usize) -> u32 {
        let (mut count, mut around, mut area) = (other_count as f32, 0.0, 0.0);
        for row in shares.iter().copied().flatten() {
            let [columns, rows] = self.inside([row.columns(), row.rows()]);
            let (width, height) = ((columns[1] - columns[0]) as f32, (rows[1] - rows[0]) as f32);
            count += 1.0;
            around += width + height;
            area += width * height;
        }
        let most = FINEST_LEVEL.min(self.cell_bits);
        let enough = |level: &u32| {
            let tiles = (1_u32 << level) as f32;
            let size = tiles / (1_u32 << self.cell_bits) as f32;
            let entries = count + size * (around + size * area);
            entries >= f32::from(fewest) * tiles * tiles && entries <= MOST_COPIES * count
        };
        (1..=most).take_while(enough).last().unwrap_or(0)
    }

    /// Columns and rows of a primitive, counted from the block's first and cut off at its sides.
    #[inline(always)]
    fn inside(&self, [columns, rows]: [[u32; 2]; 2]) -> [[u32; 2]; 2] {
        let last = (1 << self.cell_bits) - 1;
        let cut = |[low, high]: [u32; 2], first: u32| {
            [low.saturating_sub(first), (high - first).min(last)]
        };
        [cut(columns, self.first[0]), cut(rows, self.first[1])]
    }

    /// Calls `visit` with each tile that has some of the columns and rows.
    #[inline(always)]
    fn for_tiles(&self, cells: [[u32; 2]; 2], level: u32, mut visit: impl FnMut(usize)) {
        let shift = self.cell_bits - level;
        let [columns, rows] = self.inside(cells);
        for tile_row in rows[0] >> shift..=rows[1] >> shift {
            for tile_column in columns[0] >> shift..=columns[1] >> shift {
                visit(((tile_row << level) | tile_column) as usize);
            }
        }
    }
}

/// Bits that are the larger the less near something is.
#[inline(always)]
fn far_to_near(nearness: f32) -> u32 {
    let bits = nearness.to_bits();
    if bits >> 31 == 0 { !(bits | 1 << 31) } else { bits }
}

#[inline(always)]
fn row_of<'a>(shares: &[&'a [FaceRow]], entry: u32) -> &'a FaceRow {
    &shares[(entry >> PLACE_BITS) as usize][(entry & ((1 << PLACE_BITS) - 1)) as usize]
}

/// Writes up to sixteen triangles; returns the largest and the least nearness of a hit.
#[inline(always)]
fn write_leaf(leaf: &mut TriangleLeaf, entries: &[u32], shares: &[&[FaceRow]]) -> [f32; 2] {
    let mut depths = [f32::NEG_INFINITY, f32::INFINITY];
    let columns = leaf.triangles.corners.as_flattened_mut();
    for (lane, &entry) in entries.iter().enumerate() {
        let row = row_of(shares, entry);
        for (column, &coordinate) in columns.iter_mut().zip(row.corners()) {
            column[lane] = coordinate;
        }
        leaf.masks[lane] = row.mask();
        leaf.ranks[lane] = row.rank();
        depths = [depths[0].max(row.nearest()), depths[1].min(row.farthest())];
    }
    leaf.masks[entries.len()..].fill(0);
    depths
}
