//! Traces the sixteen rays of a tile against its candidates, nearest first.

use rayflock_geom::RayBatch;
use rayflock_geom::simd::Simd;

use super::arrange::active_ray;
use super::candidates::Candidates;
use crate::TraceStats;
use crate::packet::{Nearest, Question, TracePacket, packet_test_bytes};
use crate::primitives::PrimitiveTable;

/// A tile at work.
#[derive(Debug)]
pub(super) struct TileTracer {
    packet: TracePacket,
    /// Candidates as `distance bits << 32 | slot`.
    by_distance: Vec<u64>,
}

impl Default for TileTracer {
    fn default() -> Self {
        Self { packet: TracePacket::EMPTY, by_distance: Vec::new() }
    }
}

impl TileTracer {
    /// Takes in the active rays of a tile.
    #[inline(always)]
    pub(super) fn gather(
        &mut self,
        batch: &RayBatch<'_>,
        ray_idx: &[u32],
        t_bound: &impl Fn(usize) -> f32,
    ) {
        self.packet.clear();
        for (lane, &ray_idx) in ray_idx.iter().enumerate() {
            if let Some(ray) = active_ray(batch, ray_idx) {
                self.packet.set(lane, &ray, t_bound(ray_idx as usize));
            }
        }
    }

    /// Tests candidates from near to far, until those left lie beyond every ray's hit.
    #[inline(always)]
    pub(super) fn trace<S: Simd>(
        &mut self,
        simd: S,
        table: &PrimitiveTable,
        candidates: &Candidates,
        question: Question,
        stats: &mut TraceStats,
    ) {
        candidates.sort_by_distance(&mut self.by_distance);
        let mut tests = TraceStats::default();
        let mut far = self.packet.far_distance();
        for &key in &self.by_distance {
            if Candidates::distance(key) > far {
                break;
            }
            if self.packet.test(simd, table, Candidates::slot(key), question, &mut tests) {
                far = self.packet.far_distance();
            }
        }
        tests.bytes = candidates.sorted_bytes() + packet_test_bytes(&tests);
        *stats += tests;
    }

    /// Hands out the nearest hit of each lane.
    #[inline(always)]
    pub(super) fn store(&self, nearest: &mut [Nearest]) {
        for (lane, nearest) in nearest.iter_mut().enumerate() {
            *nearest = self.packet.nearest(lane);
        }
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        size_of::<Self>() + 8 * self.by_distance.capacity()
    }
}
