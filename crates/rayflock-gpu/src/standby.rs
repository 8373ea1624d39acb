//! The engine that answers when the device is lost: nothing that was asked goes unanswered.

use rayflock_engine::{CommitStats, EngineError, EngineKind, RayEngine, create};
use rayflock_geom::{FrameChanges, Geometry};

use crate::GpuError;

/// An engine on the CPU, and why it is at work.
#[derive(Debug)]
pub(crate) struct Standby {
    pub(crate) engine: Box<dyn RayEngine>,
    pub(crate) notice: String,
}

impl Standby {
    /// Takes over a frame that the device held.
    pub(crate) fn take_over(geometry: &Geometry, fault: &GpuError) -> Self {
        let engine = create(EngineKind::Auto);
        let notice = format!("{fault}; the engine {} on the CPU goes on", engine.name());
        let mut standby = Self { engine, notice };
        // The engines of the CPU hold whatever the device holds.
        if let Err(error) = standby.commit(geometry, &FrameChanges::all()) {
            standby.notice = format!("{}; it failed: {error}", standby.notice);
        }
        standby
    }

    pub(crate) fn commit(
        &mut self,
        geometry: &Geometry,
        changes: &FrameChanges,
    ) -> Result<CommitStats, EngineError> {
        self.engine.commit(geometry, changes)
    }
}
