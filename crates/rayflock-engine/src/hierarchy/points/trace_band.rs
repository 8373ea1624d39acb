//! Traces the rays of a band against the primitives that may touch it.
//!
//! Sixteen triangles at a time are projected and set up. A triangle looks its groups up, strip by
//! strip, and asks the points of each: edge functions and depth of sixteen rays at once, all
//! widened for rounding. Rays that are left meet the accepting test.

use rayflock_geom::RayBatch;
use rayflock_geom::simd::face_triangle::{FaceTriangle, set_up};
use rayflock_geom::simd::ray_triangle::intersect_packet;
use rayflock_geom::simd::strip_rows::{StripRow, row_corners};
use rayflock_geom::simd::{LANES, Simd, SimdBase, SimdMask, f32x16, u32x16};

use super::ray_columns::RayColumns;
use super::ray_group::{Group, GroupPoints};
use super::ray_strips::{Band, FaceStrips, RayStrips};
use super::stream_triangles::Chunk;
use crate::TraceStats;
use crate::answers::Answers;
use crate::packet::{Question, TracePacket, packet_test_bytes};
use crate::primitives::PrimitiveTable;

/// How many groups before their turn memory is asked for their rays. Twenty cells of the map, of 16K
/// to 256K triangles, took 8 % less in the mean (two AVX-512 server cores).
const GROUPS_AHEAD: usize = 4;

/// Strips from which on it pays to ask what of each a triangle covers.
const TALL: usize = 3;

/// What a band is traced against, and why.
pub(super) struct BandWork<'a> {
    pub(super) table: &'a PrimitiveTable,
    pub(super) rays: &'a RayBatch<'a>,
    pub(super) strips: &'a RayStrips,
    pub(super) chunks: &'a [Chunk],
    pub(super) question: Question,
    pub(super) t_bounds: Option<&'a [f32]>,
}

/// A band at work; kept and filled again band after band.
#[derive(Debug)]
pub(super) struct BandTracer {
    points: Vec<GroupPoints>,
    groups: Vec<Group>,
    columns: RayColumns,
    /// Spheres and user primitives that may touch a group.
    others: Vec<Vec<u32>>,
    packet: TracePacket,
}

/// Rays of a band as its task sees them.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Loaded {
    pub(super) invalid_count: u64,
    /// Whether a ray is not where its strip says.
    pub(super) is_astray: bool,
}

/// One band, for those who trace it.
#[derive(Clone, Copy)]
struct Here<'a> {
    work: &'a BandWork<'a>,
    face: &'a FaceStrips,
    band: &'a Band,
    ray_idx: &'a [u32],
}

impl Default for BandTracer {
    fn default() -> Self {
        Self {
            points: Vec::new(),
            groups: Vec::new(),
            columns: RayColumns::EMPTY,
            others: Vec::new(),
            packet: TracePacket::EMPTY,
        }
    }
}

impl BandTracer {
    /// Answers the rays of a band.
    #[inline(always)]
    pub(super) fn trace<S: Simd>(
        &mut self,
        simd: S,
        work: &BandWork<'_>,
        band_idx: usize,
        answers: &Answers,
    ) -> (TraceStats, Loaded) {
        let band = &work.strips.bands[band_idx];
        let face = &work.strips.faces[band.face_idx];
        let ray_idx = &work.strips.ray_idx[band.first_place..band.end_place];
        let here = Here { work, face, band, ray_idx };
        let loaded = self.load(simd, here);
        let mut stats = TraceStats::default();
        if loaded.is_astray {
            return (stats, loaded);
        }
        for chunk in work.chunks {
            for rows in chunk.lists[band_idx].chunks(LANES) {
                self.meet_rows(simd, here, rows, &mut stats);
            }
        }
        self.trace_others(simd, work, ray_idx, &mut stats);
        for (group, ray_idx) in self.groups.iter().zip(ray_idx.chunks(LANES)) {
            group.answer(ray_idx, answers);
        }
        (stats, loaded)
    }

