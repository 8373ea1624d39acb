//! Sixteen rays on their way through the primitives: what was nearest so far, and the tests that
//! bring it nearer.
//!
//! Both questions, `closest_hit` and `occluded`, run through [`TracePacket::test`]; the latter
//! retires rays as soon as anything is hit.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use rayflock_geom::simd::ray_sphere::{SphereRays, intersect_sphere};
use rayflock_geom::simd::ray_triangle::{LaneHits, RayPacket, ShearedRay, intersect_packet};
use rayflock_geom::simd::{
    Bytes, LANES, Lanes, Select, Simd, SimdBase, SimdMask, f32x16, mask32x16, u32x16,
};
use rayflock_geom::{Ray, RayTransform, UserHit};

use crate::TraceStats;
use crate::primitives::{PrimitiveTable, SPHERE_BYTES, SlotKind, TRIANGLE_BYTES};

/// The nearest hit of one ray so far.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Nearest {
    pub(crate) t: f32,
    pub(crate) u: f32,
    pub(crate) v: f32,
    /// Rank of the primitive; `u32::MAX` for none.
    pub(crate) rank: u32,
}

impl Nearest {
    /// Nothing yet.
    pub(crate) const NONE: Self = Self { t: f32::INFINITY, u: 0.0, v: 0.0, rank: u32::MAX };

    /// Whether there is nothing yet.
    pub(crate) const fn is_none(&self) -> bool {
        self.rank == u32::MAX
    }

    /// Keeps the nearer of both, the lower rank when they are equally near.
    #[inline(always)]
    pub(crate) fn offer(&mut self, other: Self) {
        if other.t < self.t || (other.t == self.t && other.rank < self.rank) {
            *self = other;
        }
    }

    /// Keeps the nearest of the triangles that one ray hit; `ranks` are those of all sixteen.
    #[inline(always)]
    pub(crate) fn offer_lanes<S: Simd>(&mut self, hits: &LaneHits<S>, ranks: &[u32; LANES]) {
        let mut accepted = hits.accepted.to_bitmask();
        let [u, v] = hits.barycentric();
        while accepted != 0 {
            let lane = accepted.trailing_zeros() as usize;
            accepted &= accepted - 1;
            let (t, u, v) = (hits.t[lane], u[lane], v[lane]);
            self.offer(Self { t, u, v, rank: ranks[lane] });
        }
    }
}

/// Writes the lanes in `hit`, given as columns, to sixteen rows.
#[inline(always)]
pub(crate) fn write_rows<S: Simd>(
    simd: S,
    hit: u64,
    [t, u, v]: [f32x16<S>; 3],
    ranks: u32x16<S>,
    rows: &mut [Nearest; LANES],
) {
    let ranks: f32x16<S> = ranks.bitcast();
    let ((t_v, t_v_high), (u_rank, u_rank_high)) = (t.interleave(v), u.interleave(ranks));
    let ((first, second), (third, fourth)) =
        (t_v.interleave(u_rank), t_v_high.interleave(u_rank_high));
    let words: &mut [f32] = bytemuck::cast_slice_mut(rows);
    for (idx, rows) in [first, second, third, fourth].into_iter().enumerate() {
        // A bit for each of four rows becomes four bits.
        let bits = hit >> (4 * idx) & 0xf;
        let bits = (bits | bits << 3 | bits << 6 | bits << 9) & 0x1111;
        let written = mask32x16::from_bitmask(simd, 0xf * bits);
        let words = &mut words[idx * LANES..(idx + 1) * LANES];
        written.select(rows, f32x16::from_slice(simd, words)).store_slice(words);
    }
}

/// Bytes that tests of a packet read from the table, each of one primitive against sixteen rays.
/// What user primitives read is not known.
pub(crate) fn packet_test_bytes(tests: &TraceStats) -> u64 {
    let lane_bytes = tests.triangle_tests * TRIANGLE_BYTES + tests.sphere_tests * SPHERE_BYTES;
    lane_bytes / LANES as u64
}

/// What is asked of the rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Question {
    /// The nearest hit.
    Closest,
    /// Whether there is any.
    Occluded,
}

