//! The commands, one a file.

mod bench;
mod demo;
mod info;
mod render;

use anyhow::Context;

use crate::args::Command;
use crate::failure::{Blame, Failure};

/// Does what the user asked, on as many threads as the user allows.
pub(crate) fn run(command: &Command) -> Result<(), Failure> {
    let threads = match command {
        Command::Demo(args) => args.threads,
        Command::Render(args) => args.threads,
        Command::Info(_) => None,
        Command::Bench(args) => args.command.threads(),
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.map_or(0, usize::from))
        .build()
        .context("cannot start threads")
        .blame_output()?;
    pool.install(|| match command {
        Command::Demo(args) => demo::run(args),
        Command::Render(args) => render::run(args),
        Command::Info(args) => info::run(args),
        Command::Bench(args) => bench::run(args),
    })
}
