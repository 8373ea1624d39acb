//! What was measured, as it is kept.
//!
//! In JSON one object; fields are added later, never renamed. Times are wall-clock milliseconds.
//! What a benchmark does not measure is `null` or left out.

mod machine;
mod read;

use std::collections::BTreeMap;

use rayflock::engine::TraceStats;
use serde::{Deserialize, Serialize};

pub use machine::Machine;

/// The commit this was built from.
const COMMIT: &str = git_version::git_version!(
    args = ["--always", "--abbrev=12", "--dirty=-dirty", "--exclude=*"],
    fallback = "unknown"
);

/// Everything measured in one run of a benchmark.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Which benchmark: `map`, `scene`, `museum`, `scaling`, `spheres`.
    pub benchmark: String,
    /// What it ran on.
    pub machine: Machine,
    /// The commit that was measured, with `-dirty` where files differed from it; `unknown` where
    /// the program was not built from a repository.
    pub commit: String,
    /// When the run began, RFC 3339, UTC.
    pub date: String,
    /// Versions of what took part, by name: `rayflock`, `embree`, ...
    pub versions: BTreeMap<String, String>,
    /// The workload: the text of the definition file, where there is one.
    pub definition: Option<String>,
    /// One entry a cell of the map (or a scene and kind of rays) and engine.
    pub cells: Vec<Cell>,
}

/// What one engine needed for one piece of work; means over its phases.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Moving triangles in the map, all primitives in a scene (the most in any phase).
    pub triangles: usize,
    /// Rays a frame (the mean where phases differ).
    pub rays: u64,
    /// The kind of the rays: `primary`, `pointshadow`, ...; `picture` for all rays of a picture.
    pub kind: String,
    /// The scene: `map`, a file or `builtin:NAME`.
    pub scene: String,
    /// The engine as it was asked for: `hierarchy`, `embree:best`.
    pub engine: String,
    /// The setting it ran with, where it has any: `low+instances+packets+coherent`.
    pub setting: String,
    /// Threads worked with.
    pub threads: usize,
    /// Making a frame's geometry the current one; mean over the phases of their medians.
    pub commit_ms: Option<f64>,
    /// Tracing a frame's rays; mean over the phases of their medians.
    pub trace_ms: Option<f64>,
    /// Both together; mean over the phases of the medians of the sums.
    pub total_ms: Option<f64>,
    /// Distance of the outer quartiles of the total, as a share of its median; the largest of the
    /// phases.
    pub spread: f64,
    /// Whether the spread is above the stated limit, so that the figures say little.
    pub noisy: bool,
    /// Rays answered otherwise than by the reference, beyond the stated tolerance; for pictures,
    /// pixels that differ in any bit.
    pub mismatches: u64,
    /// How the oracle judged them.
    pub judged: Judged,
    /// Why nothing was measured, where the work would have taken too long:
    /// `over 4000 ms a frame after 1/16 of the rays`.
    pub skipped: Option<String>,
    /// What the engine counted, mean over the phases.
    pub counters: Counters,
    /// Bytes held by the engine, the most in any phase.
    pub memory_bytes: usize,
    /// What only this engine tells about what it holds, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub facts: BTreeMap<String, f64>,
    /// One entry a phase (a frame, in a scene).
    pub phases: Vec<Phase>,
}

/// What one engine needed for one phase. Times are medians over the rounds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Phase {
    /// The name of the phase (`cloud`), or `frame 150`.
    pub name: String,
    /// The frame, where phases are frames of an animation.
    pub frame: Option<u32>,
    /// Rounds measured.
    pub rounds: usize,
    /// Primitives in the frame.
    pub triangles: usize,
    /// Rays.
    pub rays: u64,
    /// Rays by kind, where they are a picture's.
    pub rays_by_kind: Option<RaysByKind>,
    /// Making the geometry the current one.
    pub commit_ms: f64,
    /// Tracing the rays.
    pub trace_ms: f64,
    /// Both together: the median of the sums.
    pub total_ms: f64,
    /// The lower and the upper quartile of both together.
    pub total_quartiles_ms: [f64; 2],
    /// Everything else that makes a picture of it, where there is one.
    pub shade_ms: Option<f64>,
    /// As in [`Cell`].
    pub mismatches: u64,
    /// What the engine counted.
    pub counters: Counters,
}

