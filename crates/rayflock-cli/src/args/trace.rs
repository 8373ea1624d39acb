//! The option `--trace`, for every command that has it alike.

use std::path::PathBuf;

use clap::Args;

/// Whether to write down what the program does when.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct TraceArguments {
    /// Write what each thread did when, stage by stage, to a JSON file for ui.perfetto.dev or
    /// chrome://tracing.
    ///
    /// Stages have the names of the source code: commit, write_triangles, build_tree, refine,
    /// shade_surface and so on. Writing them down takes some microseconds a stage.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) trace: Option<PathBuf>,
}
