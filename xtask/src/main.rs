//! The project's automation: `cargo xtask test` and others.
//!
//! | Part | What it does |
//! |---|---|
//! | [`mod@test`] | runs every check in order; what CI runs |
//! | [`embree`] | fetches the library that benchmarks compare with |
//! | [`invariants`] | checks the rules of `docs/architecture.md` that the compiler does not |
//! | [`tools`] | finds or installs programs that some tests want |
#![forbid(unsafe_code)]

mod embree;
mod invariants;
mod test;
mod tools;

use std::path::Path;
use std::process::ExitCode;

const USAGE: &str = "\
usage: cargo xtask COMMAND

commands:
  embree  fetch the library Embree, which benchmarks and some tests want
  test    format, lints, all tests, documentation and the invariants: what CI runs";

fn main() -> ExitCode {
    let command = std::env::args().nth(1);
    let done = match command.as_deref() {
        Some("embree") => embree::run(root()),
        Some("test") => test::run(root()),
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// The root of the repository.
fn root() -> &'static Path {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here)
}
