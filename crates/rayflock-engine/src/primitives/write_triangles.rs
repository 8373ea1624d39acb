//! Writes corners and masks of triangles: thirty-two at a time
//! where an object fills both blocks, else one by one.
//!
//! **Invariants.** Either way of writing gives the same bits. In the table, a triangle that is
//! ignored has three corners at the origin; no other has coinciding corners.
//!
//! **Cost.** 36 bytes read and written a triangle, 4 more where masks may have changed. Soups are
//! read in place, vertices of other meshes through a small buffer.

use std::ops::Range;
use std::sync::atomic::Ordering;

use glam::{Affine3A, Vec3};
use rayflock_geom::simd::ray_triangle::TriangleBlock;
use rayflock_geom::simd::triangle_lanes::TriangleLanes;
use rayflock_geom::simd::triangle_rows::{ROW_COUNT, TriangleRow, columns_of_rows};
use rayflock_geom::simd::{LANES, Simd, SimdMask, dispatch};
use rayflock_geom::{GeometryObject, Mesh, is_degenerate_triangle, prefetch, transform_point};
use rayon::prelude::*;
use tracing::debug_span;

use super::ignored::Ignored;
use super::plan::Work;
use super::span::ObjectSpan;
use super::table::PrimitiveTable;

/// How many triangles ahead of those at hand are asked for. It took passing a million of them from
/// 4.5 to 3.6 ms (two AVX-512 server cores).
const AHEAD: usize = 128;

/// Blocks that one task writes.
pub(super) const BLOCKS_PER_TASK: usize = 256;

/// Blocks of neighbouring slots, and where they lie.
pub(super) struct Blocks<'a> {
    pub(super) first_slot: usize,
    pub(super) corners: &'a mut [TriangleBlock],
    pub(super) masks: &'a mut [[u32; LANES]],
}

/// Writes the triangles of one object.
pub(super) struct TriangleWriter<'a> {
    mesh: &'a Mesh,
    transform: Option<&'a Affine3A>,
    mask: u32,
    /// Whether masks hold `mask` already.
    masks_stand: bool,
    /// Slots of the object's triangles.
    slots: Range<usize>,
}

impl PrimitiveTable {
    /// Writes the triangles of all objects that changed since they were written last.
    pub(crate) fn write_triangles(&mut self) {
        self.corners.resize(self.triangle_block_count(), TriangleBlock::EMPTY);
        let blocks = self.pending_blocks();
        for (leaves_out, pending) in self.leaves_out.iter_mut().zip(&self.pending) {
            *leaves_out.get_mut() &= *pending == Work::Nothing;
        }
        let (simd, layout, pending) = (self.simd, &self.layout, &self.pending);
        let (objects, leaves_out) = (self.geometry.objects(), &self.leaves_out);
        let first_slot = blocks.start * LANES;
        let tasks = self.corners[blocks.clone()]
            .par_chunks_mut(BLOCKS_PER_TASK)
            .zip(self.masks[blocks].par_chunks_mut(BLOCKS_PER_TASK));
        tasks.enumerate().for_each(|(task_idx, (corners, masks))| {
            let _span = debug_span!("write_triangles").entered();
            let first_slot = first_slot + task_idx * BLOCKS_PER_TASK * LANES;
            let mut blocks = Blocks { first_slot, corners, masks };
            for idx in layout.objects_of_triangles(blocks.slots()) {
                if pending[idx] != Work::Nothing {
                    let span = &layout.spans[idx];
                    let writer = TriangleWriter::new(&objects[idx], span, pending[idx]);
                    let ignored = dispatch!(simd.level(), simd => {
                        writer.write::<_, true>(simd, &mut blocks)
                    });
                    if ignored != Ignored::default() {
                        leaves_out[idx].store(true, Ordering::Relaxed);
                    }
                }
            }
        });
        self.pending.fill(Work::Nothing);
    }

    /// The blocks from the first to the last that holds a triangle that is to be written.
    fn pending_blocks(&self) -> Range<usize> {
        let spans = self.layout.spans.iter().zip(&self.pending);
        let mut pending = spans
            .filter(|&(span, &work)| work != Work::Nothing && span.count.triangles > 0)
            .map(|(span, _)| span.triangle_slots());
        let Some(first) = pending.next() else { return 0..0 };
        let end = pending.next_back().map_or(first.end, |last| last.end);
        first.start / LANES..end.div_ceil(LANES)
    }
}

impl Blocks<'_> {
    pub(super) fn slots(&self) -> Range<usize> {
        self.first_slot..self.first_slot + self.corners.len() * LANES
    }
}

impl<'a> TriangleWriter<'a> {
    pub(super) fn new(object: &'a GeometryObject, span: &ObjectSpan, work: Work) -> Self {
        Self {
            mesh: &object.shape,
            transform: object.world_from_object.as_ref(),
            mask: object.mask,
            masks_stand: work == Work::Corners,
            slots: span.triangle_slots(),
        }
    }

