//! Projects triangles onto a face and brings them to the blocks of its grid that they touch.

use rayflock_geom::simd::face::{Face, FaceTriangles};
use rayflock_geom::simd::face_rows::{CELL_BITS, FaceRow, Window, write_rows};
use rayflock_geom::simd::face_triangle::FaceReach;
use rayflock_geom::simd::triangle_lanes::TriangleLanes;
use rayflock_geom::simd::{
    LANES, Select, Simd, SimdBase, SimdLevel, SimdMask, dispatch, f32x16, mask32x16, u32x16,
};
use rayon::prelude::*;
use tracing::debug_span;

use super::config::TileOrder;
use crate::primitives::PrimitiveTable;
use crate::wanted::{Wanted, WantedLanes};

/// Blocks of sixteen triangles in the smallest share.
const SMALLEST_SHARE: usize = 32;

/// Triangles on their way into blocks; memory is kept.
#[derive(Debug, Default)]
pub(super) struct TriangleBins {
    shares: Vec<Share>,
    used_count: usize,
}

/// What one task found.
#[derive(Debug, Default)]
struct Share {
    /// One for each block of the grid.
    bins: Vec<Vec<FaceRow>>,
    /// The same for other primitives.
    other_bins: Vec<Vec<OtherRow>>,
    /// Slots of primitives that have no place on the face.
    everywhere: Vec<u32>,
}

/// A sphere or user primitive on its way to the tiles of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct OtherRow {
    pub(super) slot: u32,
    /// The first and the last column of cells.
    pub(super) columns: [u32; 2],
    /// The first and the last row of cells.
    pub(super) rows: [u32; 2],
}

/// What triangles are brought from and to.
#[derive(Clone, Copy)]
pub(super) struct Projection<'a> {
    pub(super) level: SimdLevel,
    pub(super) table: &'a PrimitiveTable,
    pub(super) wanted: &'a Wanted,
    pub(super) face: &'a Face,
    /// Tasks to divide the work into; with one, the calling thread does all.
    pub(super) task_count: usize,
    /// What tiles are to be like.
    pub(super) tiles: TileSettings,
}

/// What the tiles of a grid are to be like.
#[derive(Clone, Copy)]
pub(super) struct TileSettings {
    /// How they hold their triangles.
    pub(super) order: TileOrder,
    /// They are made smaller as long as so many primitives are left in each.
    pub(super) fewest: u16,
}

impl Projection<'_> {
    /// Where the primitives with a place on the face are.
    pub(super) fn measure(&self) -> Extent {
        let _span = debug_span!("measure_triangles").entered();
        let triangles = self.wanted.triangles.par_chunks(self.share_len(&self.wanted.triangles));
        let extents = triangles
            .map(|wanted| dispatch!(self.level.level(), simd => measure(simd, self, wanted)));
        let others = self.wanted.others.par_chunks(self.share_len(&self.wanted.others));
        let other_extents = others.map(|wanted| {
            let placed = self.others(wanted).filter_map(|(_, placed)| placed);
            let extents = placed.map(|placed| Extent::of(&placed)).filter(Extent::is_in_range);
            extents.fold(Extent::NOTHING, Extent::unite)
        });
        let nothing = || Extent::NOTHING;
        extents.reduce(nothing, Extent::unite).unite(other_extents.reduce(nothing, Extent::unite))
    }

    fn share_len(&self, wanted: &[WantedLanes]) -> usize {
        wanted.len().div_ceil(self.task_count).max(SMALLEST_SHARE)
    }

    /// Slots of other primitives that can be hit, and their places on the face.
    fn others<'a>(
        &'a self,
        wanted: &'a [WantedLanes],
    ) -> impl Iterator<Item = (u32, Option<FaceReach>)> + 'a {
        let lanes = wanted.iter().flat_map(|wanted| {
            let lanes = (0..LANES as u32).filter(move |lane| wanted.lanes & (1 << lane) != 0);
            lanes.map(move |lane| wanted.block_idx * LANES as u32 + lane)
        });
        let lanes = lanes.filter(|&slot| self.table.mask(slot) != 0);
        lanes.map(|slot| {
            let placed = self.face.place_sphere(&self.table.bound(slot), self.table.slack());
            (slot, placed)
        })
    }
}

/// A box on a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    /// Least and largest x, least and largest y.
    pub(super) bounds: [f32; 4],
    /// The largest and the least nearness of a hit.
    pub(super) nearness: [f32; 2],
    /// By how much the nearness of a hit may differ from that of its primitive.
    pub(super) depth_error: f32,
}

/// The largest coordinate that has a place in a grid.
const FARTHEST: f32 = 1e15;

