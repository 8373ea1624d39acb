//! Traces one ray that has no neighbours worth the name: sixteen triangles at a time.

use rayflock_geom::Ray;
use rayflock_geom::simd::ray_triangle::{ShearedRay, TriangleBlock, intersect_block};
use rayflock_geom::simd::{LANES, Simd, SimdBase, mask32x16, u32x16};

use super::candidates::Candidates;
use crate::TraceStats;
use crate::packet::{
    Nearest, Question, TracePacket, direction_length, far_distance, packet_test_bytes,
};
use crate::primitives::{PrimitiveTable, TRIANGLE_BYTES};

/// A ray at work.
#[derive(Debug)]
pub(super) struct RayTracer {
    /// Holds the ray for primitives that are not triangles.
    packet: TracePacket,
    /// Candidates as `distance bits << 32 | slot`.
    by_distance: Vec<u64>,
    triangles: TriangleGroup,
}

/// Up to sixteen triangles, gathered.
#[derive(Debug)]
struct TriangleGroup {
    corners: TriangleBlock,
    masks: [u32; LANES],
    ranks: [u32; LANES],
    len: usize,
}

impl Default for RayTracer {
    fn default() -> Self {
        let triangles = TriangleGroup {
            corners: TriangleBlock::EMPTY,
            masks: [0; LANES],
            ranks: [0; LANES],
            len: 0,
        };
        Self { packet: TracePacket::EMPTY, by_distance: Vec::new(), triangles }
    }
}

impl RayTracer {
    /// The nearest hit of `ray` among the candidates, or any hit when that is all that is asked.
    #[inline(always)]
    pub(super) fn trace<S: Simd>(
        &mut self,
        simd: S,
        table: &PrimitiveTable,
        ray: &Ray,
        question: Question,
        candidates: &Candidates,
        stats: &mut TraceStats,
    ) -> Nearest {
        candidates.sort_by_distance(&mut self.by_distance);
        stats.bytes += candidates.sorted_bytes();
        let length = direction_length(ray);
        let mut nearest = Nearest::NONE;
        let mut next = 0;
        while next < self.by_distance.len() {
            let far = far_distance(ray.t_min, nearest.t.min(ray.t_max), length);
            let answered = question == Question::Occluded && !nearest.is_none();
            if answered || Candidates::distance(self.by_distance[next]) > far {
                break;
            }
            next = self.test_group(simd, table, ray, next, &mut nearest, stats);
        }
        nearest
    }

    /// Tests the next candidates in order: triangles until a group is full, or one primitive of
    /// another kind. Returns the position after them.
    #[inline(always)]
    fn test_group<S: Simd>(
        &mut self,
        simd: S,
        table: &PrimitiveTable,
        ray: &Ray,
        first: usize,
        nearest: &mut Nearest,
        stats: &mut TraceStats,
    ) -> usize {
        let slots = self.by_distance[first..].iter().map(|&key| Candidates::slot(key));
        self.triangles.gather(table, slots);
        if self.triangles.len > 0 {
            stats.triangle_tests += LANES as u64;
            stats.bytes += self.triangles.len as u64 * TRIANGLE_BYTES;
            self.triangles.test(simd, ray, nearest);
            return first + self.triangles.len;
        }
        let slot = Candidates::slot(self.by_distance[first]);
        self.packet.clear();
        self.packet.set(0, ray, nearest.t);
        let mut tests = TraceStats::default();
        self.packet.test(simd, table, slot, Question::Closest, &mut tests);
        tests.bytes = packet_test_bytes(&tests);
        *stats += tests;
        nearest.offer(self.packet.nearest(0));
        first + 1
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        size_of::<Self>() + 8 * self.by_distance.capacity()
    }
}

impl TriangleGroup {
    /// Gathers the leading triangles among `slots`, up to sixteen.
    #[inline(always)]
    fn gather(&mut self, table: &PrimitiveTable, slots: impl Iterator<Item = u32>) {
        self.len = 0;
        self.masks = [0; LANES];
        for slot in slots.take(LANES).take_while(|&slot| table.is_triangle(slot)) {
            self.corners.set(self.len, table.triangle(slot));
            self.masks[self.len] = table.mask(slot);
            self.ranks[self.len] = table.rank(slot);
            self.len += 1;
        }
    }

    /// Keeps the nearest hit of the gathered triangles.
    #[inline(always)]
    fn test<S: Simd>(&self, simd: S, ray: &Ray, nearest: &mut Nearest) {
        let seen = u32x16::from_slice(simd, &self.masks) & u32x16::splat(simd, ray.mask);
        let active: mask32x16<S> = !seen.simd_eq(u32x16::splat(simd, 0));
        let hits = intersect_block(simd, &ShearedRay::new(ray), &self.corners, active);
        nearest.offer_lanes(&hits, &self.ranks);
    }
}
