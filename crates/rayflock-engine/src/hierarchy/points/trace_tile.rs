//! Traces the rays of a tile against the primitives that may touch it.
//!
//! Up to sixteen nodes of sixteen groups of sixteen rays: a primitive asks the boxes of the nodes,
//! of the groups of those it touches, the points of the groups it touches; rays that are left meet
//! the accepting test. Boxes know the farthest hit in them, so that what lies behind is rejected.

use rayflock_geom::RayBatch;
use rayflock_geom::simd::face::{Face, RayPoints};
use rayflock_geom::simd::face_triangle::FaceTriangle;
use rayflock_geom::simd::point_boxes::{PointBox, PointBoxes};
use rayflock_geom::simd::ray_triangle::{RayPacket, intersect_packet};
use rayflock_geom::simd::{
    LANES, Lanes, Select, Simd, SimdBase, SimdMask, f32x16, mask32x16, u32x16,
};

use super::super::arrange::NO_RAY;
use super::ray_columns::RayColumns;
use super::stream_triangles::Chunk;
use crate::TraceStats;
use crate::answers::Answers;
use crate::packet::{Nearest, Question, TracePacket, packet_test_bytes};
use crate::primitives::PrimitiveTable;

/// Rays of the largest tile.
pub(super) const LARGEST_TILE: usize = LANES * LANES * LANES;

/// What a tile is traced against, and why.
pub(super) struct TileWork<'a> {
    pub(super) table: &'a PrimitiveTable,
    pub(super) rays: &'a RayBatch<'a>,
    pub(super) chunks: &'a [Chunk],
    pub(super) question: Question,
    pub(super) t_bounds: Option<&'a [f32]>,
}

/// A tile at work; kept and filled again tile after tile.
#[derive(Debug)]
pub(super) struct TileTracer {
    nodes: PointBoxes,
    /// One entry a node.
    boxes: Vec<PointBoxes>,
    groups: Vec<Group>,
    columns: RayColumns,
    /// Spheres and user primitives that may touch a group.
    others: Vec<Vec<u32>>,
    packet: TracePacket,
}

/// Sixteen rays and what they hit.
#[derive(Clone, Debug)]
#[repr(align(64))]
struct Group {
    x: Lanes,
    y: Lanes,
    /// The least nearness at which a ray accepts a hit.
    limit: Lanes,
    /// The largest such nearness.
    begin: Lanes,
    pace: Lanes,
    start: Lanes,
    rays: RayPacket,
    masks: [u32; LANES],
    /// Rays that still want an answer.
    active: u64,
    t: Lanes,
    u: Lanes,
    v: Lanes,
    ranks: [u32; LANES],
}

impl Default for TileTracer {
    fn default() -> Self {
        Self {
            nodes: PointBoxes::EMPTY,
            boxes: Vec::new(),
            groups: Vec::new(),
            columns: RayColumns::EMPTY,
            others: Vec::new(),
            packet: TracePacket::EMPTY,
        }
    }
}

impl TileTracer {
    /// Answers the rays of a tile, given their positions in the batch.
    #[inline(always)]
    pub(super) fn trace<S: Simd>(
        &mut self,
        simd: S,
        work: &TileWork<'_>,
        face: &Face,
        tile_idx: usize,
        ray_idx: &[u32],
        answers: &Answers,
    ) -> TraceStats {
        self.load(simd, work, face, ray_idx);
        let mut stats = TraceStats::default();
        for chunk in work.chunks {
            for entries in chunk.lists[tile_idx].chunks(LANES) {
                self.meet_all(simd, work, face, chunk, entries, &mut stats);
            }
        }
        self.trace_others(simd, work, ray_idx, &mut stats);
        for (group, ray_idx) in self.groups.iter().zip(ray_idx.chunks(LANES)) {
            group.answer(ray_idx, answers);
        }
        stats
    }

    /// Brings the rays into groups and bounds them.
    #[inline(always)]
    fn load<S: Simd>(&mut self, simd: S, work: &TileWork<'_>, face: &Face, ray_idx: &[u32]) {
        let group_count = ray_idx.len().div_ceil(LANES);
        self.groups.resize(group_count, Group::EMPTY);
        self.boxes.clear();
        self.boxes.resize(group_count.div_ceil(LANES), PointBoxes::EMPTY);
        self.nodes = PointBoxes::EMPTY;
        for (idx, ray_idx) in ray_idx.chunks(LANES).enumerate() {
            let columns = &mut self.columns;
            columns.gather(simd, work.rays, ray_idx);
            columns.bound(simd, ray_idx, work.t_bounds);
            let group = &mut self.groups[idx];
            let bound = group.load(simd, face, columns);
            self.boxes[idx / LANES].set(idx % LANES, &bound);
        }
        for (node_idx, boxes) in self.boxes.iter().enumerate() {
            self.nodes.set(node_idx, &boxes.union());
        }
    }

