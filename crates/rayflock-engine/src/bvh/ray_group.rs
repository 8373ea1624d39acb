//! Sixteen neighbouring rays that go similar ways, and what they hit so far.

use rayflock_geom::simd::neighbours::Slopes;
use rayflock_geom::simd::ray_beams::RayBeam;
use rayflock_geom::simd::ray_lanes::RayLanes;
use rayflock_geom::simd::ray_triangle::{RayPacket, intersect_packet};
use rayflock_geom::simd::{
    LANES, Lanes, Select, Simd, SimdBase, SimdMask, f32x16, mask32x16, u32x16,
};

use glam::Vec3;

use crate::packet::{Nearest, Question, write_rows};

/// Sixteen consecutive rays of a block that travel together.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct RayGroup {
    pub(super) beam: RayBeam,
    /// Position in the block of the first ray.
    pub(super) first: u32,
    /// Rays that still want an answer.
    pub(super) active: u64,
    /// How many more triangles the group may meet, others counted as several.
    tests_left: u32,
    rays: RayPacket,
    masks: [u32; LANES],
    /// The nearest hits; `t` is where a ray's interval ends while there is none.
    t: Lanes,
    u: Lanes,
    v: Lanes,
    ranks: [u32; LANES],
}

/// Triangles that a group meets at most, others counted as several. Sixteen rays alone take about
/// as long as a group with so many, so a group that is too wide for what it crosses costs no more
/// than twice what its rays do.
const MOST_TESTS: u32 = 128;

/// From how many hits on it pays to write sixteen at once.
const MANY: u32 = 3;

/// A triangle of a leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct LeafTriangle {
    pub(super) corners: [Vec3; 3],
    pub(super) mask: u32,
    pub(super) rank: u32,
}

impl RayGroup {
    /// A group without rays, to be filled.
    pub(super) const EMPTY: Self = Self {
        beam: RayBeam::EMPTY,
        first: 0,
        active: 0,
        tests_left: 0,
        rays: RayPacket::EMPTY,
        masks: [0; LANES],
        t: [f32::INFINITY; LANES],
        u: [0.0; LANES],
        v: [0.0; LANES],
        ranks: [u32::MAX; LANES],
    };

    /// Takes in the `active` rays, which are in `beam`; `first` is where the block has the first of
    /// all lanes.
    #[inline(always)]
    pub(super) fn fill<S: Simd>(
        &mut self,
        beam: RayBeam,
        [first, active]: [u32; 2],
        (rays, slopes): (&RayLanes, &Slopes<S>),
        masks: [u32; LANES],
    ) {
        (self.beam, self.masks) = (beam, masks);
        (self.first, self.active, self.tests_left) = (first, active.into(), MOST_TESTS);
        self.rays.fill_sloped(rays, slopes);
        self.t = [f32::INFINITY; LANES];
        self.ranks = [u32::MAX; LANES];
    }

    /// Notes that so many were met; a group that has met too many crosses nothing any more.
    #[inline(always)]
    pub(super) fn spend(&mut self, test_count: u32) {
        self.tests_left = self.tests_left.saturating_sub(test_count);
        if self.is_dissolved() {
            self.beam.set_t_max(f32::NEG_INFINITY);
        }
    }

    /// Whether the rays are to go on alone.
    pub(super) fn is_dissolved(&self) -> bool {
        self.tests_left == 0
    }

    /// Tests a triangle; what is found shortens rays and beam.
    #[inline(always)]
    pub(super) fn test<S: Simd>(&mut self, simd: S, triangle: &LeafTriangle, question: Question) {
        let seen = u32x16::from_slice(simd, &self.masks) & u32x16::splat(simd, triangle.mask);
        let sees = !seen.simd_eq(u32x16::splat(simd, 0));
        let active = sees & mask32x16::from_bitmask(simd, self.active);
        let hits = intersect_packet(simd, &self.rays, &triangle.corners, active);
        if !hits.accepted.any_true() {
            return;
        }
        match question {
            Question::Closest => {
                let [u, v] = hits.barycentric();
                self.keep_nearer(simd, hits.accepted, [hits.t, u, v], triangle.rank);
                self.shorten(simd);
            }
            Question::Occluded => self.occlude(simd, hits.accepted, triangle.rank),
        }
    }

    /// Notes that a triangle stands in the way of some rays.
    #[inline(always)]
    fn occlude<S: Simd>(&mut self, simd: S, occluded: mask32x16<S>, rank: u32) {
        let ranks = u32x16::from_slice(simd, &self.ranks);
        occluded.select(u32x16::splat(simd, rank), ranks).store_slice(&mut self.ranks);
        self.active &= !occluded.to_bitmask();
        if self.active == 0 {
            self.beam.set_t_max(f32::NEG_INFINITY);
        }
    }

    /// Updates the lanes whose hit is nearer.
    #[inline(always)]
    fn keep_nearer<S: Simd>(
        &mut self,
        simd: S,
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
    }

    /// Makes the beam end where no ray wants an answer beyond.
    #[inline(always)]
    fn shorten<S: Simd>(&mut self, simd: S) {
        let load = f32x16::from_slice;
        let end = load(simd, &self.t).min(load(simd, &self.rays.t_max));
        let scaled = end * load(simd, &self.rays.shear[2]).abs();
        let active = mask32x16::from_bitmask(simd, self.active);
        let none = f32x16::splat(simd, f32::NEG_INFINITY);
        self.beam.set_t_max(simd.reduce_max_f32x16(active.select(scaled, none)));
    }

    /// Keeps what was found of a ray by other means, where it is nearer.
    #[inline(always)]
    pub(super) fn offer<S: Simd>(&mut self, simd: S, found: &[Nearest; LANES], question: Question) {
        for (lane, found) in found.iter().enumerate().filter(|(_, found)| !found.is_none()) {
            let mut nearest = self.nearest(lane);
            nearest.offer(*found);
            (self.t[lane], self.u[lane], self.v[lane]) = (nearest.t, nearest.u, nearest.v);
            self.ranks[lane] = nearest.rank;
            if question == Question::Occluded {
                self.active &= !(1 << lane);
            }
        }
        self.shorten(simd);
    }

    /// The nearest hit of a ray so far.
    #[inline(always)]
    pub(super) fn nearest(&self, lane: usize) -> Nearest {
        Nearest { t: self.t[lane], u: self.u[lane], v: self.v[lane], rank: self.ranks[lane] }
    }

    /// Writes the hits of all lanes that have one.
    #[inline(always)]
    pub(super) fn write_hits<S: Simd>(&self, simd: S, nearest: &mut [Nearest]) {
        let ranks = u32x16::from_slice(simd, &self.ranks);
        let mut hit = (!ranks.simd_eq(u32x16::splat(simd, u32::MAX))).to_bitmask();
        if hit.count_ones() > MANY
            && let Some(nearest) = nearest.first_chunk_mut()
        {
            let load = f32x16::from_slice;
            let found = [load(simd, &self.t), load(simd, &self.u), load(simd, &self.v)];
            write_rows(simd, hit, found, ranks, nearest);
            return;
        }
        while hit != 0 {
            let lane = hit.trailing_zeros() as usize;
            hit &= hit - 1;
            nearest[lane] = self.nearest(lane);
        }
    }

    /// Where a ray's interval ends now.
    pub(super) fn end(&self, lane: usize) -> f32 {
        self.t[lane].min(self.rays.t_max[lane])
    }
}
