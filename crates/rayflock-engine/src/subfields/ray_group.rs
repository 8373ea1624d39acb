//! Sixteen rays at work, and their way past spheres and user primitives.

use glam::Vec3;
use rayflock_geom::Ray;
use rayflock_geom::simd::{LANES, Simd};

use super::asked::Asked;
use super::meet_tile::{Meeting, TileRay};
use crate::TraceStats;
use crate::packet::{Nearest, TracePacket};
use crate::primitives::{SPHERE_BYTES, TRIANGLE_BYTES};

/// Rays at work; kept and filled again.
#[derive(Debug)]
pub(super) struct RayGroup {
    pub(super) rays: [TileRay; LANES],
    /// Positions in the batch.
    pub(super) ray_idx: [usize; LANES],
    /// Rays that are there, one bit a lane.
    pub(super) active: u64,
    /// Slots of other primitives that some ray may hit.
    others: Vec<u32>,
    packet: TracePacket,
    pub(super) stats: TraceStats,
}

impl Default for RayGroup {
    fn default() -> Self {
        Self {
            rays: [TileRay::EMPTY; LANES],
            ray_idx: [0; LANES],
            active: 0,
            others: Vec::new(),
            packet: TracePacket::EMPTY,
            stats: TraceStats::default(),
        }
    }
}

impl TileRay {
    /// A ray that hits nothing.
    const EMPTY: Self = Self {
        axes: [0, 1, 2],
        origin: Vec3::ZERO,
        shear: [0.0, 0.0, 1.0],
        t_min: f32::INFINITY,
        t_max: f32::NEG_INFINITY,
        mask: 0,
        nearest: Nearest::NONE,
    };
}

impl RayGroup {
    /// Begins with other rays.
    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.active = 0;
        self.others.clear();
    }

    /// A ray of the group and what it takes to meet tiles.
    #[inline(always)]
    pub(super) fn at_work<'a>(
        &'a mut self,
        lane: usize,
        asked: &'a Asked<'_>,
    ) -> (&'a mut TileRay, Meeting<'a>) {
        let Self { rays, others, stats, .. } = self;
        (&mut rays[lane], Meeting { asked, others, stats })
    }

    /// Adds slots of primitives that some ray may hit.
    #[inline(always)]
    pub(super) fn note_others(&mut self, slots: impl Iterator<Item = u32>) {
        self.others.extend(slots);
    }

    /// Tests what the tiles hold beside triangles, and what has no tile.
    #[inline(always)]
    pub(super) fn meet_others<S: Simd>(&mut self, simd: S, asked: &Asked<'_>) {
        self.others.extend_from_slice(asked.everywhere);
        if self.others.is_empty() || self.active == 0 {
            return;
        }
        self.others.sort_unstable();
        self.others.dedup();
        self.fill_packet(asked);
        let mut tests = TraceStats::default();
        for &slot in &self.others {
            if !self.packet.is_done() {
                self.packet.test(simd, asked.table, asked.slot(slot), asked.question, &mut tests);
            }
        }
        tests.bytes = (tests.triangle_tests * TRIANGLE_BYTES + tests.sphere_tests * SPHERE_BYTES)
            / LANES as u64;
        self.stats += tests;
        for (lane, ray) in self.rays.iter_mut().enumerate() {
            if self.active & (1 << lane) != 0 {
                ray.nearest.offer(self.packet.nearest(lane));
            }
        }
    }

    fn fill_packet(&mut self, asked: &Asked<'_>) {
        self.packet.clear();
        for (lane, at_work) in self.rays.iter().enumerate() {
            if self.active & (1 << lane) != 0 && !at_work.is_done() {
                let ray = asked.batch.ray(self.ray_idx[lane]);
                self.packet.set(lane, &Ray { t_max: at_work.t_max, ..ray }, f32::INFINITY);
            }
        }
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        size_of::<Self>() + self.others.capacity() * size_of::<u32>()
    }
}
