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

    /// Write a report with tables and charts: one HTML file that needs no network.
    #[arg(long, value_name = "FILE")]
    pub(crate) html: Option<PathBuf>,

    /// Write a table with one row a cell and engine.
    #[arg(long, value_name = "FILE")]
    pub(crate) csv: Option<PathBuf>,

    /// Write the ratios as tables of a Markdown document.
    #[arg(long, value_name = "FILE")]
    pub(crate) markdown: Option<PathBuf>,
}

impl OutputArguments {
    /// All files that are asked for.
    pub(crate) fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        [&self.json, &self.html, &self.csv, &self.markdown].into_iter().flatten()
    }
}
