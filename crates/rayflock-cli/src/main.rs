//! The program `rayflock`: renders scenes that never hold still.
//!
//! [`args`] is what stands on the command line, [`plan`] what it means, [`commands`] what is
//! done. Whose fault an error is decides its exit code, see [`failure`].
#![forbid(unsafe_code)]

mod allocations;
mod args;
mod commands;
mod convert_plan;
mod failure;
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

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    let arguments = args::Arguments::parse();
    match commands::run(&arguments.command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
