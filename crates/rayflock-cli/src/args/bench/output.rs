//! Where a record goes, for every subcommand of `bench` alike.

use std::path::PathBuf;

use clap::Args;

/// Where a record goes besides standard output.
#[derive(Clone, Debug, Default, Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct OutputArguments {
    /// Write everything measured to a JSON file.
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,
}
