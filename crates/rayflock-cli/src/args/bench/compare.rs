//! Options of `bench compare` and `bench report`, which measure nothing.

use std::path::PathBuf;

use clap::Args;

use super::OutputArguments;

const COMPARE_HELP: &str = "\
How to read it:
  Change is the new total divided by the old: below 1 the new record is faster. A star marks changes
  that the spreads of both do not explain. Times of two machines, or of work that is defined
  otherwise, say little; the ratio to Embree within each record is then the fair comparison, so it
  is told for each cell, old and new. A ratio is Embree's total divided by ours: above 1 ours is
  ahead.

Exit codes: 0 done, whatever has changed; 2 a file is no record.";

/// Options of `bench compare`.
#[derive(Debug, Args)]
#[command(after_help = COMPARE_HELP)]
pub(crate) struct BenchCompareArguments {
    /// The record to compare with, as written by --json.
    #[arg(value_name = "OLD")]
    pub(crate) old: PathBuf,

    /// The record to compare.
    #[arg(value_name = "NEW")]
    pub(crate) new: PathBuf,
}

/// Options of `bench report`.
#[derive(Debug, Args)]
pub(crate) struct BenchReportArguments {
    /// A record, as written by --json.
    #[arg(value_name = "RECORD")]
    pub(crate) record: PathBuf,

    /// Where the record goes.
    #[command(flatten)]
    pub(crate) output: OutputArguments,
}
