//! `rayflock bench`, one subcommand a file.

mod museum;
mod output;

use crate::args::{BenchArguments, BenchCommand};
use crate::failure::Failure;

/// Measures what the user asked for.
pub(super) fn run(args: &BenchArguments) -> Result<(), Failure> {
    match &args.command {
        BenchCommand::Museum(args) => museum::run(args),
    }
}
