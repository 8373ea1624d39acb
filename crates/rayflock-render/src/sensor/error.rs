//! Why a sensor cannot sweep.

use std::fmt::Display;

use rayflock_engine::EngineError;
use rayflock_scene::SceneError;
use thiserror::Error;

use crate::RenderError;

/// Why a sensor cannot sweep.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SensorError {
    /// A value that no sensor can have.
    #[error("the {what} is {found}, expected {expected}")]
    Value {
        /// What it is a value of.
        what: &'static str,
        /// The value.
        found: String,
        /// What would be right.
        expected: String,
    },
    /// No preset has this name.
    #[error("unknown sensor \"{found}\"; there are: {expected}")]
    UnknownPreset {
        /// What was asked for.
        found: String,
        /// What there is.
        expected: String,
    },
    /// An option that a preset has no use for.
    #[error("{option} says nothing about the sensor {sensor}, which has {suitable}")]
    UnsuitableOption {
        /// The option.
        option: &'static str,
        /// The preset.
        sensor: String,
        /// The options that it has a use for.
        suitable: String,
    },
    /// No shutter has this name.
    #[error("unknown shutter \"{found}\"; there are: global, rolling")]
    UnknownShutter {
        /// What was asked for.
        found: String,
    },
    /// No choice of returns has this name.
    #[error("unknown returns \"{found}\"; there are: {expected}")]
    UnknownReturns {
        /// What was asked for.
        found: String,
        /// What there is.
        expected: String,
    },
    /// The sensor rides on a camera that is not there.
    #[error("the sensor rides on camera {found}, but the number of cameras is {count}")]
    Camera {
        /// The camera's position.
        found: usize,
        /// Cameras in the scene.
        count: usize,
    },
    /// The scene cannot be evaluated.
    #[error("at {time} s: {source}")]
    Scene {
        /// The time of the scene in seconds.
        time: f64,
        /// What is wrong with it.
        source: SceneError,
    },
    /// The frame does not hang together.
    #[error(transparent)]
    Frame(#[from] RenderError),
    /// The engine cannot hold the geometry.
    #[error(transparent)]
    Engine(#[from] EngineError),
}

/// Fails unless `is_right`.
pub(super) fn ensure_value(
    is_right: bool,
    what: &'static str,
    found: impl Display,
    expected: impl Into<String>,
) -> Result<(), SensorError> {
    if is_right {
        return Ok(());
    }
    Err(SensorError::Value { what, found: found.to_string(), expected: expected.into() })
}