/// Sixteen rays, lanes without a ray included. Kept and filled again tile after tile; columns
/// of lanes that are not active hold anything.
#[derive(Clone, Debug)]
pub(crate) struct TracePacket {
    rays: [Ray; LANES],
    /// Rays that still want an answer.
    active: u64,
    triangle_rays: RayPacket,
    sphere_rays: SphereRays,
    /// Whether `sphere_rays` holds the active rays; filled when the first sphere comes up.
    sphere_rays_filled: bool,
    masks: [u32; LANES],
    /// Length of each direction.
    lengths: Lanes,
    t: Lanes,
    u: Lanes,
    v: Lanes,
    ranks: [u32; LANES],
}

const NO_RAY: Ray = Ray {
    origin: Vec3::ZERO,
    direction: Vec3::Z,
    t_min: f32::INFINITY,
    t_max: f32::NEG_INFINITY,
    mask: 0,
};

impl TracePacket {
    /// A packet without rays.
    pub(crate) const EMPTY: Self = Self {
        rays: [NO_RAY; LANES],
        active: 0,
        triangle_rays: RayPacket::EMPTY,
        sphere_rays: SphereRays::EMPTY,
        sphere_rays_filled: false,
        masks: [0; LANES],
        lengths: [0.0; LANES],
        t: [f32::INFINITY; LANES],
        u: [0.0; LANES],
        v: [0.0; LANES],
        ranks: [u32::MAX; LANES],
    };

    /// Takes all rays out.
    #[inline(always)]
    pub(crate) fn clear(&mut self) {
        self.active = 0;
        self.sphere_rays_filled = false;
        self.t = [f32::INFINITY; LANES];
        self.u = [0.0; LANES];
        self.v = [0.0; LANES];
        self.ranks = [u32::MAX; LANES];
    }

