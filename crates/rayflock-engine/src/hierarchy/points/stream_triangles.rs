//! Streams the primitives past the faces: which of them may touch which tile.
//!
//! Boxes around blocks of sixteen triangles are brought onto the face; triangles whose box touches
//! the rays' are compressed, projected sixteen at a time, asked once more, set up, written down,
//! and listed for the tiles they touch.

use rayflock_geom::simd::face_triangle::{FaceTriangle, set_up};
use rayflock_geom::simd::ray_triangle::TriangleBlock;
use rayflock_geom::simd::{LANES, Lanes, Simd, SimdBase, SimdMask, f32x16, mask32x16, u32x16};

use super::point_tiles::FaceTiles;
use crate::TraceStats;
use crate::primitives::PrimitiveTable;

/// What a task found: primitives that may be hit, and for each tile which.
#[derive(Debug, Default)]
pub(super) struct Chunk {
    pub(super) triangles: Vec<FaceTriangle>,
    /// Entries of `triangles`, one list a tile.
    pub(super) lists: Vec<Vec<u32>>,
    /// One for each face.
    staged: Vec<Staged>,
}

/// Triangles that wait until there are sixteen of them.
#[derive(Debug)]
struct Staged {
    corners: [[[f32; 2 * LANES]; 3]; 3],
    /// Slots, ranks and masks.
    identity: [[u32; 2 * LANES]; 3],
    len: usize,
}

impl Staged {
    const EMPTY: Self =
        Self { corners: [[[0.0; 2 * LANES]; 3]; 3], identity: [[0; 2 * LANES]; 3], len: 0 };

    /// Appends the triangles of a block that are `kept`.
    #[inline(always)]
    fn append<S: Simd>(
        &mut self,
        simd: S,
        corners: &[[f32x16<S>; 3]; 3],
        identity: [u32x16<S>; 3],
        kept: mask32x16<S>,
    ) {
        let place = self.len..self.len + LANES;
        for (columns, corner) in self.corners.iter_mut().zip(corners) {
            for (column, &axis) in columns.iter_mut().zip(corner) {
                let kept = simd.compress_f32x16(axis, kept);
                kept.store_slice(&mut column[place.clone()]);
            }
        }
        for (column, identity) in self.identity.iter_mut().zip(identity) {
            let kept = simd.compress_u32x16(identity, kept);
            kept.store_slice(&mut column[place.clone()]);
        }
        self.len += kept.to_bitmask().count_ones() as usize;
    }

