//! The interface of every renderer of whole frames.

use std::fmt::Debug;

use rayflock_engine::auto::Choice;
use rayflock_engine::{Budget, CommitStats, Fact};
use rayflock_scene::{Scene, SceneFrame};

use crate::{Film, FrameStats, RenderError, RenderSettings, View};

/// Turns a scene at one time into pictures.
///
/// A picture depends on nothing but the scene, the frame, the view and the settings: not on
/// earlier frames, the engine, the SIMD level, or the number of threads. Work runs on the
/// current rayon thread pool.
pub trait FrameRenderer: Debug + Send {
    /// Makes `frame` of `scene` the current one. `frame.changes` must tell how it differs from
    /// the frame committed before, or be [`FrameChanges::all`](rayflock_geom::FrameChanges::all).
    ///
    /// # Errors
    /// [`RenderError`] when surfaces, materials and textures do not fit together or the engine
    /// cannot hold the geometry; there is no current frame then, and pictures show background.
    fn commit(&mut self, scene: &Scene, frame: &SceneFrame) -> Result<CommitStats, RenderError>;

    /// Renders the current frame: every pixel of `film` is written.
    fn render(&mut self, view: &View, settings: &RenderSettings, film: &mut Film) -> FrameStats;

    /// Bytes held besides the scene itself.
    fn memory_usage(&self) -> usize;

    /// Which engine was asked about each batch of rays of the last picture, and why; empty where
    /// nothing was chosen.
    fn choices(&self) -> &[Choice] {
        &[]
    }

    /// Numbers about what the engine holds that only this engine has.
    fn facts(&self) -> Vec<Fact> {
        Vec::new()
    }

    /// What stages on a device took since the last commit, and what is held there; empty where no
    /// device is at work.
    fn budget(&self) -> Budget {
        Budget::default()
    }

    /// What the user should hear of, though the picture is right.
    fn notice(&self) -> Option<&str> {
        None
    }
}
