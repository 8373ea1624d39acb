//! Options of `bench`, one subcommand a file.

mod compare;
mod engines;
mod map;
mod museum;
mod output;
mod scaling;
mod scene;
mod spheres;

use std::path::Path;

use clap::{Args, Subcommand};

pub(crate) use compare::{BenchCompareArguments, BenchReportArguments};
pub(crate) use engines::EngineArguments;
pub(crate) use map::BenchMapArguments;
pub(crate) use museum::BenchMuseumArguments;
pub(crate) use output::OutputArguments;
pub(crate) use scaling::BenchScalingArguments;
pub(crate) use scene::BenchSceneArguments;
pub(crate) use spheres::BenchSpheresArguments;

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
    /// Measure moving triangles x rays x kinds of rays with each engine.
    Map(BenchMapArguments),
    /// Measure rays of each kind over the frames of an animation with each engine.
    Scene(BenchSceneArguments),
    /// Measure how cost grows with triangles, rays and threads.
    Scaling(BenchScalingArguments),
    /// Measure update, trace and shade time of the pictures of an animation with each engine.
    Museum(BenchMuseumArguments),
    /// Measure what spheres in place of geometry save in indirect light, and how wrong they are.
    Spheres(BenchSpheresArguments),
    /// Tell what has changed between two records.
    Compare(BenchCompareArguments),
    /// Make a page, tables or a spreadsheet of a record.
    Report(BenchReportArguments),
}

impl BenchCommand {
    /// Threads the user allows.
    pub(crate) fn threads(&self) -> Option<u16> {
        match self {
            Self::Map(args) => args.engines.threads,
            Self::Scene(args) => args.engines.threads,
            Self::Scaling(args) => args.engines.threads,
            Self::Museum(args) => args.engines.threads,
            Self::Spheres(args) => args.engines.threads,
            Self::Compare(_) | Self::Report(_) => None,
        }
    }

    /// Where the user wants a profile.
    pub(crate) fn trace(&self) -> Option<&Path> {
        match self {
            Self::Map(args) => args.trace.trace.as_deref(),
            Self::Scene(args) => args.trace.trace.as_deref(),
            Self::Scaling(args) => args.trace.trace.as_deref(),
            Self::Museum(args) => args.trace.trace.as_deref(),
            Self::Spheres(args) => args.trace.trace.as_deref(),
            Self::Compare(_) | Self::Report(_) => None,
        }
    }
}
