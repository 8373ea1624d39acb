//! The engine.

use rayflock::engine::{CommitStats, EngineError, RayEngine, TraceStats};
use rayflock::geom::{FrameChanges, Geometry, Hits, RayBatch};

use super::{EmbreeLibrary, Setting, Traversal};
use crate::peer::PeerError;

/// Traces with Embree.
#[derive(Debug)]
pub struct EmbreeEngine {
    setting: Setting,
}

impl EmbreeEngine {
    /// An engine with an empty frame.
    ///
    /// # Errors
    /// [`PeerError::Device`] when Embree refuses to work.
    pub fn new(library: &EmbreeLibrary, setting: Setting) -> Result<Self, PeerError> {
        let path = library.path().to_owned();
        let _ = Self { setting };
        Err(PeerError::Device { path, reason: "not yet".to_owned() })
    }

    /// How Embree is used.
    pub fn setting(&self) -> Setting {
        self.setting
    }

    /// Hands rays over in another way from now on; the frame stays.
    pub fn set_traversal(&mut self, traversal: Traversal) {
        self.setting.traversal = traversal;
    }
}

impl RayEngine for EmbreeEngine {
    fn name(&self) -> &str {
        "embree"
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