impl Extent {
    /// The extent of a primitive in a cube.
    fn of(placed: &FaceReach) -> Self {
        let bounds = placed.bounds;
        let nearest = placed.nearest;
        let width = (bounds[1] - bounds[0]).max(bounds[3] - bounds[2]);
        let farthest = nearest - width * 1.000_001 - nearest.abs() * 1e-6;
        Self { bounds, nearness: [nearest, farthest], depth_error: 0.0 }
    }

    /// The largest coordinate, negative where there is none.
    pub(super) fn reach(&self) -> f32 {
        let [x0, x1, y0, y1] = self.bounds;
        let [nearest, farthest] = self.nearness;
        [-x0, x1, -y0, y1, nearest, -farthest].into_iter().fold(f32::NEG_INFINITY, f32::max)
    }

    /// Whether all coordinates are small enough for a grid.
    fn is_in_range(&self) -> bool {
        self.reach() < FARTHEST
    }

    const NOTHING: Self = Self {
        bounds: [f32::INFINITY, f32::NEG_INFINITY, f32::INFINITY, f32::NEG_INFINITY],
        nearness: [f32::NEG_INFINITY, f32::INFINITY],
        depth_error: 0.0,
    };

    fn unite(self, other: Self) -> Self {
        let (a, b) = (self.bounds, other.bounds);
        let ([a_near, a_far], [b_near, b_far]) = (self.nearness, other.nearness);
        Self {
            bounds: [a[0].min(b[0]), a[1].max(b[1]), a[2].min(b[2]), a[3].max(b[3])],
            nearness: [a_near.max(b_near), a_far.min(b_far)],
            depth_error: self.depth_error.max(other.depth_error),
        }
    }
}

impl TriangleBins {
    /// Brings all triangles to the blocks that they touch.
    pub(super) fn fill(&mut self, from: &Projection<'_>, window: &Window, block_bits: u32) {
        let _span = debug_span!("bin_triangles").entered();
        let Wanted { triangles, others } = from.wanted;
        let (share_len, other_len) = (from.share_len(triangles), from.share_len(others));
        let count = triangles.len().div_ceil(share_len).max(others.len().div_ceil(other_len));
        self.used_count = count;
        if self.shares.len() < count {
            self.shares.resize_with(count, Share::default);
        }
        self.shares[..count].par_iter_mut().enumerate().for_each(|(share_idx, share)| {
            share.clear(1 << (2 * block_bits));
            let triangles = triangles.chunks(share_len).nth(share_idx).unwrap_or_default();
            let others = others.chunks(other_len).nth(share_idx).unwrap_or_default();
            dispatch!(from.level.level(), simd => {
                share.fill(simd, from, triangles, window, block_bits);
            });
            share.fill_others(from, others, window, block_bits);
        });
    }

    /// The triangles of a block, share by share.
    pub(super) fn of_block(&self, block_idx: usize) -> impl Iterator<Item = &[FaceRow]> {
        self.shares[..self.used_count].iter().map(move |share| &share.bins[block_idx][..])
    }

    /// The other primitives of a block.
    pub(super) fn others_of_block(
        &self,
        block_idx: usize,
    ) -> impl Iterator<Item = &OtherRow> + Clone {
        self.shares[..self.used_count].iter().flat_map(move |share| &share.other_bins[block_idx])
    }

    /// Slots of primitives without a place.
    pub(super) fn everywhere(&self) -> impl Iterator<Item = u32> + '_ {
        self.shares[..self.used_count].iter().flat_map(|share| share.everywhere.iter().copied())
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        let bins = self.shares.iter().flat_map(|share| &share.bins);
        bins.map(|bin| bin.capacity() * size_of::<FaceRow>() + size_of::<Vec<FaceRow>>()).sum()
    }
}

impl Share {
    fn clear(&mut self, block_count: usize) {
        self.bins.iter_mut().for_each(Vec::clear);
        self.other_bins.iter_mut().for_each(Vec::clear);
        if self.bins.len() < block_count {
            self.bins.resize_with(block_count, Vec::new);
            self.other_bins.resize_with(block_count, Vec::new);
        }
        self.everywhere.clear();
    }

    #[inline(always)]
    fn fill<S: Simd>(
        &mut self,
        simd: S,
        from: &Projection<'_>,
        wanted: &[WantedLanes],
        window: &Window,
        block_bits: u32,
    ) {
        let mut rows = [FaceRow::EMPTY; LANES];
        for wanted in wanted {
            let (triangles, placed, there) = project(simd, from, wanted);
            let block_idx = wanted.block_idx as usize;
            let identity = [
                u32x16::from_slice(simd, from.table.ranks(block_idx)),
                u32x16::from_slice(simd, from.table.masks(block_idx)),
            ];
            write_rows(simd, &triangles, &placed, window, identity, &mut rows);
            let mut here = (there & placed.placed).to_bitmask();
            while here != 0 {
                let lane = here.trailing_zeros() as usize;
                here &= here - 1;
                self.push(&rows[lane], block_bits);
            }
            let mut rare = (there & !placed.placed & !placed.behind).to_bitmask();
            while rare != 0 {
                self.everywhere.push(wanted.block_idx * LANES as u32 + rare.trailing_zeros());
                rare &= rare - 1;
            }
        }
    }