    /// Writes those of the object's triangles that lie in `blocks`. Where they are `CHECKED`, takes
    /// out those that are ignored, and tells how many.
    #[inline(always)]
    pub(super) fn write<S: Simd, const CHECKED: bool>(
        &self,
        simd: S,
        blocks: &mut Blocks<'_>,
    ) -> Ignored {
        let mut ignored = Ignored::default();
        let there = blocks.slots();
        let (from, to) = (self.slots.start.max(there.start), self.slots.end.min(there.end));
        let whole = from.next_multiple_of(LANES).min(to);
        for slot in from..whole {
            ignored += self.write_slot::<CHECKED>(slot, blocks);
        }
        let pairs_end = whole + (to - whole) / ROW_COUNT * ROW_COUNT;
        ignored += self.write_pairs::<_, CHECKED>(simd, whole..pairs_end, blocks);
        for slot in pairs_end..to {
            ignored += self.write_slot::<CHECKED>(slot, blocks);
        }
        ignored
    }

    /// Writes pairs of whole blocks.
    #[inline(always)]
    fn write_pairs<S: Simd, const CHECKED: bool>(
        &self,
        simd: S,
        slots: Range<usize>,
        blocks: &mut Blocks<'_>,
    ) -> Ignored {
        let mut ignored = Ignored::default();
        let mut staged = [[0.0; 9]; ROW_COUNT];
        for first_slot in slots.step_by(ROW_COUNT) {
            let first_idx = first_slot - self.slots.start;
            let rows = match self.rows_at(first_idx) {
                Some(rows) => {
                    self.rows_at(first_idx + AHEAD).into_iter().for_each(prefetch);
                    rows
                }
                None => {
                    stage_rows(self.mesh, first_idx, &mut staged);
                    &staged
                }
            };
            let [first, second] = columns_of_rows(simd, rows);
            let block_idx = (first_slot - blocks.first_slot) / LANES;
            ignored += self.write_block::<_, CHECKED>(simd, first, block_idx, blocks);
            ignored += self.write_block::<_, CHECKED>(simd, second, block_idx + 1, blocks);
        }
        ignored
    }

    /// The triangles from `first_idx` on, where they lie in memory as they are wanted.
    #[inline(always)]
    fn rows_at(&self, first_idx: usize) -> Option<&[TriangleRow; ROW_COUNT]> {
        self.mesh.soup()?.get(first_idx..)?.first_chunk()
    }

    /// Writes one block whose triangles are all the object's.
    #[inline(always)]
    fn write_block<S: Simd, const CHECKED: bool>(
        &self,
        simd: S,
        mut triangles: TriangleLanes<S>,
        block_idx: usize,
        blocks: &mut Blocks<'_>,
    ) -> Ignored {
        if let Some(transform) = self.transform {
            triangles = triangles.transformed(simd, transform);
        }
        let block = &mut blocks.corners[block_idx];
        triangles.store(block);
        let (mut ignored, mut masks) = (Ignored::default(), [self.mask; LANES]);
        if CHECKED {
            let doubtful = (!triangles.certainly_solid(simd)).to_bitmask();
            if doubtful != 0 {
                ignored = drop_degenerate(block, doubtful, &mut masks);
            }
        }
        if !self.masks_stand || ignored != Ignored::default() {
            blocks.masks[block_idx] = masks;
        }
        ignored
    }

    /// Writes one triangle.
    fn write_slot<const CHECKED: bool>(&self, slot: usize, blocks: &mut Blocks<'_>) -> Ignored {
        let mut corners = self.mesh.corners(slot - self.slots.start);
        if let Some(transform) = self.transform {
            corners = corners.map(|corner| transform_point(transform, corner));
        }
        let mut mask = self.mask;
        let mut ignored = Ignored::default();
        if CHECKED && is_degenerate_triangle(corners) {
            ignored = Ignored::of_triangle(corners);
            (corners, mask) = ([Vec3::ZERO; 3], 0);
        }
        let (block_idx, lane) = ((slot - blocks.first_slot) / LANES, slot % LANES);
        blocks.corners[block_idx].set(lane, corners);
        blocks.masks[block_idx][lane] = mask;
        ignored
    }
}

/// Brings the corners of triangles of any mesh together.
#[inline(always)]
fn stage_rows(mesh: &Mesh, first_idx: usize, rows: &mut [TriangleRow; ROW_COUNT]) {
    let (triangles, vertices) = (&mesh.triangles()[first_idx..], mesh.vertices());
    for (row, &[a, b, c]) in rows.iter_mut().zip(triangles) {
        let (a, b, c) = (vertices[a as usize], vertices[b as usize], vertices[c as usize]);
        *row = [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z];
    }
}

/// Takes the triangles out that are degenerate, asking those in `doubtful`.
#[cold]
fn drop_degenerate(
    block: &mut TriangleBlock,
    mut doubtful: u64,
    masks: &mut [u32; LANES],
) -> Ignored {
    let mut ignored = Ignored::default();
    while doubtful != 0 {
        let lane = doubtful.trailing_zeros() as usize;
        doubtful &= doubtful - 1;
        let corners = block.get(lane);
        if is_degenerate_triangle(corners) {
            ignored += Ignored::of_triangle(corners);
            block.set(lane, [Vec3::ZERO; 3]);
            masks[lane] = 0;
        }
    }
    ignored
}
