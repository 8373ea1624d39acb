//! Options of `bench`, one subcommand a file.

mod museum;
mod output;

use clap::{Args, Subcommand};

pub(crate) use museum::BenchMuseumArguments;
pub(crate) use output::OutputArguments;

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
    /// Measure update, trace and shade time of the pictures of an animation with each engine.
    Museum(BenchMuseumArguments),
}

impl BenchCommand {
    /// Threads the user allows.
    pub(crate) fn threads(&self) -> Option<u16> {
        match self {
            Self::Museum(args) => args.threads,
        }
    }
}
