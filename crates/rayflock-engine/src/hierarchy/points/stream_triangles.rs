//! Streams the primitives past the faces: which of them may touch which band.
//!
//! Where most triangles may be far from every ray, the boxes around them are brought onto the face
//! first, sixteen at a time: those whose box holds no ray are done with. The others are projected,
//! asked once more, and become rows in the lists of the bands that they touch. What has no place on
//! the face goes by its slot.

use std::ops::Range;

use rayflock_geom::simd::axes::load_axes;
use rayflock_geom::simd::face_boxes::{FaceBoxes, SpaceBoxes};
use rayflock_geom::simd::ray_triangle::TriangleBlock;
use rayflock_geom::simd::strip_rows::{StripRow, write_strip_rows};
use rayflock_geom::simd::triangle_lanes::TriangleLanes;
use rayflock_geom::simd::{LANES, Lanes, Simd, SimdBase, SimdMask, f32x16, mask32x16, u32x16};

use super::ray_strips::{FaceStrips, RayStrips};
use super::staged::{Sixteen, Staged};
use crate::TraceStats;
use crate::primitives::{BLOCKS_PER_READ, BlockReader, PrimitiveTable};

/// What a task found: for each band, the primitives that may touch it.
#[derive(Debug, Default)]
pub(super) struct Chunk {
    pub(super) lists: Vec<Vec<StripRow>>,
    /// One for each face.
    staged: Vec<Staged>,
}

/// A block at hand.
#[derive(Clone, Copy)]
struct Block<'a, S: Simd> {
    block_idx: usize,
    ranks: &'a [u32; LANES],
    corners: [[f32x16<S>; 3]; 3],
    masks: u32x16<S>,
}

impl<S: Simd> Block<'_, S> {
    /// Which of its triangles a ray may see.
    #[inline(always)]
    fn is_there(&self, simd: S) -> mask32x16<S> {
        !self.masks.simd_eq(u32x16::splat(simd, 0))
    }

    /// Its triangles.
    #[inline(always)]
    fn triangles(&self, simd: S) -> Sixteen<S> {
        let ranks = u32x16::from_slice(simd, self.ranks);
        let slots = first_slots(simd) + u32x16::splat(simd, (self.block_idx * LANES) as u32);
        (self.corners, [slots, ranks, self.masks])
    }
}

/// Blocks and other primitives of one task.
#[derive(Clone, Copy, Debug)]
pub(super) struct Share {
    /// This is part `part_idx` of `part_count`.
    pub(super) part_idx: usize,
    pub(super) part_count: usize,
}

impl Share {
    fn of(self, count: usize) -> Range<usize> {
        count * self.part_idx / self.part_count..count * (self.part_idx + 1) / self.part_count
    }
}

impl Chunk {
    /// Streams a share of the table's primitives past the faces.
    #[inline(always)]
    pub(super) fn stream<S: Simd>(
        &mut self,
        simd: S,
        table: &PrimitiveTable,
        strips: &RayStrips,
        share: Share,
    ) -> TraceStats {
        self.lists.iter_mut().for_each(Vec::clear);
        if self.lists.len() < strips.bands.len() {
            self.lists.resize_with(strips.bands.len(), Vec::new);
        }
        if self.staged.len() < strips.faces.len() {
            self.staged.resize_with(strips.faces.len(), || Staged::EMPTY);
        }
        let mut stats = TraceStats::default();
        self.stream_blocks(simd, table, strips, share.of(table.triangle_block_count()), &mut stats);
        for face_idx in 0..strips.faces.len() {
            while self.staged[face_idx].len > 0 {
                self.place_staged(simd, strips, face_idx);
            }
        }
        self.place_others(table, strips, share);
        stats.pairs = self.lists.iter().map(|list| list.len() as u64).sum();
        stats.bytes += size_of::<StripRow>() as u64 * stats.pairs;
        stats
    }

