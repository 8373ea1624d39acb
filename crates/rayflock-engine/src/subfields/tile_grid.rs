//! The tiles of a face and the primitives that each may be hit by.
//!
//! ```text
//!   face      2^16 x 2^16 cells in a window around the primitives
//!   blocks    squares of cells, the same size everywhere; each is filled by one task
//!   tiles     squares of cells, as small as the primitives of their block are worth
//!   leaves    a tile's triangles from near to far, sixteen a leaf
//! ```
//!
//! What stands in a block is valid if it has the stamp of the frame: nothing is cleared when a
//! frame ends, memory is taken over by what is written next.
//!
//! **Invariants.** A primitive that a ray of the direction may hit is in the leaves of the tile
//! that the ray's point lies in, or among those that have no place.

use std::ops::Range;

use rayflock_geom::simd::face_rows::{CELL_BITS, Window};

use crate::triangle_leaf::TriangleLeaf;

/// The tiles of a face. See the [module](self).
#[derive(Debug)]
pub(super) struct TileGrid {
    pub(super) window: Window,
    /// There are 2^b x 2^b blocks.
    pub(super) block_bits: u32,
    pub(super) blocks: Vec<TileBlock>,
    /// Slots of primitives that may be hit anywhere.
    pub(super) everywhere: Vec<u32>,
    /// Blocks with this stamp are valid.
    pub(super) frame: u64,
    /// The least and the largest depth of a hit.
    pub(super) depths: [f32; 2],
    /// No coordinate of a primitive is larger.
    pub(super) reach: f32,
    /// By how much the depth of a hit may differ from that of its primitive.
    pub(super) depth_error: f32,
}

/// A square of tiles, with memory of its own.
#[derive(Debug, Default)]
pub(super) struct TileBlock {
    /// The frame in which this was written.
    pub(super) frame: u64,
    /// There are 2^l x 2^l tiles.
    pub(super) level: u32,
    /// For each tile, where its leaves begin; after the last, their number.
    pub(super) first_leaves: Vec<u32>,
    pub(super) leaves: Vec<TriangleLeaf>,
    /// For each leaf, the largest and the least nearness of a hit.
    pub(super) depths: Vec<[f32; 2]>,
    /// For each tile, where its slots begin; nothing where the block has no other primitives.
    pub(super) first_others: Vec<u32>,
    /// Slots of spheres and user primitives.
    pub(super) others: Vec<u32>,
}

/// The place of a cell: row and column, sixteen bits each.
pub(super) type Cell = u32;

impl Default for TileGrid {
    fn default() -> Self {
        Self {
            window: Window::default(),
            block_bits: 1,
            blocks: Vec::new(),
            everywhere: Vec::new(),
            frame: 0,
            depths: [f32::INFINITY, f32::NEG_INFINITY],
            reach: 0.0,
            depth_error: 0.0,
        }
    }
}

impl TileGrid {
    /// The block of a cell.
    #[inline(always)]
    pub(super) fn block_idx(&self, cell: Cell) -> usize {
        let (column, row) = (cell & 0xffff, cell >> CELL_BITS);
        let shift = CELL_BITS - self.block_bits;
        (((row >> shift) << self.block_bits) | (column >> shift)) as usize
    }

    /// The tile of a cell within its block.
    #[inline(always)]
    pub(super) fn tile_idx(&self, cell: Cell, level: u32) -> usize {
        let (column, row) = (cell & 0xffff, cell >> CELL_BITS);
        let shift = CELL_BITS - self.block_bits - level;
        let inside = (1 << level) - 1;
        ((((row >> shift) & inside) << level) | ((column >> shift) & inside)) as usize
    }

    /// Whether this frame has nothing in the tiles.
    pub(super) fn is_empty(&self) -> bool {
        self.depths[0] > self.depths[1]
    }

    /// The block, if this frame has written it.
    #[inline(always)]
    pub(super) fn valid_block(&self, block_idx: usize) -> Option<&TileBlock> {
        let block = &self.blocks[block_idx];
        (block.frame == self.frame).then_some(block)
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.blocks.iter().map(TileBlock::memory_usage).sum::<usize>()
            + self.blocks.capacity() * size_of::<TileBlock>()
            + self.everywhere.capacity() * size_of::<u32>()
    }
}

impl TileBlock {
    /// The leaves of a tile.
    #[inline(always)]
    pub(super) fn leaves_of(&self, tile_idx: usize) -> Range<usize> {
        self.first_leaves[tile_idx] as usize..self.first_leaves[tile_idx + 1] as usize
    }

    /// The slots of a tile's spheres and user primitives.
    #[inline(always)]
    pub(super) fn others_of(&self, tile_idx: usize) -> &[u32] {
        if self.others.is_empty() {
            return &[];
        }
        let first = self.first_others[tile_idx] as usize;
        &self.others[first..self.first_others[tile_idx + 1] as usize]
    }

    /// Bytes held.
    fn memory_usage(&self) -> usize {
        let words = self.first_leaves.capacity()
            + self.first_others.capacity()
            + self.others.capacity()
            + 2 * self.depths.capacity();
        words * size_of::<u32>() + self.leaves.capacity() * size_of::<TriangleLeaf>()
    }
}
