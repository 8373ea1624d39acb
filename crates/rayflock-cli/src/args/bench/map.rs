//! Options of `bench map`.

use std::path::PathBuf;

use clap::Args;
use rayflock_bench::work::{RayKind, parse_count};

use super::{EngineArguments, OutputArguments};
use crate::args::TraceArguments;

const EXAMPLES: &str = "\
What is measured:
  T triangles, all at new places in every frame, in a static room; R rays a frame of one kind. A
  cell is what an engine needs to take in the frame (commit) and to trace the rays. Engines take
  turns, round by round, on the same memory; times are medians, and means of two phases of the
  motion. Answers are compared with Embree's watertight ones, where Embree is there, and rays that
  differ are judged by an independent oracle.

Kinds of rays:
  primary pointshadow dirshadow mirror diffuse     measured when --kind is not given
  orthographic suns lidar ao                       on request

Examples:
  rayflock bench map --quick                       an impression, in less than two minutes
  rayflock bench map --json map.json               the whole map: 100 cells, up to 40 minutes
  rayflock bench map --triangles 1K,64K --rays 1M --kind primary,diffuse
  rayflock bench map --quick --engines brute,hierarchy     without Embree
  rayflock bench map --kind lidar --engines embree:low+kept,embree:best,hierarchy

`cargo xtask embree` fetches Embree. Ctrl-C ends the map; what is measured by then is kept.

Exit codes: 0 done; 1 the output failed; 2 arguments or input are wrong; 130 stopped by Ctrl-C.";

/// Options of `bench map`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct BenchMapArguments {
    /// Moving triangles, separated by commas; K stands for 1024, M for 1024 * 1024 [default: what
    /// the definition lists].
    #[arg(long, value_name = "COUNTS", value_delimiter = ',', value_parser = parse_count)]
    pub(crate) triangles: Vec<usize>,

    /// Rays a frame, likewise.
    #[arg(long, value_name = "COUNTS", value_delimiter = ',', value_parser = parse_count)]
    pub(crate) rays: Vec<usize>,

    /// Kinds of rays, separated by commas [default: what the definition lists].
    #[arg(long, value_name = "KINDS", value_delimiter = ',')]
    pub(crate) kind: Vec<RayKind>,

    /// Measure fewer counts of the built-in definition, and each cell for a shorter time.
    #[arg(long)]
    pub(crate) quick: bool,

    /// The file that defines the work [default: the built-in bench/definitions/map.toml].
    #[arg(long, value_name = "FILE")]
    pub(crate) definition: Option<PathBuf>,

    /// Which engines.
    #[command(flatten)]
    pub(crate) engines: EngineArguments,

    /// Where the record goes.
    #[command(flatten)]
    pub(crate) output: OutputArguments,

    /// Where the profile goes.
    #[command(flatten)]
    pub(crate) trace: TraceArguments,
}
