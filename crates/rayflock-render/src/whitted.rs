//! The wavefront Whitted renderer.

use rayflock_engine::{CommitStats, RayEngine};
use rayflock_scene::{Scene, SceneFrame};

use crate::{Film, FrameRenderer, FrameStats, RenderError, RenderSettings, View};

/// Renders frames in whole batches of rays over any engine.
#[derive(Debug)]
pub struct WhittedRenderer {
    engine: Box<dyn RayEngine>,
}

impl WhittedRenderer {
    /// A renderer that traces with `engine`.
    pub fn new(engine: Box<dyn RayEngine>) -> Self {
        Self { engine }
    }
}

impl FrameRenderer for WhittedRenderer {
    fn commit(&mut self, _scene: &Scene, frame: &SceneFrame) -> Result<CommitStats, RenderError> {
        Ok(self.engine.commit(&frame.geometry, &frame.changes)?)
    }

    fn render(&mut self, _view: &View, _settings: &RenderSettings, film: &mut Film) -> FrameStats {
        film.pixels_mut().fill([0.0; 3]);
        FrameStats::default()
    }

    fn memory_usage(&self) -> usize {
        self.engine.memory_usage()
    }
}