/// What became of the rays that two engines answered differently. The oracle decides in
/// arithmetic of its own which answers are right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Judged {
    /// Mismatches shown to the oracle; the first ones, where there are very many.
    pub rays: u64,
    /// Both answers are right: an edge, a tie, or a difference within the error of the inputs.
    pub both_right: u64,
    /// Only this engine is right.
    pub only_this: u64,
    /// Only the reference is right.
    pub only_reference: u64,
    /// Neither is.
    pub neither: u64,
}

/// What an engine counted; 0 where it counts nothing, as a foreign library.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Sphere-cone tests, in SIMD lanes.
    pub cone_tests: u64,
    /// Box tests, in SIMD lanes.
    pub box_tests: u64,
    /// Ray-triangle tests, in SIMD lanes.
    pub triangle_tests: u64,
    /// Tiles of subfields visited.
    #[serde(default)]
    pub tiles: u64,
    /// Candidate pairs written.
    pub pairs: u64,
    /// Bytes read and written by tests and stages.
    pub bytes: u64,
    /// Allocations on the heap in a frame of the steady state, where they were counted.
    pub allocations: Option<u64>,
}

/// Rays of a frame by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RaysByKind {
    /// From the camera.
    pub primary: u64,
    /// Between surfaces and lights.
    pub shadow: u64,
    /// Mirrored.
    pub mirror: u64,
    /// Refracted.
    pub refraction: u64,
}

impl Record {
    /// A record of this machine, now, with no cells yet.
    pub fn new(benchmark: &str) -> Self {
        let rayflock = ("rayflock".to_owned(), env!("CARGO_PKG_VERSION").to_owned());
        Self {
            benchmark: benchmark.to_owned(),
            machine: Machine::here(),
            commit: COMMIT.to_owned(),
            date: jiff::Timestamp::now().strftime("%Y-%m-%dT%H:%M:%SZ").to_string(),
            versions: BTreeMap::from([rayflock]),
            definition: None,
            cells: Vec::new(),
        }
    }
}

impl Cell {
    /// Mean over the frames of what is neither update nor trace, where pictures were made.
    pub fn shade_ms(&self) -> Option<f64> {
        let times: Option<Vec<f64>> = self.phases.iter().map(|phase| phase.shade_ms).collect();
        let times = times.filter(|times| !times.is_empty())?;
        Some(times.iter().sum::<f64>() / times.len() as f64)
    }

    /// How unevenly the frames' updates last: their standard deviation as a share of their mean.
    pub fn update_variation(&self) -> Option<f64> {
        let count = self.phases.len() as f64;
        let mean = self.phases.iter().map(|phase| phase.commit_ms).sum::<f64>() / count;
        let squares = self.phases.iter().map(|phase| (phase.commit_ms - mean).powi(2));
        Some((squares.sum::<f64>() / count).sqrt() / mean).filter(|variation| variation.is_finite())
    }

    /// The update as a share of the whole picture's time, means over the frames.
    pub fn update_share(&self) -> Option<f64> {
        Some(self.commit_ms? / (self.total_ms? + self.shade_ms()?))
            .filter(|share| share.is_finite())
    }

    /// Pictures a second: update, trace and shade one after the other.
    pub fn frames_per_second(&self) -> Option<f64> {
        Some(1e3 / (self.total_ms? + self.shade_ms()?)).filter(|rate| rate.is_finite())
    }
}

impl From<&TraceStats> for Counters {
    fn from(stats: &TraceStats) -> Self {
        Self {
            cone_tests: stats.cone_tests,
            box_tests: stats.box_tests,
            triangle_tests: stats.triangle_tests,
            tiles: stats.tiles,
            pairs: stats.pairs,
            bytes: stats.bytes,
            allocations: None,
        }
    }
}
