//! Sixteen rays of a band: what every triangle asks of them, and what only some triangles do.

use rayflock_geom::RayBatch;
use rayflock_geom::simd::face::{Face, RayPoints};
use rayflock_geom::simd::ray_triangle::{LaneHits, RayPacket};
use rayflock_geom::simd::{
    LANES, Lanes, Select, Simd, SimdBase, SimdMask, f32x16, mask32x16, u32x16,
};

use super::super::arrange::NO_RAY;
use super::ray_columns::RayColumns;
use crate::answers::Answers;
use crate::packet::{Nearest, TracePacket};

/// What every triangle asks of sixteen rays.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct GroupPoints {
    pub(super) x: Lanes,
    pub(super) y: Lanes,
    /// The least nearness at which a ray accepts a hit; infinite where it wants none any more.
    pub(super) limit: Lanes,
    /// The largest such nearness.
    pub(super) begin: Lanes,
}

/// Sixteen rays and what they hit.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Group {
    pace: Lanes,
    start: Lanes,
    /// Between which nearness rays accept hits for certain, where that is asked.
    surely: [Lanes; 2],
    pub(super) rays: RayPacket,
    pub(super) masks: [u32; LANES],
    /// Rays that still want an answer.
    pub(super) active: u64,
    t: Lanes,
    u: Lanes,
    v: Lanes,
    ranks: [u32; LANES],
}

impl GroupPoints {
    pub(super) const EMPTY: Self =
        Self { x: [0.0; LANES], y: [0.0; LANES], limit: [0.0; LANES], begin: [0.0; LANES] };

    /// All in registers.
    #[inline(always)]
    pub(super) fn columns<S: Simd>(&self, simd: S) -> [f32x16<S>; 4] {
        let load = f32x16::from_slice;
        [load(simd, &self.x), load(simd, &self.y), load(simd, &self.limit), load(simd, &self.begin)]
    }

    /// Takes sixteen rays.
    #[inline(always)]
    pub(super) fn load<S: Simd>(
        &mut self,
        simd: S,
        face: &Face,
        columns: &mut RayColumns,
        active: mask32x16<S>,
    ) -> RayPoints<S> {
        columns.repeat_active(active.to_bitmask());
        let (origin, direction) = (columns.origin(simd), columns.direction(simd));
        let points = face.project_rays(simd, origin, direction);
        let [t_min, t_max] = columns.interval(simd);
        let limit = face.limit(simd, &points, t_max);
        let begin = face.begin(simd, &points, t_min);
        points.x.store_slice(&mut self.x);
        points.y.store_slice(&mut self.y);
        let none = f32x16::splat(simd, f32::INFINITY);
        active.select(limit, none).store_slice(&mut self.limit);
        begin.store_slice(&mut self.begin);
        points
    }
}

impl Group {
    pub(super) const EMPTY: Self = Self {
        pace: [0.0; LANES],
        start: [0.0; LANES],
        surely: [[0.0; LANES]; 2],
        rays: RayPacket::EMPTY,
        masks: [0; LANES],
        active: 0,
        t: [f32::INFINITY; LANES],
        u: [0.0; LANES],
        v: [0.0; LANES],
        ranks: [u32::MAX; LANES],
    };

    /// Takes sixteen rays of which these are to be traced.
    #[inline(always)]
    pub(super) fn begin<S: Simd>(
        &mut self,
        simd: S,
        points: &RayPoints<S>,
        columns: &RayColumns,
        active: u64,
    ) {
        points.pace.store_slice(&mut self.pace);
        points.start.store_slice(&mut self.start);
        let interval = columns.interval(simd);
        self.rays.fill(simd, columns.origin(simd), columns.direction(simd), interval);
        self.masks = columns.masks;
        self.active = active;
        self.t = [f32::INFINITY; LANES];
        self.ranks = [u32::MAX; LANES];
    }

    /// Notes which hits of the rays are certain.
    #[inline(always)]
    pub(super) fn note_surely<S: Simd>(
        &mut self,
        simd: S,
        face: &Face,
        points: &RayPoints<S>,
        columns: &RayColumns,
    ) {
        let [least, most] = face.surely(simd, points, columns.interval(simd));
        least.store_slice(&mut self.surely[0]);
        most.store_slice(&mut self.surely[1]);
    }

    /// Points, the least and the largest nearness at which the rays accept hits for certain.
    #[inline(always)]
    pub(super) fn surely<S: Simd>(&self, simd: S, points: &GroupPoints) -> [f32x16<S>; 4] {
        let load = f32x16::from_slice;
        let [least, most] = &self.surely;
        [load(simd, &points.x), load(simd, &points.y), load(simd, least), load(simd, most)]
    }

    /// Notes that a primitive stands in the way of some rays.
    #[inline(always)]
    pub(super) fn occlude<S: Simd>(
        &mut self,
        simd: S,
        points: &mut GroupPoints,
        occluded: mask32x16<S>,
        rank: u32,
    ) {
        let load = f32x16::from_slice;
        self.active &= !occluded.to_bitmask();
        let infinite = f32x16::splat(simd, f32::INFINITY);
        occluded.select(infinite, load(simd, &points.limit)).store_slice(&mut points.limit);
        let (rank, ranks) = (u32x16::splat(simd, rank), u32x16::from_slice(simd, &self.ranks));
        occluded.select(rank, ranks).store_slice(&mut self.ranks);
    }

    /// Keeps what was accepted of a primitive, where it is nearer; the points take over what the
    /// rays accept from now on.
    #[inline(always)]
    pub(super) fn keep<S: Simd>(
        &mut self,
        simd: S,
        (face, points): (&Face, &mut GroupPoints),
        hits: &LaneHits<S>,
        rank: u32,
    ) {
        let load = f32x16::from_slice;
        let (t, best_t) = (hits.t, load(simd, &self.t));
        let best_rank = u32x16::from_slice(simd, &self.ranks);
        let rank = u32x16::splat(simd, rank);
        let tie = t.simd_eq(best_t) & rank.simd_lt(best_rank);
        let nearer = hits.accepted & (t.simd_lt(best_t) | tie);
        nearer.select(t, best_t).store_slice(&mut self.t);
        let [u, v] = hits.barycentric();
        nearer.select(u, load(simd, &self.u)).store_slice(&mut self.u);
        nearer.select(v, load(simd, &self.v)).store_slice(&mut self.v);
        nearer.select(rank, best_rank).store_slice(&mut self.ranks);
        let limit = self.limit(simd, face, points, t);
        nearer.select(limit, load(simd, &points.limit)).store_slice(&mut points.limit);
    }

    /// The least nearness at which the rays accept hits up to `t`.
    #[inline(always)]
    fn limit<S: Simd>(
        &self,
        simd: S,
        face: &Face,
        points: &GroupPoints,
        t: f32x16<S>,
    ) -> f32x16<S> {
        let load = f32x16::from_slice;
        let at = RayPoints {
            x: load(simd, &points.x),
            y: load(simd, &points.y),
            pace: load(simd, &self.pace),
            start: load(simd, &self.start),
            on_face: mask32x16::splat(simd, true),
        };
        face.limit(simd, &at, t)
    }

    /// Puts the rays that want an answer into a packet.
    pub(super) fn fill(
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
    pub(super) fn offer(&mut self, packet: &TracePacket) {
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
    pub(super) fn answer(&self, ray_idx: &[u32], answers: &Answers) {
        for (lane, &ray_idx) in ray_idx.iter().enumerate() {
            if ray_idx != NO_RAY {
                answers.set(ray_idx as usize, &self.nearest(lane));
            }
        }
    }
}
