//! Options of `bench scaling`.

use clap::Args;
use rayflock_bench::work::{RayKind, parse_count};

use super::{EngineArguments, OutputArguments};
use crate::args::TraceArguments;

const EXAMPLES: &str = "\
What is measured:
  The work of `bench map`, with one count varied at a time: triangles (--triangles, under
  --fixed-rays), rays (--rays, over --fixed-triangles), and threads from 1 to --threads, doubled
  each time. A slope is the exponent by which a cost grows: 1 in proportion to the count, 0 not at
  all; -1 for threads that all help.

Examples:
  rayflock bench scaling --quick
  rayflock bench scaling --kind primary,diffuse --json scaling.json
  rayflock bench scaling --engines hierarchy --triangles 1K,4K,16K,64K,256K,1M --fixed-rays 64K

Exit codes: 0 done; 1 the output failed; 2 arguments or input are wrong; 130 stopped by Ctrl-C.";

/// Options of `bench scaling`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct BenchScalingArguments {
    /// Moving triangles, separated by commas; K stands for 1024, M for 1024 * 1024.
    #[arg(long, value_name = "COUNTS", value_delimiter = ',', value_parser = parse_count,
          default_value = "1K,4K,16K,64K,256K")]
    pub(crate) triangles: Vec<usize>,

    /// Rays a frame, likewise.
    #[arg(long, value_name = "COUNTS", value_delimiter = ',', value_parser = parse_count,
          default_value = "4K,16K,64K,256K,1M")]
    pub(crate) rays: Vec<usize>,

    /// Triangles while rays or threads vary.
    #[arg(long, value_name = "COUNT", value_parser = parse_count, default_value = "64K")]
    pub(crate) fixed_triangles: usize,

    /// Rays while triangles or threads vary.
    #[arg(long, value_name = "COUNT", value_parser = parse_count, default_value = "64K")]
    pub(crate) fixed_rays: usize,

    /// Kinds of rays, separated by commas.
    #[arg(
        long,
        value_name = "KINDS",
        value_delimiter = ',',
        default_value = "primary,dirshadow,diffuse"
    )]
    pub(crate) kind: Vec<RayKind>,

    /// Measure each cell for a shorter time.
    #[arg(long)]
    pub(crate) quick: bool,

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
