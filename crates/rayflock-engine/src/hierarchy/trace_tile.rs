//! Traces the sixteen rays of a tile against its candidates, nearest first.

use rayflock_geom::simd::Simd;
use rayflock_geom::{RayBatch, RayState};

use super::arrange::NO_RAY;
use super::candidates::Candidates;
use crate::TraceStats;
use crate::packet::{Nearest, Question, TracePacket};
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
            if ray_idx != NO_RAY {
                let ray = batch.ray(ray_idx as usize);
                if ray.state() == RayState::Active {
                    self.packet.set(lane, &ray, t_bound(ray_idx as usize));
                }
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
        // Bits of distances that are not negative sort as the distances do; max takes NaN to 0.
        let key = |(slot, nearest): (u32, f32)| {
            (u64::from(nearest.max(0.0).to_bits()) << 32) | u64::from(slot)
        };
        self.by_distance.clear();
        self.by_distance.extend(candidates.iter().map(key));
        self.by_distance.sort_unstable();

        let mut far = self.packet.far_distance();
        for &key in &self.by_distance {
            let (nearest, slot) = (f32::from_bits((key >> 32) as u32), key as u32);
            if nearest > far {
                break;
            }
            if self.packet.test(simd, table, slot, question, stats) {
                far = self.packet.far_distance();
            }
        }
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
