//! Triangles for those who look at each of them once: from the table where they are written, else
//! from their meshes, two blocks at a time.
//!
//! **Invariants.** Either way gives the same bits, but for triangles that are ignored: what is read
//! from meshes may be one of those.
//!
//! **Cost.** That of reading the corners: nothing that is written leaves the nearest cache, and
//! whether a triangle has an area is left to those who want to know.

use std::ops::Range;

use glam::Vec3;
use rayflock_geom::simd::ray_triangle::TriangleBlock;
use rayflock_geom::simd::{LANES, Simd, dispatch};
use rayflock_geom::transform_point;
use rayon::prelude::*;

use super::ignored::Ignored;
use super::plan::Work;
use super::table::PrimitiveTable;
use super::write_triangles::{BLOCKS_PER_TASK, Blocks, TriangleWriter};

/// Blocks that are read at once.
pub(crate) const BLOCKS_PER_READ: usize = 2;

/// Reads blocks one after the other.
#[derive(Debug)]
pub(crate) struct BlockReader<'a> {
    table: &'a PrimitiveTable,
    /// Objects before it have no triangle in blocks that are still to be read.
    object_idx: usize,
    corners: [TriangleBlock; BLOCKS_PER_READ],
    masks: [[u32; LANES]; BLOCKS_PER_READ],
}

/// Triangles of neighbouring blocks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TriangleBlocks<'a> {
    pub(crate) corners: &'a [TriangleBlock],
    /// Object masks; 0 for padding, and maybe for triangles that are ignored.
    pub(crate) masks: &'a [[u32; LANES]],
}

impl<'a> BlockReader<'a> {
    /// A reader of the blocks from `first_block` on.
    pub(crate) fn new(table: &'a PrimitiveTable, first_block: usize) -> Self {
        let first_slot = first_block * LANES;
        Self {
            table,
            object_idx: table.layout.objects_of_triangles(first_slot..first_slot + 1).start,
            corners: [TriangleBlock::EMPTY; BLOCKS_PER_READ],
            masks: [[0; LANES]; BLOCKS_PER_READ],
        }
    }

    /// The triangles of up to [`BLOCKS_PER_READ`] blocks, none of which comes before those that
    /// were read last.
    #[inline(always)]
    pub(crate) fn read<S: Simd>(&mut self, simd: S, blocks: Range<usize>) -> TriangleBlocks<'_> {
        let table = self.table;
        let objects = self.advance(&blocks);
        if table.pending[objects.clone()].iter().all(|&pending| pending == Work::Nothing) {
            let (corners, masks) = (&table.corners[blocks.clone()], &table.masks[blocks]);
            return TriangleBlocks { corners, masks };
        }
        let count = blocks.len();
        self.fill::<_, false>(simd, blocks, objects);
        TriangleBlocks { corners: &self.corners[..count], masks: &self.masks[..count] }
    }

    /// Objects that may have triangles in `blocks`.
    #[inline(always)]
    fn advance(&mut self, blocks: &Range<usize>) -> Range<usize> {
        let spans = self.table.spans();
        let is_done = |idx: usize| spans[idx].triangle_slots().end <= blocks.start * LANES;
        while self.object_idx < spans.len() && is_done(self.object_idx) {
            self.object_idx += 1;
        }
        let begins = |idx: usize| spans[idx].first_slot.triangles < blocks.end * LANES;
        let mut end = self.object_idx;
        while end < spans.len() && begins(end) {
            end += 1;
        }
        self.object_idx..end
    }

    /// Reads the triangles of some objects from their meshes; tells how many are ignored where they
    /// are `CHECKED`.
    #[inline(always)]
    fn fill<S: Simd, const CHECKED: bool>(
        &mut self,
        simd: S,
        blocks: Range<usize>,
        objects: Range<usize>,
    ) -> Ignored {
        let table = self.table;
        if blocks.end == table.triangle_block_count() {
            // Padding.
            self.corners[blocks.len() - 1] = TriangleBlock::EMPTY;
            self.masks[blocks.len() - 1] = [0; LANES];
        }
        let (corners, masks) = (&mut self.corners[..blocks.len()], &mut self.masks[..blocks.len()]);
        let mut blocks = Blocks { first_slot: blocks.start * LANES, corners, masks };
        let mut ignored = Ignored::default();
        for idx in objects {
            let (object, span) = (&table.geometry.objects()[idx], &table.layout.spans[idx]);
            let writer = TriangleWriter::new(object, span, Work::CornersAndMasks);
            ignored += writer.write::<_, CHECKED>(simd, &mut blocks);
        }
        ignored
    }
}

impl PrimitiveTable {
    /// Corners and object mask of the triangle of a slot, be they written or not; of one that is
    /// ignored, too.
    pub(crate) fn read_triangle(&self, slot: u32) -> ([Vec3; 3], u32) {
        let slot = slot as usize;
        let idx = self.layout.objects_of_triangles(slot..slot + 1).start;
        let (object, span) = (&self.geometry.objects()[idx], &self.layout.spans[idx]);
        let corners = object.shape.corners(slot - span.first_slot.triangles);
        let corners = object
            .world_from_object
            .as_ref()
            .map_or(corners, |transform| corners.map(|corner| transform_point(transform, corner)));
        (corners, object.mask)
    }

    /// Counts what is ignored.
    pub(super) fn count_ignored(&self) -> Ignored {
        let block_count = self.triangle_block_count();
        let tasks = (0..block_count.div_ceil(BLOCKS_PER_TASK)).into_par_iter();
        let counted = tasks.map(|task_idx| {
            let first = task_idx * BLOCKS_PER_TASK;
            let blocks = first..(first + BLOCKS_PER_TASK).min(block_count);
            dispatch!(self.simd.level(), simd => self.count_ignored_in(simd, blocks))
        });
        let others = self.others_ignored.iter().copied();
        others.fold(counted.reduce(Ignored::default, |a, b| a + b), |a, b| a + b)
    }

    #[inline(always)]
    fn count_ignored_in<S: Simd>(&self, simd: S, blocks: Range<usize>) -> Ignored {
        let mut reader = BlockReader::new(self, blocks.start);
        let mut ignored = Ignored::default();
        for first in blocks.clone().step_by(BLOCKS_PER_READ) {
            let some = first..(first + BLOCKS_PER_READ).min(blocks.end);
            let objects = reader.advance(&some);
            ignored += reader.fill::<_, true>(simd, some, objects);
        }
        ignored
    }
}
