//! `rayflock bench`, one subcommand a file.

mod compare;
mod engines;
mod map;
mod moving_input;
mod museum;
mod output;
mod scaling;
mod scene;
mod spheres;
mod watcher;

use crate::args::{BenchArguments, BenchCommand};
use crate::failure::Failure;

/// Measures what the user asked for.
pub(super) fn run(args: &BenchArguments) -> Result<(), Failure> {
    match &args.command {
        BenchCommand::Map(args) => map::run(args),
        BenchCommand::Scene(args) => scene::run(args),
        BenchCommand::Scaling(args) => scaling::run(args),
        BenchCommand::Museum(args) => museum::run(args),
        BenchCommand::Spheres(args) => spheres::run(args),
        BenchCommand::Compare(args) => compare::compare(args),
        BenchCommand::Report(args) => compare::report(args),
    }
}
