//! The program `rayflock`: renders scenes that never hold still.
//!
//! It is a library so that `python -m rayflock` is the same program; [`run`] is all of it.
//! `args` is what stands on the command line, `plan` what it means, `commands` what is done. Whose
//! fault an error is decides its exit code, see `failure`.
#![forbid(unsafe_code)]

mod allocations;
mod args;
mod commands;
mod convert_plan;
mod failure;
mod false_color;
mod frames;
mod input;
mod interrupt;
mod journal;
mod light_plan;
mod output;
mod plan;
mod plot;
mod profile;
mod progress;
mod session;
mod size;
mod stats;
mod terminal;

use std::ffi::OsString;
use std::io::{self, Write};

use clap::Parser;

/// Does what the words of a command line ask for, the first of which names the program, and returns
/// the exit code. What is to be read goes to standard output, everything else to standard error.
///
/// `count_allocations` tells how often the program has allocated on the heap, where its allocator
/// counts; without it, statistics do not tell.
///
/// Ctrl-C, termination and hang-up are answered from the first command on that can be stopped: in
/// this process, and until it ends.
pub fn run(
    words: impl IntoIterator<Item = OsString>,
    count_allocations: Option<fn() -> u64>,
) -> u8 {
    allocations::count_by(count_allocations);
    let code = match args::Arguments::try_parse_from(words) {
        Ok(arguments) => match commands::run(&arguments.command) {
            Ok(()) => 0,
            Err(failure) => failure.report(),
        },
        Err(error) => {
            // There is nowhere to report to that nobody reads; help is no error.
            let _ = error.print();
            u8::try_from(error.exit_code()).unwrap_or(failure::INPUT)
        }
    };
    // Whoever calls need not end the process as Rust's own main does.
    let _ = io::stdout().flush();
    code
}
