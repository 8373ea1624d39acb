//! Why something cannot be measured.

use std::io;
use std::path::PathBuf;

use rayflock::engine::EngineError;
use rayflock::render::RenderError;
use rayflock::scene::SceneError;
use rayon::ThreadPoolBuildError;
use thiserror::Error;

use crate::peer::PeerError;
use crate::work::RayKind;

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
    /// An engine has handed its work over to another, as when a device is lost.
    #[error("{engine} cannot be measured: {notice}")]
    HandedOver {
        /// Its name.
        engine: String,
        /// What it says itself.
        notice: String,
    },
    /// An engine of others cannot be had.
    #[error(transparent)]
    Peer(#[from] PeerError),
    /// An engine cannot do what the work needs.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// Threads cannot be started.
    #[error("cannot start threads")]
    Threads(#[from] ThreadPoolBuildError),
    /// No kind of rays has this name.
    #[error("unknown kind of rays \"{0}\"; there are: {names}", names = kind_names())]
    UnknownKind(String),
    /// A count that is none.
    #[error("found the count {0:?}, expected a whole number above 0, as it is or with K or M")]
    Count(String),
    /// A definition cannot be read.
    #[error("{path}: cannot be read")]
    ReadDefinition {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A definition is not TOML of the expected form.
    #[error("{path}: {source}")]
    DefinitionForm {
        /// The file.
        path: PathBuf,
        /// Where and why.
        source: Box<toml::de::Error>,
    },
    /// A definition says something that cannot be measured.
    #[error("{path}: {key}: found {found}, expected {expected}")]
    DefinitionValue {
        /// The file.
        path: PathBuf,
        /// The key whose value is wrong, with its position in a list.
        key: String,
        /// The value.
        found: String,
        /// What it could be.
        expected: String,
    },
    /// A record cannot be read.
    #[error("{path}: cannot be read")]
    ReadRecord {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A file is no record.
    #[error("{path}: line {line}: {message}; expected a record written by --json")]
    RecordForm {
        /// The file.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
        /// What is wrong there, and what was expected instead.
        message: String,
    },
    /// A chart cannot be drawn.
    #[error("cannot draw a chart: {0}")]
    Draw(String),
}

impl BenchError {
    /// An error where an engine's `notice` says that another does its work.
    pub(crate) fn unless_own(engine: &str, notice: Option<&str>) -> Result<(), Self> {
        let Some(notice) = notice else { return Ok(()) };
        Err(Self::HandedOver { engine: engine.to_owned(), notice: notice.to_owned() })
    }
}

fn kind_names() -> String {
    RayKind::ALL.map(RayKind::name).join(", ")
}
