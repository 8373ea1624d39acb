//! Exact visibility: a shadow ray for each pair.
//!
//! Rays are traced from the light, so that all rays of a light share their origin, or their
//! direction where it is far away: both are what engines are best at. Lights with few rays are
//! put together in one batch.

use glam::Vec3;
use rayflock_engine::RayEngine;
use rayflock_geom::{RayBatch, RayOrder};

use super::{PairTile, PairVisibility, VisibilityStats};
use crate::stats::{StageStats, Stopwatch};

/// Rays end this far before the point, relative to the distance.
const TO_POINT: f32 = 1.0 - 4e-6;
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
    origins: Vec<Vec3>,
    directions: Vec<Vec3>,
    pair_idxs: Vec<usize>,
    occluded: Vec<bool>,
}

impl<'a> ExactVisibility<'a> {
    /// Traces with `engine`.
    pub(crate) fn new(engine: &'a mut dyn RayEngine, buffers: &'a mut RayBuffers) -> Self {
        Self { engine, buffers, traced: StageStats::default() }
    }

    /// Traces the rays of one light.
    fn trace_light(&mut self, position: Vec3, is_distant: bool, shares: &mut [f32]) {
        let rays = &mut self.buffers.own;
        let batch = match is_distant {
            true => RayBatch::new(&rays.origins, position),
            false => RayBatch::new(position, &rays.directions)
                .and_then(|batch| batch.with_interval(0.0, TO_POINT)),
        };
        self.traced += answer(self.engine, batch, &rays.pair_idxs, &mut rays.occluded, shares);
        rays.clear();
    }

    /// Traces the rays that lights share.
    fn trace_shared(&mut self, is_distant: bool, shares: &mut [f32]) {
        let buffers = &mut *self.buffers;
        let rays = if is_distant { &mut buffers.shared_distant } else { &mut buffers.shared_near };
        let t_max = if is_distant { f32::INFINITY } else { TO_POINT };
        let batch = RayBatch::new(&rays.origins, &rays.directions)
            .and_then(|batch| batch.with_interval(0.0, t_max));
        self.traced += answer(self.engine, batch, &rays.pair_idxs, &mut rays.occluded, shares);
        rays.clear();
    }

    /// Makes the rays of one light those of its own batch, or adds them to a shared one.
    fn collect(&mut self, tile: &PairTile<'_>, row: usize, shares: &[f32]) -> usize {
        let light_idx = tile.range.start + row;
        let position = tile.lights.positions()[light_idx];
        let is_distant = tile.lights.is_distant(light_idx);
        let first_pair = row * tile.points.len();
        let asked = shares[first_pair..][..tile.points.len()].iter().zip(tile.points);
        let asked = asked.enumerate().filter(|(_, (share, _))| **share > 0.0);
        let own = &mut self.buffers.own;
        for (point_idx, (_, point)) in asked {
            let (origin, direction) =
                if is_distant { (*point, position) } else { (position, *point - position) };
            own.origins.push(origin);
            own.directions.push(direction);
            own.pair_idxs.push(first_pair + point_idx);
        }
        let count = own.pair_idxs.len();
        if count < OWN_BATCH {
            let shared = if is_distant {
                &mut self.buffers.shared_distant
            } else {
                &mut self.buffers.shared_near
            };
            shared.append(&mut self.buffers.own);
        }
        count
    }
}

impl PairVisibility for ExactVisibility<'_> {
    fn multiply(&mut self, tile: &PairTile<'_>, shares: &mut [f32]) -> VisibilityStats {
        assert_eq!(shares.len(), tile.len(), "there must be a share for each pair");
        let mut stats = VisibilityStats::default();
        for row in 0..tile.range.len() {
            let count = self.collect(tile, row, shares);
            stats.pairs += count as u64;
            let light_idx = tile.range.start + row;
            let is_distant = tile.lights.is_distant(light_idx);
            if count >= OWN_BATCH {
                self.trace_light(tile.lights.positions()[light_idx], is_distant, shares);
            }
            if self.buffers.shared_near.pair_idxs.len() >= SHARED_BATCH {
                self.trace_shared(false, shares);
            }
            if self.buffers.shared_distant.pair_idxs.len() >= SHARED_BATCH {
                self.trace_shared(true, shares);
            }
        }
        self.trace_shared(false, shares);
        self.trace_shared(true, shares);
        stats.rays = stats.pairs;
        stats
    }
}

/// Has the engine answer a batch, and sets the shares of the pairs whose ray is blocked to 0.
fn answer(
    engine: &mut dyn RayEngine,
    batch: Result<RayBatch<'_>, rayflock_geom::RayBatchError>,
    pair_idxs: &[usize],
    occluded: &mut Vec<bool>,
    shares: &mut [f32],
) -> StageStats {
    let Ok(batch) = batch else { unreachable!("the columns of shadow rays have one length") };
    if pair_idxs.is_empty() {
        return StageStats::default();
    }
    occluded.clear();
    occluded.resize(pair_idxs.len(), false);
    let stopwatch = Stopwatch::start();
    let trace = engine.occluded(&batch.with_order(RayOrder::Unordered), occluded);
    let traced = StageStats { trace, seconds: stopwatch.seconds() };
    for (pair_idx, occluded) in pair_idxs.iter().zip(occluded) {
        if *occluded {
            shares[*pair_idx] = 0.0;
        }
    }
    traced
}

impl Rays {
    fn clear(&mut self) {
        self.origins.clear();
        self.directions.clear();
        self.pair_idxs.clear();
    }

    /// Takes over the rays of `other`.
    fn append(&mut self, other: &mut Self) {
        self.origins.append(&mut other.origins);
        self.directions.append(&mut other.directions);
        self.pair_idxs.append(&mut other.pair_idxs);
    }

    fn memory_usage(&self) -> usize {
        (self.origins.capacity() + self.directions.capacity()) * size_of::<Vec3>()
            + self.pair_idxs.capacity() * size_of::<usize>()
            + self.occluded.capacity()
    }
}

impl RayBuffers {
    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        let all = [&self.own, &self.shared_near, &self.shared_distant];
        all.into_iter().map(Rays::memory_usage).sum()
    }
}