    /// Tests up to sixteen primitives.
    ///
    /// They are copied first: loads that do not wait for each other hide that entries of a tile lie
    /// far apart (1M triangles, 64K rays: half of the time went into waiting for them).
    #[inline(always)]
    fn meet_all<S: Simd>(
        &mut self,
        simd: S,
        work: &TileWork<'_>,
        face: &Face,
        chunk: &Chunk,
        entries: &[u32],
        stats: &mut TraceStats,
    ) {
        let mut triangles = [FaceTriangle::EMPTY; LANES];
        for (triangle, &entry) in triangles.iter_mut().zip(entries) {
            *triangle = chunk.triangles[entry as usize];
        }
        for triangle in &triangles[..entries.len()] {
            self.meet(simd, work, face, triangle, stats);
        }
    }

    /// Tests a primitive against the rays that it may touch.
    #[inline(always)]
    fn meet<S: Simd>(
        &mut self,
        simd: S,
        work: &TileWork<'_>,
        face: &Face,
        triangle: &FaceTriangle,
        stats: &mut TraceStats,
    ) {
        let is_triangle = work.table.is_triangle(triangle.slot());
        let mut nodes = self.nodes.touched(simd, triangle);
        stats.box_tests += LANES as u64;
        while nodes != 0 {
            let node_idx = nodes.trailing_zeros() as usize;
            nodes &= nodes - 1;
            let mut touched = self.boxes[node_idx].touched(simd, triangle);
            stats.box_tests += LANES as u64;
            while touched != 0 {
                let lane = touched.trailing_zeros() as usize;
                touched &= touched - 1;
                let group_idx = node_idx * LANES + lane;
                if !is_triangle {
                    self.note_other(group_idx, triangle.slot());
                    continue;
                }
                let group = &mut self.groups[group_idx];
                if group.test(simd, face, triangle, work.question, stats) {
                    self.lower(simd, node_idx, lane);
                }
            }
        }
    }

    /// Takes over what a group has come to accept: by whole vectors, for loads would wait long for
    /// single lanes that were just stored.
    #[inline(always)]
    fn lower<S: Simd>(&mut self, simd: S, node_idx: usize, lane: usize) {
        let group = &self.groups[node_idx * LANES + lane];
        let boxes = &mut self.boxes[node_idx];
        let limits = with_lane(simd, &boxes.limit, lane, group.least_limit(simd));
        limits.store_slice(&mut boxes.limit);
        if group.active == 0 {
            boxes.clear(lane);
        }
        let least = simd.reduce_min_f32x16(limits);
        with_lane(simd, &self.nodes.limit, node_idx, least).store_slice(&mut self.nodes.limit);
    }

    fn note_other(&mut self, group_idx: usize, slot: u32) {
        if self.others.len() <= group_idx {
            self.others.resize_with(LARGEST_TILE / LANES, Vec::new);
        }
        self.others[group_idx].push(slot);
    }

    /// Tests spheres and user primitives, group by group.
    #[inline(always)]
    fn trace_others<S: Simd>(
        &mut self,
        simd: S,
        work: &TileWork<'_>,
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
            + self.boxes.capacity() * size_of::<PointBoxes>()
            + others
    }
}

/// A column with one lane replaced.
#[inline(always)]
fn with_lane<S: Simd>(simd: S, column: &Lanes, lane: usize, value: f32) -> f32x16<S> {
    let one = mask32x16::from_bitmask(simd, 1 << lane);
    one.select(f32x16::splat(simd, value), f32x16::from_slice(simd, column))
}

impl Group {
    const EMPTY: Self = Self {
        x: [0.0; LANES],
        y: [0.0; LANES],
        limit: [0.0; LANES],
        begin: [0.0; LANES],
        pace: [0.0; LANES],
        start: [0.0; LANES],
        rays: RayPacket::EMPTY,
        masks: [0; LANES],
        active: 0,
        t: [f32::INFINITY; LANES],
        u: [0.0; LANES],
        v: [0.0; LANES],
        ranks: [u32::MAX; LANES],
    };

    /// Takes sixteen rays; returns the box around those to be traced.
    #[inline(always)]
    fn load<S: Simd>(&mut self, simd: S, face: &Face, columns: &mut RayColumns) -> PointBox {
        let active = columns.states(simd).active;
        self.active = active.to_bitmask();
        columns.repeat_active(self.active);
        let (origin, direction) = (columns.origin(simd), columns.direction(simd));
        let points = face.project_rays(simd, origin, direction);
        let t_min = f32x16::from_slice(simd, &columns.t_min);
        let t_max = f32x16::from_slice(simd, &columns.t_max);
        let limit = face.limit(simd, &points, t_max);
        let begin = face.begin(simd, &points, t_min);
        begin.store_slice(&mut self.begin);
        self.rays.fill(simd, origin, direction, [t_min, t_max]);
        points.x.store_slice(&mut self.x);
        points.y.store_slice(&mut self.y);
        points.pace.store_slice(&mut self.pace);
        points.start.store_slice(&mut self.start);
        limit.store_slice(&mut self.limit);
        self.masks = columns.masks;
        self.t = [f32::INFINITY; LANES];
        self.ranks = [u32::MAX; LANES];
        PointBox::around(simd, [points.x, points.y, limit, begin], active)
    }

