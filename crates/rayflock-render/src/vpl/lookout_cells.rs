//! Points of a run by the lookouts that they share, sixteen lookouts a cell, ready to be lit.
//!
//! ```text
//!              lane:  0   1   2  ...  15
//!   lookouts          o   o   o        o       a cell
//!   block 0           p   p   p        p       block k holds the k-th point of each lookout
//!   block 1           p   p   p        p
//!   ...
//! ```
//!
//! **Cost**: about 100 bytes a point.

use glam::Vec3;
use rayflock_geom::simd::LANES;

use super::gather::GatherStats;
use super::gather_past_spheres::hand_out;
use super::light_blocks::LitBlock;
use crate::occluders::{Alike, LookoutTile, SharedLookouts};
use crate::wave::{Contribution, ShadedRun};

/// The cells of a run; memory is kept from wave to wave.
#[derive(Debug, Default)]
pub(super) struct LookoutCells {
    cells: Vec<Cell>,
    blocks: Vec<LitBlock>,
    /// Places of the points of the blocks in the run.
    members: Vec<[u32; LANES]>,
    sharing: SharedLookouts,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
}

/// Sixteen lookouts with as many points each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    /// About the middle.
    pub(super) center: Vec3,
    /// A bit for each lookout, the first as the lowest; of the last cell of a tile some may be none.
    pub(super) lookouts: u32,
    block_count: usize,
}

impl LookoutCells {
    /// Makes these the cells of the points of `run`; those that share a lookout are `alike`.
    pub(super) fn assign(&mut self, run: &ShadedRun, alike: Alike) {
        let points = &run.points[..];
        let Self { cells, blocks, members, sharing, positions, normals } = self;
        positions.clear();
        normals.clear();
        positions.extend(points.iter().map(|point| point.shadow_position));
        normals.extend(points.iter().map(|point| point.normal));
        cells.clear();
        blocks.clear();
        members.clear();
        sharing.for_each_tile(positions, normals, alike, |tile| {
            let LookoutTile { lookouts, per_lookout, .. } = tile;
            cells.extend(tile.blocks.chunks(*per_lookout).map(|blocks| {
                let count = blocks[0].iter().filter(|&&idx| (idx as usize) < points.len()).count();
                let lookouts_of_cell = (1 << count) - 1;
                let (center, lookouts) = (lookouts.center(), lookouts_of_cell);
                Cell { center, lookouts, block_count: blocks.len() }
            }));
            members.extend_from_slice(&tile.blocks);
            blocks.extend(tile.blocks.iter().map(|block| {
                LitBlock::new(block.iter().filter_map(|&idx| points.get(idx as usize)))
            }));
        });
    }

    /// Number of cells.
    pub(super) const fn len(&self) -> usize {
        self.cells.len()
    }

    /// The cells with the blocks of their points.
    pub(super) fn iter(&self) -> impl Iterator<Item = (&Cell, &[LitBlock])> {
        let mut blocks = &self.blocks[..];
        self.cells.iter().map(move |cell| {
            let (own, others) = blocks.split_at(cell.block_count);
            blocks = others;
            (cell, own)
        })
    }

    /// The same, to be added to.
    pub(super) fn iter_mut(&mut self) -> impl Iterator<Item = (&Cell, &mut [LitBlock])> {
        let mut blocks = &mut self.blocks[..];
        self.cells.iter().map(move |cell| {
            let (own, others) = std::mem::take(&mut blocks).split_at_mut(cell.block_count);
            blocks = others;
            (cell, own)
        })
    }

    /// Leaves what came to the points as `lit` of their run, one entry a point.
    pub(super) fn hand_out(&self, run: &mut ShadedRun) -> GatherStats {
        let ShadedRun { points, lit, .. } = run;
        lit.clear();
        lit.extend(
            points
                .iter()
                .map(|point| Contribution { pixel_idx: point.pixel_idx, radiance: Vec3::ZERO }),
        );
        let mut stats = GatherStats::default();
        hand_out((&self.blocks, &self.members), points, lit, &mut stats);
        stats
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.cells.capacity() * size_of::<Cell>()
            + self.blocks.capacity() * size_of::<LitBlock>()
            + self.members.capacity() * size_of::<[u32; LANES]>()
            + (self.positions.capacity() + self.normals.capacity()) * size_of::<Vec3>()
    }
}