    /// Puts an active ray into a lane; hits beyond `t_bound` are of no interest.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, ray: &Ray, t_bound: f32) {
        let ray = Ray { t_max: ray.t_max.min(t_bound), ..*ray };
        if self.active == 0 {
            // Lanes without a ray must not stand in the way of a common axis.
            let kz = ShearedRay::new(&ray).axes[2];
            self.triangle_rays.major = [0, 1].map(|axis| if kz == axis { u16::MAX } else { 0 });
        }
        self.active |= 1 << lane;
        self.rays[lane] = ray;
        self.triangle_rays.set(lane, &ShearedRay::new(&ray));
        self.masks[lane] = ray.mask;
        self.lengths[lane] = direction_length(&ray);
    }

    /// Whether no ray wants an answer any more.
    pub(crate) const fn is_done(&self) -> bool {
        self.active == 0
    }

    /// The nearest hit of a lane.
    pub(crate) fn nearest(&self, lane: usize) -> Nearest {
        Nearest { t: self.t[lane], u: self.u[lane], v: self.v[lane], rank: self.ranks[lane] }
    }

    /// The distance beyond which no active ray accepts a hit, enlarged for rounding.
    #[inline(always)]
    pub(crate) fn far_distance(&self) -> f32 {
        let mut far = f32::NEG_INFINITY;
        for lane in 0..LANES {
            let t_max = self.triangle_rays.t_max[lane].min(self.t[lane]);
            let distance = far_distance(self.triangle_rays.t_min[lane], t_max, self.lengths[lane]);
            let counts = self.active & (1 << lane) != 0;
            far = if counts { far.max(distance) } else { far };
        }
        far
    }

    /// Tests the primitive in `slot` against all rays. Returns whether it was hit at all.
    #[inline(always)]
    pub(crate) fn test<S: Simd>(
        &mut self,
        simd: S,
        table: &PrimitiveTable,
        slot: u32,
        question: Question,
        stats: &mut TraceStats,
    ) -> bool {
        let seen = u32x16::from_slice(simd, &self.masks) & u32x16::splat(simd, table.mask(slot));
        let sees = !seen.simd_eq(u32x16::splat(simd, 0));
        let active = sees & mask32x16::from_bitmask(simd, self.active);
        let rank = table.rank(slot);
        let hit_lanes = match table.kind(slot) {
            SlotKind::Triangle(corners) => {
                stats.triangle_tests += LANES as u64;
                let hits = intersect_packet(simd, &self.triangle_rays, &corners, active);
                let [u, v] = hits.barycentric();
                self.keep_nearer(simd, hits.accepted, [hits.t, u, v], rank)
            }
            SlotKind::Sphere(sphere) => {
                stats.sphere_tests += LANES as u64;
                self.fill_sphere_rays();
                let (accepted, t) = intersect_sphere(simd, &self.sphere_rays, sphere, active);
                let zero = f32x16::splat(simd, 0.0);
                self.keep_nearer(simd, accepted, [t, zero, zero], rank)
            }
            SlotKind::User(user) => {
                let active = active.to_bitmask();
                stats.user_tests += u64::from(active.count_ones());
                let transform = user.transform.as_ref();
                let answer = |rays: &[Ray], hits: &mut [Option<UserHit>]| {
                    user.primitives.intersect(user.prim_idx, rays, hits);
                };
                self.keep_nearer_user(active, rank, transform, answer)
            }
        };
        if question == Question::Occluded {
            self.active &= !hit_lanes;
        }
        hit_lanes != 0
    }

    /// Updates the lanes whose hit is nearer; returns all lanes that were hit.
    #[inline(always)]
    fn keep_nearer<S: Simd>(
        &mut self,
        simd: S,
        accepted: mask32x16<S>,
        [t, u, v]: [f32x16<S>; 3],
        rank: u32,
    ) -> u64 {
        if !accepted.any_true() {
            return 0;
        }
        let load = |lanes: &Lanes| f32x16::from_slice(simd, lanes);
        let (best_t, best_u, best_v) = (load(&self.t), load(&self.u), load(&self.v));
        let best_rank = u32x16::from_slice(simd, &self.ranks);
        let rank = u32x16::splat(simd, rank);
        let tie = t.simd_eq(best_t) & rank.simd_lt(best_rank);
        let nearer = accepted & (t.simd_lt(best_t) | tie);
        nearer.select(t, best_t).store_slice(&mut self.t);
        nearer.select(u, best_u).store_slice(&mut self.u);
        nearer.select(v, best_v).store_slice(&mut self.v);
        nearer.select(rank, best_rank).store_slice(&mut self.ranks);
        accepted.to_bitmask()
    }

    fn keep_nearer_user(
        &mut self,
        active: u64,
        rank: u32,
        transform: Option<&RayTransform>,
        answer: impl Fn(&[Ray], &mut [Option<UserHit>]),
    ) -> u64 {
        // Gather the active rays, in the primitive's own space.
        let mut rays = [NO_RAY; LANES];
        let mut lanes = [0; LANES];
        let mut count = 0;
        for lane in (0..LANES).filter(|lane| active & (1 << lane) != 0) {
            let ray = &self.rays[lane];
            rays[count] = transform.map_or(*ray, |transform| transform.ray_in_object(ray));
            lanes[count] = lane;
            count += 1;
        }
        let mut hits = [None; LANES];
        answer(&rays[..count], &mut hits[..count]);

        // Keep what is nearer; a hit outside the interval is the primitive's mistake.
        let mut hit_lanes = 0;
        for (&lane, hit) in lanes[..count].iter().zip(hits) {
            let Some(UserHit { t, u, v }) = hit else { continue };
            let ray = &self.rays[lane];
            if t.is_finite() && ray.t_min <= t && t <= ray.t_max {
                let mut nearest = self.nearest(lane);
                nearest.offer(Nearest { t, u, v, rank });
                self.t[lane] = nearest.t;
                (self.u[lane], self.v[lane]) = (nearest.u, nearest.v);
                self.ranks[lane] = nearest.rank;
                hit_lanes |= 1 << lane;
            }
        }
        hit_lanes
    }

    fn fill_sphere_rays(&mut self) {
        if !self.sphere_rays_filled {
            self.sphere_rays_filled = true;
            for lane in (0..LANES).filter(|lane| self.active & (1 << lane) != 0) {
                self.sphere_rays.set(lane, &self.rays[lane]);
            }
        }
    }
}

/// The length of a ray's direction, finite even where it overflows `f32`.
pub(crate) fn direction_length(ray: &Ray) -> f32 {
    (ray.direction.as_dvec3().length() as f32).min(f32::MAX)
}

/// The distance beyond which a ray accepts no hit, enlarged for the rounding of length and
/// product. Behind the origin, the farthest hits are the nearest ones.
#[inline(always)]
pub(crate) fn far_distance(t_min: f32, t_max: f32, length: f32) -> f32 {
    let farthest = if t_min < 0.0 { t_max.max(-t_min) } else { t_max };
    let distance = farthest * length;
    let enlarged = distance + distance.abs() * 1e-6 + f32::MIN_POSITIVE;
    if distance.is_finite() { enlarged } else { distance }
}

/// The direction of a ray at unit length, whatever its length was.
pub(crate) fn unit_direction(ray: &Ray) -> Vec3 {
    (ray.direction / ray.direction.abs().max_element()).normalize()
}
