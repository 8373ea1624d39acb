//! The commands, one a file.

#[cfg(feature = "bench")]
mod bench;
mod convert;
mod demo;
mod devices;
mod info;
mod render;
mod sense;
mod sun;

use anyhow::Context;

use crate::args::Command;
use crate::failure::{Blame, Failure};
use crate::profile;

/// Does what the user asked, on as many threads as the user allows.
pub(crate) fn run(command: &Command) -> Result<(), Failure> {
    let threads = match command {
        Command::Demo(args) => args.threads,
        Command::Render(args) => args.threads,
        Command::Sun(args) => args.threads,
        Command::Sense(args) => args.threads,
        Command::Convert(_) | Command::Info(_) => None,
        #[cfg(feature = "bench")]
        Command::Bench(args) => args.command.threads(),
    };
    let trace = match command {
        Command::Render(args) => args.trace.trace.as_deref(),
        Command::Sun(args) => args.trace.trace.as_deref(),
        Command::Sense(args) => args.trace.trace.as_deref(),
        #[cfg(feature = "bench")]
        Command::Bench(args) => args.command.trace(),
        Command::Demo(_) | Command::Convert(_) | Command::Info(_) => None,
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .thread_name(|idx| format!("worker {idx}"))
        .num_threads(threads.map_or(0, usize::from))
        .build()
        .context("cannot start threads")
        .blame_output()?;
    let work = || match command {
        Command::Demo(args) => demo::run(args),
        Command::Render(args) => render::run(args),
        Command::Convert(args) => convert::run(args),
        Command::Sun(args) => sun::run(args),
        Command::Sense(args) => sense::run(args),
        Command::Info(args) => info::run(args),
        #[cfg(feature = "bench")]
        Command::Bench(args) => bench::run(args),
    };
    profile::record(trace, || pool.install(work)).blame_output()?
}
