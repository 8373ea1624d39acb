//! The project's automation: `cargo xtask test` and others.
//!
//! | Part | What it does |
//! |---|---|
//! | [`mod@test`] | runs every check in order; what CI runs |
//! | [`embree`] | fetches the library that benchmarks compare with |
//! | [`python`] | makes the Python with which the package is tested |
//! | [`fuzz`] | looks for files that break the parsers |
//! | [`perf_check`] | counts instructions and compares them with the committed baseline |
//! | [`invariants`] | checks the rules of `docs/architecture.md` that the compiler does not |
//! | [`convert_tools`] | tests the converter of USD and Alembic files |
//! | [`venv`] | virtual environments of Python |
//! | [`tools`] | finds or installs programs that some tests want |
//! | [`vulkan`] | finds or installs software drivers that stand in for a graphics card |
#![forbid(unsafe_code)]

mod convert_tools;
mod embree;
mod fuzz;
mod invariants;
mod perf_check;
mod python;
mod test;
mod tools;
mod venv;
mod vulkan;

use std::path::Path;
use std::process::ExitCode;

use perf_check::Mode;

const USAGE: &str = "\
usage: cargo xtask COMMAND

commands:
  embree  fetch the library Embree, which benchmarks and some tests want
  python  make the Python with which the package rayflock is tested
  fuzz [--minutes N | --executions N] [TARGET]...
          have libFuzzer look for files that break the parsers: a quarter of a minute each, for N, or
          with so many files
  test    format, lints, all tests, documentation and the invariants: what CI runs
  perf-check [--update]
          count the instructions of kernels and engines under valgrind; fails when one grew by more
          than 3 % over bench/baseline/, which --update writes anew";

fn main() -> ExitCode {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let done = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["embree"] => embree::run(root()),
        ["python"] => python::run(root()),
        ["fuzz", ref words @ ..] => fuzz::run(root(), words),
        ["perf-check"] => perf_check::run(root(), Mode::Compare),
        ["perf-check", "--update"] => perf_check::run(root(), Mode::Update),
        ["test"] => test::run(root()),
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
