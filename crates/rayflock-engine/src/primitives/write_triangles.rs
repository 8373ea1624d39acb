//! Writes corners and masks of the triangles of all objects that changed: thirty-two at a time
//! where an object fills both blocks, else one by one.
//!
//! **Invariants.** Either way of writing gives the same bits. A triangle that is ignored has three
//! corners at the origin; no other has coinciding corners.
//!
//! **Cost.** 36 bytes read and written a triangle, 4 more where masks may have changed. Soups are
//! read in place, vertices of other meshes through a small buffer.

use std::ops::Range;

use glam::{Affine3A, Vec3};
use rayflock_geom::simd::ray_triangle::TriangleBlock;
use rayflock_geom::simd::triangle_lanes::TriangleLanes;
use rayflock_geom::simd::triangle_rows::{ROW_COUNT, TriangleRow, columns_of_rows};
use rayflock_geom::simd::{LANES, Simd, SimdMask, dispatch};
use rayflock_geom::{GeometryObject, Mesh, is_degenerate_triangle, transform_point};
use rayon::prelude::*;
use tracing::debug_span;

use super::ignored::Ignored;
use super::plan::Work;
use super::span::ObjectSpan;
use super::table::PrimitiveTable;

/// Blocks that one task writes.
pub(super) const BLOCKS_PER_TASK: usize = 256;

/// Blocks of neighbouring slots, and where they lie.
struct Blocks<'a> {
    first_slot: usize,
    corners: &'a mut [TriangleBlock],
    masks: &'a mut [[u32; LANES]],
}

/// Writes the triangles of one object.
struct TriangleWriter<'a> {
    mesh: &'a Mesh,
    transform: Option<&'a Affine3A>,
    mask: u32,
    /// Whether masks hold `mask` already.
    masks_stand: bool,
    /// Slots of the object's triangles.
    slots: Range<usize>,
}

impl PrimitiveTable {
    /// Writes the triangles of all objects that changed.
    pub(super) fn write_triangles(&mut self) {
        let blocks = self.changed_triangle_blocks();
        let (simd, layout, plan) = (self.simd, &self.layout, &self.plan);
        let (objects, ignored) = (self.geometry.objects(), &self.ignored);
        let first_slot = blocks.start * LANES;
        let tasks = self.corners[blocks.clone()]
            .par_chunks_mut(BLOCKS_PER_TASK)
            .zip(self.masks[blocks].par_chunks_mut(BLOCKS_PER_TASK));
        tasks.enumerate().for_each(|(task_idx, (corners, masks))| {
            let _span = debug_span!("write_triangles").entered();
            let first_slot = first_slot + task_idx * BLOCKS_PER_TASK * LANES;
            let slots = first_slot..first_slot + corners.len() * LANES;
            let mut blocks = Blocks { first_slot, corners, masks };
            for idx in layout.objects_of_triangles(slots) {
                if plan[idx] != Work::Nothing {
                    let span = &layout.spans[idx];
                    let writer = TriangleWriter::new(&objects[idx], span, plan[idx]);
                    ignored[idx].add(dispatch!(simd.level(), simd => {
                        writer.write(simd, &mut blocks)
                    }));
                }
            }
        });
    }

    /// The blocks from the first to the last that holds a triangle of an object that changed.
    fn changed_triangle_blocks(&self) -> Range<usize> {
        let spans = self.layout.spans.iter().zip(&self.plan);
        let mut changed = spans
            .filter(|&(span, &work)| work != Work::Nothing && span.count.triangles > 0)
            .map(|(span, _)| span.triangle_slots());
        let Some(first) = changed.next() else { return 0..0 };
        let end = changed.next_back().map_or(first.end, |last| last.end);
        first.start / LANES..end.div_ceil(LANES)
    }
}

impl<'a> TriangleWriter<'a> {
    fn new(object: &'a GeometryObject, span: &ObjectSpan, work: Work) -> Self {
        Self {
            mesh: &object.shape,
            transform: object.world_from_object.as_ref(),
            mask: object.mask,
            masks_stand: work == Work::Corners,
            slots: span.triangle_slots(),
        }
    }

    /// Writes those of the object's triangles that lie in `blocks`; tells how many are ignored.
    #[inline(always)]
    fn write<S: Simd>(&self, simd: S, blocks: &mut Blocks<'_>) -> Ignored {
        let mut ignored = Ignored::default();
        let from = self.slots.start.max(blocks.first_slot);
        let to = self.slots.end.min(blocks.first_slot + blocks.corners.len() * LANES);
        let whole = from.next_multiple_of(LANES).min(to);
        for slot in from..whole {
            ignored += self.write_slot(slot, blocks);
        }
        let pairs_end = whole + (to - whole) / ROW_COUNT * ROW_COUNT;
        ignored += self.write_pairs(simd, whole..pairs_end, blocks);
        for slot in pairs_end..to {
            ignored += self.write_slot(slot, blocks);
        }
        ignored
    }

    /// Writes pairs of whole blocks.
    #[inline(always)]
    fn write_pairs<S: Simd>(
        &self,
        simd: S,
        slots: Range<usize>,
        blocks: &mut Blocks<'_>,
    ) -> Ignored {
        let mut ignored = Ignored::default();
        let mut staged = [[0.0; 9]; ROW_COUNT];
        for first_slot in slots.step_by(ROW_COUNT) {
            let first_idx = first_slot - self.slots.start;
            let rows = match self.mesh.soup().and_then(|soup| soup[first_idx..].first_chunk()) {
                Some(rows) => rows,
                None => {
                    stage_rows(self.mesh, first_idx, &mut staged);
                    &staged
                }
            };
            let [first, second] = columns_of_rows(simd, rows);
            let block_idx = (first_slot - blocks.first_slot) / LANES;
            ignored += self.write_block(simd, first, block_idx, blocks);
            ignored += self.write_block(simd, second, block_idx + 1, blocks);
        }
        ignored
    }

    /// Writes one block whose triangles are all the object's.
    #[inline(always)]
    fn write_block<S: Simd>(
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
        let doubtful = (!triangles.certainly_solid(simd)).to_bitmask();
        let (mut ignored, mut masks) = (Ignored::default(), [self.mask; LANES]);
        if doubtful != 0 {
            ignored = drop_degenerate(block, doubtful, &mut masks);
        }
        if !self.masks_stand || ignored != Ignored::default() {
            blocks.masks[block_idx] = masks;
        }
        ignored
    }

    /// Writes one triangle.
    fn write_slot(&self, slot: usize, blocks: &mut Blocks<'_>) -> Ignored {
        let mut corners = self.mesh.corners(slot - self.slots.start);
        if let Some(transform) = self.transform {
            corners = corners.map(|corner| transform_point(transform, corner));
        }
        let mut mask = self.mask;
        let mut ignored = Ignored::default();
        if is_degenerate_triangle(corners) {
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