    /// Brings the rays into groups.
    #[inline(always)]
    fn load<S: Simd>(&mut self, simd: S, here: Here<'_>) -> Loaded {
        let Here { work, face, band, ray_idx } = here;
        let count = ray_idx.len() / LANES;
        if self.points.len() < count {
            self.points.resize(count, GroupPoints::EMPTY);
        }
        self.groups.resize(count, Group::EMPTY);
        let mut loaded = Loaded::default();
        for (idx, ray_idx) in ray_idx.chunks(LANES).enumerate() {
            // What is sorted lies anywhere in the batch.
            if face.lattice.is_none() {
                let ahead = here.ray_idx.chunks(LANES).nth(idx + GROUPS_AHEAD);
                RayColumns::ask_for(work.rays, ahead.unwrap_or_default());
            }
            let columns = &mut self.columns;
            columns.gather(simd, work.rays, ray_idx);
            columns.bound(simd, ray_idx, work.t_bounds);
            let states = columns.states(simd);
            let points = self.points[idx].load(simd, &face.face, columns, states.active);
            let group = &mut self.groups[idx];
            group.begin(&points, states.active.to_bitmask());
            if work.question == Question::Closest {
                group.load(simd, columns);
            }
            if face.lattice.is_some() {
                loaded.invalid_count += states.invalid_count;
                let is_here = face.holds(simd, &points, band.first_cell + idx);
                loaded.is_astray |= states.looks_back | (states.active & !is_here).any_true();
            }
        }
        loaded
    }

