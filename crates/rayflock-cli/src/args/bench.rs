//! Options of `bench`, one subcommand a file.

mod museum;

use clap::{Args, Subcommand};

pub(crate) use museum::BenchSceneArguments;

/// Options of `bench`.
#[derive(Debug, Args)]
pub(crate) struct BenchArguments {
    /// What to measure.
    #[command(subcommand)]
    pub(crate) command: BenchCommand,
}

/// What can be measured.
#[derive(Debug, Subcommand)]
pub(crate) enum BenchCommand {
    /// Measure what the frames of an animation cost with each engine.
    Scene(BenchSceneArguments),
}

impl BenchCommand {
    /// Threads the user allows.
    pub(crate) fn threads(&self) -> Option<u16> {
        match self {
            Self::Scene(args) => args.threads,
        }
    }
}
