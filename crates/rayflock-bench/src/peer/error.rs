//! Why an engine of others cannot be had.

use std::path::PathBuf;

use rayflock::OwnEngineError;
use rayflock::engine::EngineKind;
use thiserror::Error;

/// Why an engine of others cannot be had.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PeerError {
    /// The text names no engine.
    #[error(
        "unknown engine \"{0}\"; there are: {own}, subfields:SETTING, embree, embree:SETTING, \
         embree:best, obvhs, floor",
        own = EngineKind::ALL.map(EngineKind::name).join(", ")
    )]
    UnknownEngine(String),
    /// An engine of ours cannot be had.
    #[error(transparent)]
    Own(#[from] OwnEngineError),
    /// A word of a setting is not known.
    #[error(
        "\"{word}\" in the setting \"{setting}\" of Embree is not known; expected words joined by \
         +: low, medium or refit; kept, instances or merged; single or packets; coherent; robust"
    )]
    SettingWord {
        /// The word.
        word: String,
        /// The whole setting.
        setting: String,
    },
    /// Words of a setting contradict each other.
    #[error("the setting \"{setting}\" of Embree says both \"{first}\" and \"{second}\"")]
    SettingConflict {
        /// The whole setting.
        setting: String,
        /// One word.
        first: &'static str,
        /// The other.
        second: &'static str,
    },
    /// The best setting was asked for where none can be tried.
    #[error(
        "embree:best is found by trying every setting, which only benchmarks do; give one, such \
         as embree:low+instances+packets"
    )]
    BestOutsideBenchmark,
    /// What answers nothing was asked for answers.
    #[error(
        "floor answers no ray; it is there for bench map, bench scaling and bench scene, to tell \
         what every engine takes at least"
    )]
    FloorOutsideBenchmark,
    /// There is no library.
    #[error(
        "the library Embree 4 was not found; `cargo xtask embree` fetches it, and EMBREE_LIB or \
         --embree-lib say where it is; looked for target/embree in and above {places}",
        places = places(looked_in)
    )]
    LibraryNotFound {
        /// The folders where the search began.
        looked_in: Vec<PathBuf>,
    },
    /// The user named a file that is not there.
    #[error(
        "{path}: found no library there, where {by} says that Embree 4 is; `cargo xtask embree` \
         fetches it",
        path = path.display()
    )]
    NoSuchFile {
        /// The file, or the folder that should hold it.
        path: PathBuf,
        /// What named it: an option or a variable.
        by: &'static str,
    },
    /// The file is not a library that this program can load.
    #[error("{path}: cannot be loaded as Embree: {reason}", path = path.display())]
    NotALibrary {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// The library was made for another processor.
    #[error(
        "{path}: found a library for {found}, expected one for {expected}",
        path = path.display()
    )]
    Architecture {
        /// The file.
        path: PathBuf,
        /// The architecture of the file.
        found: String,
        /// The architecture of this program.
        expected: &'static str,
    },
    /// The library is of another version.
    #[error("{path}: found Embree {found}, expected 4.0.0 or newer, below 5", path = path.display())]
    Version {
        /// The file.
        path: PathBuf,
        /// The version of the library.
        found: String,
    },
    /// The library refuses to work.
    #[error("{path}: Embree cannot be started: {reason}", path = path.display())]
    Device {
        /// The file.
        path: PathBuf,
        /// What the library says.
        reason: String,
    },
}

fn places(looked_in: &[PathBuf]) -> String {
    let places: Vec<_> = looked_in.iter().map(|path| path.display().to_string()).collect();
    places.join(" and ")
}