    /// Tests up to sixteen primitives.
    #[inline(always)]
    fn meet_rows<S: Simd>(
        &mut self,
        simd: S,
        here: Here<'_>,
        some: &[StripRow],
        stats: &mut TraceStats,
    ) {
        let Here { face, .. } = here;
        let mut rows = [StripRow::EMPTY; LANES];
        rows[..some.len()].copy_from_slice(some);
        let mut by_slot = 0;
        for (lane, row) in rows.iter().enumerate() {
            by_slot |= u64::from(row.is_by_slot()) << lane;
        }
        let waiting = (1 << some.len()) - 1;
        if by_slot != 0 {
            self.meet_by_slot(simd, here, (&rows, by_slot), stats);
        }
        let mut lanes = waiting & !by_slot;
        if lanes == 0 {
            return;
        }
        // As they were projected before.
        let placed = face.face.project_triangles(simd, &row_corners(simd, &rows));
        let mut planes = [FaceTriangle::EMPTY; LANES];
        let ends = [placed.bounds[0], placed.bounds[1]];
        set_up(simd, &placed).store(simd, ends, &mut planes);
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            self.meet(simd, here, &planes[lane], &rows[lane], rows[lane].strips(), stats);
        }
    }

    /// Tests single primitives that are known by their slots.
    #[inline(never)]
    fn meet_by_slot<S: Simd>(
        &mut self,
        simd: S,
        here: Here<'_>,
        (rows, lanes): (&[StripRow; LANES], u64),
        stats: &mut TraceStats,
    ) {
        // Not a part of the caller, so it has to be told the instruction set again.
        simd.vectorize(
            #[inline(always)]
            || self.meet_each(simd, here, (rows, lanes), stats),
        );
    }

    #[inline(always)]
    fn meet_each<S: Simd>(
        &mut self,
        simd: S,
        here: Here<'_>,
        (rows, mut lanes): (&[StripRow; LANES], u64),
        stats: &mut TraceStats,
    ) {
        let Here { work: BandWork { table, .. }, face, .. } = here;
        while lanes != 0 {
            let slot = rows[lanes.trailing_zeros() as usize].slot();
            lanes &= lanes - 1;
            let triangle = table.is_triangle(slot).then(|| table.read_triangle(slot));
            let placed = match triangle {
                Some((corners, _)) => face.face.place_triangle(corners),
                None => face.face.place_sphere(&table.bound(slot), table.slack()),
            };
            let Some(placed) = placed else { continue };
            let [_, _, y0, y1] = placed.bounds;
            let strips = face.strips([y0, y1]);
            if let Some((corners, mask)) = triangle {
                let row = StripRow::of_triangle(corners, [slot, table.rank(slot), mask]);
                self.meet(simd, here, &FaceTriangle::of(&placed), &row, strips, stats);
                continue;
            }
            let columns = face.columns_between(FaceTriangle::of(&placed).ends());
            for strip in here.band.strips(strips) {
                for group_idx in here.work.strips.groups(face, here.band, strip, columns) {
                    self.note_other(group_idx, slot);
                }
            }
        }
    }

    /// Tests a triangle against the rays that it may touch.
    #[inline(always)]
    fn meet<S: Simd>(
        &mut self,
        simd: S,
        here: Here<'_>,
        planes: &FaceTriangle,
        row: &StripRow,
        strips: [usize; 2],
        stats: &mut TraceStats,
    ) {
        let Here { face, band, .. } = here;
        let is_tall = strips[1] - strips[0] + 1 >= TALL;
        let mut columns = face.columns_between(planes.ends());
        for strip in band.strips(strips) {
            if is_tall {
                let ends = planes.clip(face.strip_y(strip));
                if ends[0] > ends[1] {
                    continue;
                }
                columns = face.columns_between(ends);
            }
            let groups = here.work.strips.groups(face, band, strip, columns);
            stats.box_tests += groups.len() as u64;
            for group_idx in groups {
                self.test(simd, here, planes, row, group_idx, stats);
            }
        }
    }

    /// Tests a triangle against sixteen rays.
    #[inline(always)]
    fn test<S: Simd>(
        &mut self,
        simd: S,
        here: Here<'_>,
        planes: &FaceTriangle,
        row: &StripRow,
        group_idx: usize,
        stats: &mut TraceStats,
    ) {
        let load = f32x16::from_slice;
        let points = &self.points[group_idx];
        let columns = [
            load(simd, &points.x),
            load(simd, &points.y),
            load(simd, &points.limit),
            load(simd, &points.begin),
        ];
        let may_hit = planes.may_hit(simd, columns);
        if !may_hit.any_true() {
            return;
        }
        let group = &mut self.groups[group_idx];
        if !group.is_loaded {
            let ray_idx = &here.ray_idx[group_idx * LANES..(group_idx + 1) * LANES];
            self.columns.gather(simd, here.work.rays, ray_idx);
            self.columns.bound(simd, ray_idx, here.work.t_bounds);
            self.columns.repeat_active(group.active);
            group.load(simd, &self.columns);
        }
        let seen = u32x16::from_slice(simd, &group.masks) & u32x16::splat(simd, row.mask());
        let active = may_hit & !seen.simd_eq(u32x16::splat(simd, 0));
        stats.triangle_tests += LANES as u64;
        let hits = intersect_packet(simd, &group.rays, &row.corners(), active);
        if !hits.accepted.any_true() {
            return;
        }
        let place = (&here.face.face, &mut self.points[group_idx]);
        group.keep(simd, place, &hits, row.rank(), here.work.question);
    }

    fn note_other(&mut self, group_idx: usize, slot: u32) {
        if self.others.len() <= group_idx {
            self.others.resize_with(group_idx + 1, Vec::new);
        }
        self.others[group_idx].push(slot);
    }

    /// Tests spheres and user primitives, group by group.
    #[inline(always)]
    fn trace_others<S: Simd>(
        &mut self,
        simd: S,
        work: &BandWork<'_>,
        ray_idx: &[u32],
        stats: &mut TraceStats,
    ) {
        let groups = self.groups.iter_mut().zip(ray_idx.chunks(LANES));
        for (others, (group, ray_idx)) in self.others.iter_mut().zip(groups) {
            if others.is_empty() {
                continue;
            }
            group.fill(&mut self.packet, work.rays, ray_idx, work.t_bounds);
            let mut tests = TraceStats::default();
            for slot in others.drain(..) {
                if !self.packet.is_done() {
                    self.packet.test(simd, work.table, slot, work.question, &mut tests);
                }
            }
            tests.bytes = packet_test_bytes(&tests);
            *stats += tests;
            group.offer(&self.packet);
        }
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        let others: usize = self.others.iter().map(|others| 4 * others.capacity()).sum();
        size_of::<Self>()
            + self.groups.capacity() * size_of::<Group>()
            + self.points.capacity() * size_of::<GroupPoints>()
            + others
    }
}