    /// Tests a triangle. Returns whether what the group accepts has changed.
    #[inline(always)]
    fn test<S: Simd>(
        &mut self,
        simd: S,
        face: &Face,
        triangle: &FaceTriangle,
        question: Question,
        stats: &mut TraceStats,
    ) -> bool {
        let load = f32x16::from_slice;
        let points = [
            load(simd, &self.x),
            load(simd, &self.y),
            load(simd, &self.limit),
            load(simd, &self.begin),
        ];
        let may_hit = triangle.may_hit(simd, points) & mask32x16::from_bitmask(simd, self.active);
        if !may_hit.any_true() {
            return false;
        }
        let seen = u32x16::from_slice(simd, &self.masks) & u32x16::splat(simd, triangle.mask());
        let active = may_hit & !seen.simd_eq(u32x16::splat(simd, 0));
        stats.triangle_tests += LANES as u64;
        let hits = intersect_packet(simd, &self.rays, &triangle.corners(), active);
        if !hits.accepted.any_true() {
            return false;
        }
        self.keep_nearer(simd, face, hits.accepted, [hits.t, hits.u, hits.v], triangle.rank());
        if question == Question::Occluded {
            self.active &= !hits.accepted.to_bitmask();
        }
        true
    }

    /// Updates the lanes whose hit is nearer.
    #[inline(always)]
    fn keep_nearer<S: Simd>(
        &mut self,
        simd: S,
        face: &Face,
        accepted: mask32x16<S>,
        [t, u, v]: [f32x16<S>; 3],
        rank: u32,
    ) {
        let load = f32x16::from_slice;
        let (best_t, best_u, best_v) =
            (load(simd, &self.t), load(simd, &self.u), load(simd, &self.v));
        let best_rank = u32x16::from_slice(simd, &self.ranks);
        let rank = u32x16::splat(simd, rank);
        let tie = t.simd_eq(best_t) & rank.simd_lt(best_rank);
        let nearer = accepted & (t.simd_lt(best_t) | tie);
        nearer.select(t, best_t).store_slice(&mut self.t);
        nearer.select(u, best_u).store_slice(&mut self.u);
        nearer.select(v, best_v).store_slice(&mut self.v);
        nearer.select(rank, best_rank).store_slice(&mut self.ranks);
        let points = RayPoints {
            x: load(simd, &self.x),
            y: load(simd, &self.y),
            pace: load(simd, &self.pace),
            start: load(simd, &self.start),
            on_face: nearer,
        };
        let limit = face.limit(simd, &points, t);
        nearer.select(limit, load(simd, &self.limit)).store_slice(&mut self.limit);
    }

    /// The least nearness at which a ray that wants an answer accepts a hit.
    #[inline(always)]
    fn least_limit<S: Simd>(&self, simd: S) -> f32 {
        let active = mask32x16::from_bitmask(simd, self.active);
        let limit = f32x16::from_slice(simd, &self.limit);
        simd.reduce_min_f32x16(active.select(limit, f32x16::splat(simd, f32::INFINITY)))
    }

    /// Puts the rays that want an answer into a packet.
    fn fill(
        &self,
        packet: &mut TracePacket,
        rays: &RayBatch<'_>,
        ray_idx: &[u32],
        t_bounds: Option<&[f32]>,
    ) {
        packet.clear();
        for (lane, &ray_idx) in ray_idx.iter().enumerate() {
            if self.active & (1 << lane) != 0 {
                let ray = rays.ray(ray_idx as usize);
                let t_bound = t_bounds.map_or(f32::INFINITY, |bounds| bounds[ray_idx as usize]);
                packet.set(lane, &ray, t_bound.min(self.t[lane]));
            }
        }
    }

    /// Keeps what a packet has found where it is nearer.
    fn offer(&mut self, packet: &TracePacket) {
        for lane in 0..LANES {
            let mut nearest = self.nearest(lane);
            nearest.offer(packet.nearest(lane));
            (self.t[lane], self.u[lane], self.v[lane]) = (nearest.t, nearest.u, nearest.v);
            self.ranks[lane] = nearest.rank;
        }
    }

    fn nearest(&self, lane: usize) -> Nearest {
        Nearest { t: self.t[lane], u: self.u[lane], v: self.v[lane], rank: self.ranks[lane] }
    }

    #[inline(always)]
    fn answer(&self, ray_idx: &[u32], answers: &Answers) {
        for (lane, &ray_idx) in ray_idx.iter().enumerate() {
            if ray_idx != NO_RAY {
                answers.set(ray_idx as usize, &self.nearest(lane));
            }
        }
    }
}
