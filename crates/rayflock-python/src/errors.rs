//! Which exception tells of what.

use pyo3::PyErr;
use pyo3::exceptions::{PyIndexError, PyKeyError, PyRuntimeError, PyTypeError, PyValueError};
use rayflock::engine::EngineError;
use rayflock::geom::{GeometryError, RayBatchError};
use rayflock::render::sensor::SensorError;
use rayflock::scene::SceneError;

/// Why something cannot be done.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Geometry does not hang together.
    Geometry(GeometryError),
    /// An engine cannot do what it is asked.
    Engine(EngineError),
    /// No object has this id.
    UnknownId(u32),
    /// An argument that has no place where it is given, in words.
    Argument(String),
    /// Something else that the user can put right, in words.
    Value(String),
}

impl Failure {
    /// Something that the user can put right.
    pub(crate) fn value(message: impl Into<String>) -> Self {
        Self::Value(message.into())
    }
}

impl From<GeometryError> for Failure {
    fn from(error: GeometryError) -> Self {
        Self::Geometry(error)
    }
}

impl From<EngineError> for Failure {
    fn from(error: EngineError) -> Self {
        Self::Engine(error)
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::Value(error.to_string())
    }
}

impl From<RayBatchError> for Failure {
    fn from(error: RayBatchError) -> Self {
        Self::Value(error.to_string())
    }
}

impl From<SensorError> for Failure {
    fn from(error: SensorError) -> Self {
        match error {
            SensorError::Engine(error) => Self::Engine(error),
            error @ SensorError::UnsuitableOption { .. } => Self::Argument(error.to_string()),
            error => Self::Value(error.to_string()),
        }
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Geometry(error @ GeometryError::VertexIndex { .. }) => {
                PyIndexError::new_err(error.to_string())
            }
            Failure::Geometry(error) => PyValueError::new_err(error.to_string()),
            Failure::Engine(error @ EngineError::UnknownEngine(_)) => {
                PyValueError::new_err(error.to_string())
            }
            Failure::Engine(error) => PyRuntimeError::new_err(error.to_string()),
            Failure::UnknownId(id) => PyKeyError::new_err(format!(
                "no object has the id {id}: it was never added, or has been removed"
            )),
            Failure::Argument(message) => PyTypeError::new_err(message),
            Failure::Value(message) => PyValueError::new_err(message),
        }
    }
}
