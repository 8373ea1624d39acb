//! The library obvhs as an engine.

use rayflock::engine::{CommitStats, EngineError, RayEngine, TraceStats};
use rayflock::geom::{FrameChanges, Geometry, Hits, RayBatch};

/// Traces with obvhs.
#[derive(Debug, Default)]
pub struct ObvhsEngine;

impl ObvhsEngine {
    /// An engine with an empty frame.
    pub fn new() -> Self {
        Self
    }
}

impl RayEngine for ObvhsEngine {
    fn name(&self) -> &str {
        "obvhs"
    }

    fn commit(&mut self, _: &Geometry, _: &FrameChanges) -> Result<CommitStats, EngineError> {
        Ok(CommitStats::default())
    }

    fn closest_hit(&mut self, _: &RayBatch<'_>, _: &mut Hits<'_>) -> TraceStats {
        TraceStats::default()
    }

    fn occluded(&mut self, _: &RayBatch<'_>, _: &mut [bool]) -> TraceStats {
        TraceStats::default()
    }

    fn memory_usage(&self) -> usize {
        0
    }
}
