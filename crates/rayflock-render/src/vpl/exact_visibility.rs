//! Exact visibility: a shadow ray for each pair.
//!
//! Rays are traced from the light, so that all rays of a light share their origin, or their
//! direction where it is far away: both are what engines are best at. Lights with few rays are
//! put together in one batch. Rays of a light follow the points, which are neighbours in the
//! picture as a rule.

use rayflock_engine::RayEngine;
use rayflock_geom::RayOrder;

use super::shadow_segments::{ShadowSegments, Start};
use super::{PairTile, PairVisibility, VisibilityStats};
use crate::stats::StageStats;
use crate::wave::Shared;

/// A light with fewer rays than this shares a batch with others.
const OWN_BATCH: usize = 512;
/// A batch that lights share is traced when it has so many rays.
const SHARED_BATCH: usize = 1 << 16;

/// Traces shadow rays through any engine.
#[derive(Debug)]
pub(crate) struct ExactVisibility<'a> {
    engine: &'a mut dyn RayEngine,
    buffers: &'a mut RayBuffers,
    /// What tracing took so far.
    pub(crate) traced: StageStats,
}

/// Working memory, kept from tile to tile.
#[derive(Debug, Default)]
pub(crate) struct RayBuffers {
    own: Rays,
    shared_near: Rays,
    shared_distant: Rays,
}

/// Rays, and which pairs they stand for.
#[derive(Debug, Default)]
struct Rays {
    segments: ShadowSegments,
    pair_idxs: Vec<usize>,
}

impl<'a> ExactVisibility<'a> {
    /// Traces with `engine`.
    pub(crate) fn new(engine: &'a mut dyn RayEngine, buffers: &'a mut RayBuffers) -> Self {
        Self { engine, buffers, traced: StageStats::default() }
    }

    /// Traces the rays of one light.
    fn trace_light(&mut self, tile: &PairTile<'_>, light_idx: usize, shares: &mut [f32]) {
        let position = tile.lights.positions()[light_idx];
        let asked = match tile.lights.is_distant(light_idx) {
            true => (Start::PointOfDistant, Shared::Direction(position)),
            false => (Start::Light, Shared::Origin(position)),
        };
        self.traced += self.buffers.own.answer(self.engine, asked, shares);
    }

    /// Traces the rays that lights share, if there are at least so many.
    fn trace_shared(&mut self, least: usize, shares: &mut [f32]) {
        let RayBuffers { shared_near, shared_distant, .. } = self.buffers;
        for (rays, start) in [(shared_near, Start::Light), (shared_distant, Start::PointOfDistant)]
        {
            if rays.segments.len() >= least {
                self.traced += rays.answer(self.engine, (start, Shared::Nothing), shares);
            }
        }
    }

    /// Makes the rays of one light those of its own batch, or adds them to a shared one.
    fn collect(&mut self, tile: &PairTile<'_>, row: usize, shares: &[f32]) -> usize {
        let light_idx = tile.range.start + row;
        let position = tile.lights.positions()[light_idx];
        let is_distant = tile.lights.is_distant(light_idx);
        let first_pair = row * tile.points.len();
        let asked = shares[first_pair..][..tile.points.len()].iter().zip(tile.points);
        let asked = asked.enumerate().filter(|(_, (share, _))| **share > 0.0);
        let RayBuffers { own, shared_near, shared_distant } = &mut *self.buffers;
        for (point_idx, (_, point)) in asked {
            let (origin, way) =
                if is_distant { (*point, position) } else { (position, *point - position) };
            own.segments.push(origin, way);
            own.pair_idxs.push(first_pair + point_idx);
        }
        let count = own.pair_idxs.len();
        if count < OWN_BATCH {
            let shared = if is_distant { shared_distant } else { shared_near };
            shared.segments.append(&mut own.segments);
            shared.pair_idxs.append(&mut own.pair_idxs);
        }
        count
    }
}

impl PairVisibility for ExactVisibility<'_> {
    fn multiply(&mut self, tile: &PairTile<'_>, shares: &mut [f32]) -> VisibilityStats {
        assert_eq!(shares.len(), tile.len(), "there must be a share for each pair");
        let mut stats = VisibilityStats::default();
        for (row, light_idx) in tile.range.clone().enumerate() {
            let count = self.collect(tile, row, shares);
            stats.pairs += count as u64;
            if count >= OWN_BATCH {
                self.trace_light(tile, light_idx, shares);
            }
            self.trace_shared(SHARED_BATCH, shares);
        }
        self.trace_shared(1, shares);
        stats.rays = stats.pairs;
        stats
    }
}

impl Rays {
    /// Has the engine answer all rays, sets the shares of the pairs whose ray is blocked to 0, and
    /// forgets the rays.
    fn answer(
        &mut self,
        engine: &mut dyn RayEngine,
        asked: (Start, Shared),
        shares: &mut [f32],
    ) -> StageStats {
        let traced = self.segments.trace(engine, asked, RayOrder::Coherent);
        for (pair_idx, occluded) in self.pair_idxs.iter().zip(self.segments.occluded()) {
            if *occluded {
                shares[*pair_idx] = 0.0;
            }
        }
        self.segments.clear();
        self.pair_idxs.clear();
        traced
    }

    fn memory_usage(&self) -> usize {
        self.segments.memory_usage() + self.pair_idxs.capacity() * size_of::<usize>()
    }
}

impl RayBuffers {
    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        let all = [&self.own, &self.shared_near, &self.shared_distant];
        all.into_iter().map(Rays::memory_usage).sum()
    }
}