    /// Takes out the first sixteen triangles.
    #[inline(always)]
    fn take(&mut self, block: &mut TriangleBlock, identity: &mut [[u32; LANES]; 3]) {
        for (columns, corner) in self.corners.iter_mut().zip(&mut block.corners) {
            for (column, axis) in columns.iter_mut().zip(corner) {
                axis.copy_from_slice(&column[..LANES]);
                column.copy_within(LANES.., 0);
            }
        }
        for (column, identity) in self.identity.iter_mut().zip(identity) {
            identity.copy_from_slice(&column[..LANES]);
            column.copy_within(LANES.., 0);
        }
        self.len = self.len.saturating_sub(LANES);
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
    fn of(self, count: usize) -> std::ops::Range<usize> {
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
        faces: &[FaceTiles],
        tile_count: usize,
        share: Share,
    ) -> TraceStats {
        self.clear(faces.len(), tile_count);
        let mut stats = TraceStats::default();
        for block_idx in share.of(table.triangle_block_count()) {
            self.stream_block(simd, table, faces, block_idx, &mut stats);
        }
        for (face_idx, face) in faces.iter().enumerate() {
            while self.staged[face_idx].len > 0 {
                self.set_up(simd, table, face_idx, face);
            }
        }
        self.place_others(simd, table, faces, share);
        stats.pairs = self.lists.iter().map(|list| list.len() as u64).sum();
        stats.bytes += (self.triangles.len() * size_of::<FaceTriangle>()) as u64 + 4 * stats.pairs;
        stats
    }

    fn clear(&mut self, face_count: usize, tile_count: usize) {
        self.triangles.clear();
        self.lists.iter_mut().for_each(Vec::clear);
        if self.lists.len() < tile_count {
            self.lists.resize_with(tile_count, Vec::new);
        }
        if self.staged.len() < face_count {
            self.staged.resize_with(face_count, || Staged::EMPTY);
        }
    }

    #[inline(always)]
    fn stream_block<S: Simd>(
        &mut self,
        simd: S,
        table: &PrimitiveTable,
        faces: &[FaceTiles],
        block_idx: usize,
        stats: &mut TraceStats,
    ) {
        let corners = load_corners(simd, table.triangle_block(block_idx));
        let masks = u32x16::from_slice(simd, table.masks(block_idx));
        let is_there = !masks.simd_eq(u32x16::splat(simd, 0));
        let slots = first_slots(simd) + u32x16::splat(simd, (block_idx * LANES) as u32);
        stats.bytes += (9 * size_of::<Lanes>()) as u64;
        for (face_idx, face) in faces.iter().enumerate() {
            if face.bound.is_empty() {
                continue;
            }
            stats.box_tests += LANES as u64;
            let boxed = face.face.box_triangles(simd, &corners);
            let mut touches = is_there & !boxed.behind;
            let asked = touches & boxed.certain;
            let near = asked & overlaps(simd, &boxed.bounds, &face.bound.bounds);
            let kept = if face.has_occupancy && near.any_true() {
                face.occupancy.keep(simd, &boxed.bounds, near)
            } else {
                near
            };
            touches = (touches & !asked) | kept;
            if touches.any_true() {
                let ranks = u32x16::from_slice(simd, table.ranks(block_idx));
                let staged = &mut self.staged[face_idx];
                staged.append(simd, &corners, [slots, ranks, masks], touches);
                if staged.len >= LANES {
                    self.set_up(simd, table, face_idx, face);
                }
            }
        }
    }

    /// Sets up the first sixteen triangles of a face that wait, or as many as there are.
    #[inline(always)]
    fn set_up<S: Simd>(
        &mut self,
        simd: S,
        table: &PrimitiveTable,
        face_idx: usize,
        face: &FaceTiles,
    ) {
        let staged = &mut self.staged[face_idx];
        let count = staged.len.min(LANES);
        let (mut block, mut identity) = (TriangleBlock::EMPTY, [[0; LANES]; 3]);
        staged.take(&mut block, &mut identity);
        let placed = face.face.project_triangles(simd, &load_corners(simd, &block));
        let waiting = mask32x16::from_bitmask(simd, (1 << count) - 1);
        let rare = waiting & !placed.placed & !placed.behind;
        if rare.any_true() {
            self.place_rare(simd, table, face, &identity[0], rare.to_bitmask());
        }
        let mut touches =
            waiting & placed.placed & overlaps(simd, &placed.bounds, &face.bound.bounds);
        if face.has_occupancy && touches.any_true() {
            touches = face.occupancy.keep_closely(simd, &placed.bounds, touches);
        }
        if !touches.any_true() {
            return;
        }
        let first = self.triangles.len();
        self.triangles.resize(first + LANES, FaceTriangle::EMPTY);
        if let Some(triangles) = self.triangles[first..].first_chunk_mut() {
            let [slots, ranks, masks] = &identity;
            let bits = [
                u32x16::from_slice(simd, slots),
                u32x16::from_slice(simd, ranks),
                u32x16::from_slice(simd, masks),
            ];
            set_up(simd, &placed).store(simd, &placed.bounds, &block, bits, triangles);
        }
        self.compress(first, touches.to_bitmask());
        for entry in first..self.triangles.len() {
            self.list(simd, face, entry);
        }
    }

    /// Closes the gaps between the `kept` of the triangles from `first` on.
    #[inline(always)]
    fn compress(&mut self, first: usize, mut kept: u64) {
        let mut len = first;
        while kept != 0 {
            let lane = kept.trailing_zeros() as usize;
            kept &= kept - 1;
            self.triangles[len] = self.triangles[first + lane];
            len += 1;
        }
        self.triangles.truncate(len);
    }

    /// Notes a primitive for all tiles that it touches.
    #[inline(always)]
    fn list<S: Simd>(&mut self, simd: S, face: &FaceTiles, entry: usize) {
        face.for_touched(simd, &self.triangles[entry], &mut self.lists, entry as u32);
    }

    /// Sets up single triangles, given sixteen slots.
    #[inline(never)]
    fn place_rare<S: Simd>(
        &mut self,
        simd: S,
        table: &PrimitiveTable,
        face: &FaceTiles,
        slots: &[u32; LANES],
        mut lanes: u64,
    ) {
        while lanes != 0 {
            let slot = slots[lanes.trailing_zeros() as usize];
            lanes &= lanes - 1;
            let placed = face.face.place_triangle(table.triangle(slot));
            self.push(simd, table, face, slot, placed);
        }
    }

    /// Places a share of the spheres and user primitives.
    #[inline(always)]
    fn place_others<S: Simd>(
        &mut self,
        simd: S,
        table: &PrimitiveTable,
        faces: &[FaceTiles],
        share: Share,
    ) {
        let own = share.of(table.other_slots().count());
        for slot in table.other_slots().skip(own.start).take(own.len()) {
            if table.mask(slot) != 0 {
                for face in faces {
                    let placed = face.face.place_sphere(&table.bound(slot), table.slack());
                    self.push(simd, table, face, slot, placed);
                }
            }
        }
    }

    #[inline(always)]
    fn push<S: Simd>(
        &mut self,
        simd: S,
        table: &PrimitiveTable,
        face: &FaceTiles,
        slot: u32,
        placed: Option<FaceTriangle>,
    ) {
        if let Some(mut placed) = placed {
            placed.identify(slot, table.rank(slot), table.mask(slot));
            self.triangles.push(placed);
            self.list(simd, face, self.triangles.len() - 1);
        }
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        let lists: usize = self.lists.iter().map(|list| 4 * list.capacity()).sum();
        self.triangles.capacity() * size_of::<FaceTriangle>()
            + lists
            + self.lists.capacity() * size_of::<Vec<u32>>()
            + self.staged.capacity() * size_of::<Staged>()
    }
}

#[inline(always)]
fn load_corners<S: Simd>(simd: S, block: &TriangleBlock) -> [[f32x16<S>; 3]; 3] {
    let [a, b, c] = &block.corners;
    [load_axes(simd, a), load_axes(simd, b), load_axes(simd, c)]
}

#[inline(always)]
fn load_axes<S: Simd>(simd: S, [x, y, z]: &[Lanes; 3]) -> [f32x16<S>; 3] {
    [f32x16::from_slice(simd, x), f32x16::from_slice(simd, y), f32x16::from_slice(simd, z)]
}

/// The numbers 0 to 15.
#[inline(always)]
fn first_slots<S: Simd>(simd: S) -> u32x16<S> {
    const FIRST: [u32; LANES] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];
    u32x16::from_slice(simd, &FIRST)
}

/// Which boxes overlap the one box.
#[inline(always)]
fn overlaps<S: Simd>(simd: S, boxes: &[f32x16<S>; 4], one: &[f32; 4]) -> mask32x16<S> {
    let [x0, x1, y0, y1] = *one;
    let splat = f32x16::splat;
    boxes[0].simd_le(splat(simd, x1))
        & boxes[1].simd_ge(splat(simd, x0))
        & boxes[2].simd_le(splat(simd, y1))
        & boxes[3].simd_ge(splat(simd, y0))
}