    #[inline(always)]
    fn stream_blocks<S: Simd>(
        &mut self,
        simd: S,
        table: &PrimitiveTable,
        strips: &RayStrips,
        blocks: Range<usize>,
        stats: &mut TraceStats,
    ) {
        let mut reader = BlockReader::new(table, blocks.start);
        for first in blocks.clone().step_by(BLOCKS_PER_READ) {
            let read = reader.read(simd, first..(first + BLOCKS_PER_READ).min(blocks.end));
            for (idx, (corners, masks)) in read.corners.iter().zip(read.masks).enumerate() {
                let block = Block {
                    block_idx: first + idx,
                    ranks: table.ranks(first + idx),
                    corners: load_corners(simd, corners),
                    masks: u32x16::from_slice(simd, masks),
                };
                self.stream_block(simd, strips, &block, stats);
            }
        }
    }

    #[inline(always)]
    fn stream_block<S: Simd>(
        &mut self,
        simd: S,
        strips: &RayStrips,
        block: &Block<'_, S>,
        stats: &mut TraceStats,
    ) {
        stats.bytes += (9 * size_of::<Lanes>()) as u64;
        if let [FaceStrips { asks_occupancy: false, .. }] = &strips.faces[..] {
            // Boxes would leave most of them.
            stats.box_tests += LANES as u64;
            self.place(simd, strips, 0, &block.triangles(simd), block.is_there(simd));
            return;
        }
        let boxes = SpaceBoxes::around(simd, &block.corners, strips.faces[0].face.center);
        if strips.is_cube() {
            for axis in 0..3 {
                for (sign, boxed) in boxes.on_sides(simd, axis).iter().enumerate() {
                    let face_idx = 2 * axis + sign;
                    stats.box_tests += self.stage(simd, strips, block, boxed, face_idx);
                }
            }
        } else {
            let boxed = strips.faces[0].face.place_boxes(simd, &boxes);
            stats.box_tests += self.stage(simd, strips, block, &boxed, 0);
        }
    }

    /// Has those triangles of a block wait that may touch rays of a face. Returns how many were
    /// asked.
    #[inline(always)]
    fn stage<S: Simd>(
        &mut self,
        simd: S,
        strips: &RayStrips,
        block: &Block<'_, S>,
        boxed: &FaceBoxes<S>,
        face_idx: usize,
    ) -> u64 {
        let face = &strips.faces[face_idx];
        if face.is_empty() {
            return 0;
        }
        let touches = block.is_there(simd) & !boxed.behind;
        let asked = touches & boxed.certain;
        let near = asked & overlaps(simd, &boxed.bounds, &face.bounds);
        let kept = (touches & !asked) | face.keep(simd, &boxed.bounds, near, false);
        if kept.any_true() {
            let staged = &mut self.staged[face_idx];
            staged.append(simd, &block.triangles(simd), kept);
            if staged.len >= LANES {
                self.place_staged(simd, strips, face_idx);
            }
        }
        LANES as u64
    }

    /// Places the first sixteen triangles of a face that wait, or as many as there are.
    #[inline(always)]
    fn place_staged<S: Simd>(&mut self, simd: S, strips: &RayStrips, face_idx: usize) {
        let staged = &mut self.staged[face_idx];
        let waiting = mask32x16::from_bitmask(simd, (1 << staged.len.min(LANES)) - 1);
        let triangles = staged.take(simd);
        self.place(simd, strips, face_idx, &triangles, waiting);
    }

    /// Projects those of sixteen triangles that are `waiting`, and lists those that may be hit.
    #[inline(always)]
    fn place<S: Simd>(
        &mut self,
        simd: S,
        strips: &RayStrips,
        face_idx: usize,
        &(corners, [slots, ranks, masks]): &Sixteen<S>,
        waiting: mask32x16<S>,
    ) {
        let face = &strips.faces[face_idx];
        let waiting = waiting & TriangleLanes { corners }.solid(simd);
        let placed = face.face.project_triangles(simd, &corners);
        let rare = waiting & !placed.placed & !placed.behind;
        if rare.any_true() {
            let mut triangles = TriangleBlock::EMPTY;
            TriangleLanes { corners }.store(&mut triangles);
            self.list_rare(strips, face_idx, (&triangles, &slots), rare.to_bitmask());
        }
        let touches = waiting & placed.placed & overlaps(simd, &placed.bounds, &face.bounds);
        let mut touches = face.keep(simd, &placed.bounds, touches, true).to_bitmask();
        if touches == 0 {
            return;
        }
        let [low, high] = face.box_strips(simd, &placed.bounds);
        let mut rows = [StripRow::EMPTY; LANES];
        let bits = [slots, ranks, masks, low | (high << 16)];
        write_strip_rows(simd, corners, bits, &mut rows);
        while touches != 0 {
            let row = &rows[touches.trailing_zeros() as usize];
            touches &= touches - 1;
            self.list(strips, face_idx, row.strips(), row);
        }
    }