    fn fill_others(
        &mut self,
        from: &Projection<'_>,
        wanted: &[WantedLanes],
        window: &Window,
        block_bits: u32,
    ) {
        for (slot, placed) in from.others(wanted) {
            let Some(placed) = placed else { continue };
            let [x0, x1, y0, y1] = placed.bounds;
            if !Extent::of(&placed).is_in_range() {
                self.everywhere.push(slot);
                continue;
            }
            let columns = [window.cell(x0, 0), window.cell(x1, 0)];
            let rows = [window.cell(y0, 1), window.cell(y1, 1)];
            for block_idx in blocks_between(columns, rows, block_bits) {
                self.other_bins[block_idx].push(OtherRow { slot, columns, rows });
            }
        }
    }

    /// Adds a triangle to all blocks that it touches.
    #[inline(always)]
    fn push(&mut self, row: &FaceRow, block_bits: u32) {
        for block_idx in blocks_between(row.columns(), row.rows(), block_bits) {
            self.bins[block_idx].push(*row);
        }
    }
}

/// The blocks with cells between first and last column, first and last row.
#[inline(always)]
fn blocks_between(
    columns: [u32; 2],
    rows: [u32; 2],
    block_bits: u32,
) -> impl Iterator<Item = usize> {
    let shift = CELL_BITS - block_bits;
    (rows[0] >> shift..=rows[1] >> shift).flat_map(move |row| {
        let columns = columns[0] >> shift..=columns[1] >> shift;
        columns.map(move |column| ((row << block_bits) | column) as usize)
    })
}

#[inline(always)]
fn measure<S: Simd>(simd: S, from: &Projection<'_>, wanted: &[WantedLanes]) -> Extent {
    let splat = f32x16::splat;
    let (most, least) = (splat(simd, f32::INFINITY), splat(simd, f32::NEG_INFINITY));
    let (mut low, mut high) = ([most; 3], [least; 3]);
    let mut error = splat(simd, 0.0);
    for wanted in wanted {
        let (_, placed, there) = project(simd, from, wanted);
        let here = there & placed.placed;
        let [x0, x1, y0, y1] = placed.bounds;
        let [n0, n1, n2] = placed.near;
        let farthest = n0.min(n1).min(n2) - placed.near_margin;
        let nearest = n0.max(n1).max(n2) + placed.near_margin;
        low = lower(low, [x0, y0, farthest], here, most);
        high = raise(high, [x1, y1, nearest], here, least);
        error = error.max(here.select(placed.near_margin, splat(simd, 0.0)));
    }
    Extent {
        bounds: [
            simd.reduce_min_f32x16(low[0]),
            simd.reduce_max_f32x16(high[0]),
            simd.reduce_min_f32x16(low[1]),
            simd.reduce_max_f32x16(high[1]),
        ],
        nearness: [simd.reduce_max_f32x16(high[2]), simd.reduce_min_f32x16(low[2])],
        depth_error: simd.reduce_max_f32x16(error),
    }
}

#[inline(always)]
fn lower<S: Simd>(
    low: [f32x16<S>; 3],
    other: [f32x16<S>; 3],
    here: mask32x16<S>,
    most: f32x16<S>,
) -> [f32x16<S>; 3] {
    [
        low[0].min(here.select(other[0], most)),
        low[1].min(here.select(other[1], most)),
        low[2].min(here.select(other[2], most)),
    ]
}

#[inline(always)]
fn raise<S: Simd>(
    high: [f32x16<S>; 3],
    other: [f32x16<S>; 3],
    here: mask32x16<S>,
    least: f32x16<S>,
) -> [f32x16<S>; 3] {
    [
        high[0].max(here.select(other[0], least)),
        high[1].max(here.select(other[1], least)),
        high[2].max(here.select(other[2], least)),
    ]
}

/// Sixteen triangles, their places, and which of them are wanted and can be hit.
#[inline(always)]
fn project<S: Simd>(
    simd: S,
    from: &Projection<'_>,
    wanted: &WantedLanes,
) -> (TriangleLanes<S>, FaceTriangles<S>, mask32x16<S>) {
    let block_idx = wanted.block_idx as usize;
    let triangles = TriangleLanes::load(simd, from.table.triangle_block(block_idx));
    let placed = from.face.project_triangles(simd, &triangles.corners);
    let masks = u32x16::from_slice(simd, from.table.masks(block_idx));
    let can_be_hit = !masks.simd_eq(u32x16::splat(simd, 0));
    let there = can_be_hit & mask32x16::from_bitmask(simd, u64::from(wanted.lanes));
    (triangles, placed, there)
}
