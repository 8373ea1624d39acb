//! Ways between points and virtual lights as shadow rays, from either end.
//!
//! Both ends lie off their surfaces by more than rounding; still, at the point a little of the way
//! is left out, as the other end of a ray is only as exact as its direction.

use glam::Vec3;
use rayflock_engine::RayEngine;
use rayflock_geom::{RayBatch, RayOrder};

use crate::stats::{StageStats, Stopwatch};
use crate::wave::Shared;

/// So much of the way is left out at the point.
const AT_POINT: f32 = 4e-6;

/// Where rays start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Start {
    /// At lights; the ways end at points.
    Light,
    /// At points; the ways end at lights.
    Point,
    /// At points, and there is no end: lights are far away.
    PointOfDistant,
}

/// Shadow rays, and what the engine said of them.
#[derive(Debug, Default)]
pub(crate) struct ShadowSegments {
    origins: Vec<Vec3>,
    ways: Vec<Vec3>,
    occluded: Vec<bool>,
}

impl ShadowSegments {
    /// Number of rays.
    pub(crate) fn len(&self) -> usize {
        self.origins.len()
    }

    /// No rays, keeping the memory.
    pub(crate) fn clear(&mut self) {
        self.origins.clear();
        self.ways.clear();
    }

    /// Adds a ray.
    #[inline]
    pub(crate) fn push(&mut self, origin: Vec3, way: Vec3) {
        self.origins.push(origin);
        self.ways.push(way);
    }

    /// Takes over the rays of `other`.
    pub(crate) fn append(&mut self, other: &mut Self) {
        self.origins.append(&mut other.origins);
        self.ways.append(&mut other.ways);
    }

    /// Asks `engine` about all rays; `shared` is what they share.
    pub(crate) fn trace(
        &mut self,
        engine: &mut dyn RayEngine,
        (start, shared): (Start, Shared),
        order: RayOrder,
    ) -> StageStats {
        self.occluded.clear();
        if self.origins.is_empty() {
            return StageStats::default();
        }
        self.occluded.resize(self.origins.len(), false);
        let (origins, ways) = (&self.origins[..], &self.ways[..]);
        let batch = match shared {
            Shared::Nothing => RayBatch::new(origins, ways),
            Shared::Origin(origin) => RayBatch::new(origin, ways),
            Shared::Direction(way) => RayBatch::new(origins, way),
        };
        let (t_min, t_max) = match start {
            Start::Light => (0.0, 1.0 - AT_POINT),
            Start::Point => (AT_POINT, 1.0),
            Start::PointOfDistant => (0.0, f32::INFINITY),
        };
        let batch = batch.and_then(|batch| batch.with_interval(t_min, t_max));
        let Ok(batch) = batch else { unreachable!("there is an origin for each way") };
        let stopwatch = Stopwatch::start();
        let trace = engine.occluded(&batch.with_order(order), &mut self.occluded);
        StageStats { trace, seconds: stopwatch.seconds() }
    }

    /// Whether something is in the way of each ray that was traced last.
    pub(crate) fn occluded(&self) -> &[bool] {
        &self.occluded
    }

    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        (self.origins.capacity() + self.ways.capacity()) * size_of::<Vec3>()
            + self.occluded.capacity()
    }
}
