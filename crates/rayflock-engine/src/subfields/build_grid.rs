//! Builds the grid of a face over some primitives.

use rayflock_geom::simd::face_rows::{FaceRow, Window};
use rayon::prelude::*;
use tracing::debug_span;

use super::bin_triangles::{Projection, TriangleBins};
use super::fill_block::BlockFiller;
use super::tile_grid::{TileBlock, TileGrid};
use crate::scratch::Scratch;

/// The work of a grid is divided into at most so many tasks.
pub(super) const MOST_TASKS: usize = 64;

/// Primitives wanted in a block.
const BLOCK_LEN: usize = 1024;

/// There are at most 2 to the power of this blocks along a side.
const MOST_BLOCK_BITS: u32 = 5;

/// Memory of builds that are not running.
#[derive(Debug, Default)]
pub(super) struct GridBuilder {
    bins: Scratch<TriangleBins>,
    fillers: Scratch<BlockFiller>,
}

impl GridBuilder {
    /// Makes `grid` hold the primitives of a frame.
    pub(super) fn build(&self, from: &Projection<'_>, frame: u64, grid: &mut TileGrid) {
        let extent = from.measure();
        let prim_count = from.wanted.prim_count();
        grid.frame = frame;
        grid.depths = [-extent.nearness[0], -extent.nearness[1]];
        grid.reach = extent.reach().max(0.0);
        grid.depth_error = extent.depth_error;
        grid.window = Window::around(extent.bounds);
        grid.block_bits = block_bits(prim_count);
        let mut bins = self.bins.take();
        bins.fill(from, &grid.window, grid.block_bits);
        grid.everywhere.clear();
        grid.everywhere.extend(bins.everywhere());
        self.fill_blocks(from, &bins, grid);
        self.bins.give_back(bins);
    }

    /// Fills the blocks that have primitives; the others keep an old stamp.
    fn fill_blocks(&self, from: &Projection<'_>, bins: &TriangleBins, grid: &mut TileGrid) {
        let _span = debug_span!("fill_blocks").entered();
        let (block_bits, frame) = (grid.block_bits, grid.frame);
        let block_count = 1 << (2 * block_bits);
        if grid.blocks.len() < block_count {
            grid.blocks.resize_with(block_count, TileBlock::default);
        }
        let blocks = grid.blocks[..block_count].par_iter_mut().enumerate();
        // In one piece, nothing of it goes to another thread.
        let piece = if from.task_count == 1 { block_count } else { 1 };
        blocks.with_min_len(piece).for_each(|(block_idx, block)| {
            let mut all = [&[][..]; MOST_TASKS];
            let shares = all.iter_mut().zip(bins.of_block(block_idx));
            let count = shares.map(|(place, share)| *place = share).count();
            let shares: &[&[FaceRow]] = &all[..count];
            let others = bins.others_of_block(block_idx);
            if shares.iter().all(|share| share.is_empty()) && others.clone().next().is_none() {
                return;
            }
            let mut filler = self.fillers.take();
            filler.fill(block, [block_idx, block_bits as usize], from.tiles, shares, others);
            self.fillers.give_back(filler);
            block.frame = frame;
        });
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.bins.sum(TriangleBins::memory_usage) + self.fillers.sum(BlockFiller::memory_usage)
    }
}

fn block_bits(prim_count: usize) -> u32 {
    let enough = |bits: &u32| prim_count >> (2 * bits) <= BLOCK_LEN;
    (1..MOST_BLOCK_BITS).find(enough).unwrap_or(MOST_BLOCK_BITS)
}