    /// Lists a primitive for all bands that have a cell of the strips from the first to the last.
    #[inline(always)]
    fn list(
        &mut self,
        strips: &RayStrips,
        face_idx: usize,
        [low, high]: [usize; 2],
        row: &StripRow,
    ) {
        let first_strip = strips.faces[face_idx].first_strip;
        let [first, _] = strips.bands_of_strip[first_strip + low];
        let [_, last] = strips.bands_of_strip[first_strip + high];
        for list in &mut self.lists[first as usize..=last as usize] {
            list.push(*row);
        }
    }

    /// Lists triangles that have no box on a face, unless they lie beside all of its rays.
    #[inline(never)]
    fn list_rare(
        &mut self,
        strips: &RayStrips,
        face_idx: usize,
        (triangles, slots): (&TriangleBlock, &[u32; LANES]),
        mut lanes: u64,
    ) {
        let face = &strips.faces[face_idx];
        let [x0, x1, y0, y1] = face.bounds;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let Some(placed) = face.face.place_triangle(triangles.get(lane)) else { continue };
            let ends = placed.clip_x([y0, y1], [x0, x1]);
            let [low, high] = placed.clip_y(ends, [y0, y1]);
            if ends[0] <= ends[1] && low <= high {
                let touched = face.strips([low, high]);
                self.list(strips, face_idx, touched, &StripRow::of_slot(slots[lane]));
            }
        }
    }

    /// Lists a share of the spheres and user primitives.
    fn place_others(&mut self, table: &PrimitiveTable, strips: &RayStrips, share: Share) {
        let own = share.of(table.other_slots().count());
        for slot in table.other_slots().skip(own.start).take(own.len()) {
            if table.mask(slot) == 0 {
                continue;
            }
            for (face_idx, face) in strips.faces.iter().enumerate() {
                let placed = face.face.place_sphere(&table.bound(slot), table.slack());
                if let Some(placed) = placed.filter(|_| !face.is_empty()) {
                    let [_, _, y0, y1] = placed.bounds;
                    let touched = face.strips([y0, y1]);
                    self.list(strips, face_idx, touched, &StripRow::of_slot(slot));
                }
            }
        }
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        let lists: usize =
            self.lists.iter().map(|list| list.capacity() * size_of::<StripRow>()).sum();
        lists
            + self.lists.capacity() * size_of::<Vec<StripRow>>()
            + self.staged.capacity() * size_of::<Staged>()
    }
}

#[inline(always)]
pub(super) fn load_corners<S: Simd>(simd: S, block: &TriangleBlock) -> [[f32x16<S>; 3]; 3] {
    let [a, b, c] = &block.corners;
    [load_axes(simd, a), load_axes(simd, b), load_axes(simd, c)]
}

/// Which boxes overlap the one box.
#[inline(always)]
pub(super) fn overlaps<S: Simd>(simd: S, boxes: &[f32x16<S>; 4], one: &[f32; 4]) -> mask32x16<S> {
    let [x0, x1, y0, y1] = *one;
    let splat = f32x16::splat;
    boxes[0].simd_le(splat(simd, x1))
        & boxes[1].simd_ge(splat(simd, x0))
        & boxes[2].simd_le(splat(simd, y1))
        & boxes[3].simd_ge(splat(simd, y0))
}

/// The numbers 0 to 15.
#[inline(always)]
fn first_slots<S: Simd>(simd: S) -> u32x16<S> {
    const FIRST: [u32; LANES] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];
    u32x16::from_slice(simd, &FIRST)
}
