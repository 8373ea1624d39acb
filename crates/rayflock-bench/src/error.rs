//! Why something cannot be measured.

use rayflock::render::RenderError;
use rayflock::scene::SceneError;
use thiserror::Error;

/// Why something cannot be measured.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum BenchError {
    /// The definition leaves nothing to measure.
    #[error("nothing to measure: found no {0}, expected at least one")]
    Nothing(&'static str),
    /// The scene has no such frame.
    #[error("frame {frame}")]
    Scene {
        /// The frame, counted from 0.
        frame: u32,
        /// What is wrong with it.
        source: SceneError,
    },
    /// A frame cannot be rendered.
    #[error("frame {frame}")]
    Render {
        /// The frame, counted from 0.
        frame: u32,
        /// What is wrong with it.
        source: RenderError,
    },
}
