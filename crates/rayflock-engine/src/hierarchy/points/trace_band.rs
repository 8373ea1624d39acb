//! Traces the rays of a band against the primitives that may touch it.
//!
//! Sixteen triangles at a time are projected and set up, and look up the groups of rays that they may
//! hit. Of each pair of a triangle and a group the points are asked: edge functions and depth of
//! sixteen rays at once, all widened for rounding. Pairs that are left meet the accepting test. Where
//! it is only asked whether there is a hit, one that lies beyond all rounding within the triangle
//! needs no test.

use rayflock_geom::simd::face_triangle::{FaceTriangle, set_up};
use rayflock_geom::simd::ray_triangle::intersect_packet;
use rayflock_geom::simd::strip_rows::{StripRow, row_columns};
use rayflock_geom::simd::{LANES, Simd, SimdBase, SimdMask, mask32x16, u32x16};
use rayflock_geom::{RayBatch, prefetch};

use super::look_up_groups::{Pairs, Sought};
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
    pairs: Pairs,
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
            pairs: Pairs::default(),
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
            let mut lists = chunk.lists[band_idx].chunks(LANES).peekable();
            while let Some(rows) = lists.next() {
                // Written by other tasks, they lie far from here.
                lists.peek().into_iter().copied().flatten().for_each(prefetch);
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
            group.begin(simd, &points, columns, states.active.to_bitmask());
            if work.question == Question::Occluded {
                group.note_surely(simd, &face.face, &points, columns);
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
        let mut padded = [StripRow::EMPTY; LANES];
        let rows = some.try_into().unwrap_or_else(|_| {
            padded[..some.len()].copy_from_slice(some);
            &padded
        });
        let mut by_slot = 0;
        for (lane, row) in rows.iter().enumerate() {
            by_slot |= u64::from(row.is_by_slot()) << lane;
        }
        let waiting = (1 << some.len()) - 1;
        if by_slot != 0 {
            self.meet_by_slot(simd, here, (rows, by_slot), stats);
        }
        let lanes = waiting & !by_slot;
        if lanes == 0 {
            return;
        }
        // As they were projected before.
        let (corners, strips) = row_columns(simd, rows);
        let placed = face.face.project_triangles(simd, &corners);
        let ends = [placed.bounds[0], placed.bounds[1]];
        let planes = set_up(simd, &placed);
        let mut triangles = [FaceTriangle::EMPTY; LANES];
        planes.store(ends, &mut triangles);
        let present = mask32x16::from_bitmask(simd, lanes);
        let sought = Sought { planes, ends, strips, present };
        self.meet_groups(simd, here, &sought, (&triangles, rows), stats);
    }

    /// Tests triangles against the groups that they may touch.
    #[inline(always)]
    fn meet_groups<S: Simd>(
        &mut self,
        simd: S,
        here: Here<'_>,
        sought: &Sought<S>,
        (triangles, rows): (&[FaceTriangle], &[StripRow]),
        stats: &mut TraceStats,
    ) {
        self.pairs.look_up(simd, here.work.strips, (here.face, here.band), sought);
        stats.box_tests += self.pairs.len() as u64;
        let points = &self.points[..];
        self.pairs.retain(|lane, group_idx| {
            triangles[lane].may_hit(simd, points[group_idx].columns(simd)).any_true()
        });
        for idx in 0..self.pairs.len() {
            let (lane, group_idx) = self.pairs.get(idx);
            self.test(simd, here, (&triangles[lane], &rows[lane]), group_idx, stats);
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
            let planes = FaceTriangle::of(&placed);
            let sought = Sought::one(simd, &planes, face.strips([y0, y1]));
            if let Some((corners, mask)) = triangle {
                let row = StripRow::of_triangle(corners, [slot, table.rank(slot), mask]);
                self.meet_groups(simd, here, &sought, (&[planes], &[row]), stats);
                continue;
            }
            self.pairs.look_up(simd, here.work.strips, (face, here.band), &sought);
            for idx in 0..self.pairs.len() {
                let (_, group_idx) = self.pairs.get(idx);
                self.note_other(group_idx, slot);
            }
        }
    }

    /// Tests a triangle against sixteen rays.
    #[inline(always)]
    fn test<S: Simd>(
        &mut self,
        simd: S,
        here: Here<'_>,
        (planes, row): (&FaceTriangle, &StripRow),
        group_idx: usize,
        stats: &mut TraceStats,
    ) {
        let (points, group) = (&mut self.points[group_idx], &mut self.groups[group_idx]);
        let seen = u32x16::from_slice(simd, &group.masks) & u32x16::splat(simd, row.mask());
        let mut asked =
            planes.may_hit(simd, points.columns(simd)) & !seen.simd_eq(u32x16::splat(simd, 0));
        if here.work.question == Question::Occluded {
            let certain = asked & planes.must_hit(simd, group.surely(simd, points));
            group.occlude(simd, points, certain, row.rank());
            asked &= !certain;
        }
        if !asked.any_true() {
            return;
        }
        stats.triangle_tests += LANES as u64;
        let hits = intersect_packet(simd, &group.rays, &row.corners(), asked);
        if !hits.accepted.any_true() {
            return;
        }
        match here.work.question {
            Question::Closest => {
                group.keep(simd, (&here.face.face, points), &hits, row.rank());
            }
            Question::Occluded => group.occlude(simd, points, hits.accepted, row.rank()),
        }
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
            + self.pairs.memory_usage()
            + others
    }
}
