//! Cases whose instructions `cargo xtask perf-check` counts under callgrind.
//!
//! A case makes its scene and rays from seeds, runs once so that every buffer has its size, then
//! runs once more inside [`measured_part`], the only function whose instructions are collected. One
//! thread does everything. Times are not taken here: under callgrind they mean nothing.
//!
//! `instructions --list` tells the cases, `instructions CASE` runs one and says on which SIMD level
//! and how many items of work it did. Callgrind hides what it cannot emulate (3.19: AVX-512) from
//! the program, so the level in use there may be lower than the machine's.
#![forbid(unsafe_code)]
#![expect(clippy::unwrap_used, reason = "the cases are fixed; one that cannot be made is a bug")]

mod engines;
mod kernels;

use std::hint::black_box;
use std::process::ExitCode;

use rayflock::geom::simd::SimdLevel;

/// A piece of work whose instructions are counted.
struct Case {
    name: &'static str,
    /// One item of the work.
    item: &'static str,
    /// Does the work; returns the number of items.
    run: fn() -> usize,
}

/// Runs `work`; the name of this function is what callgrind looks for.
#[inline(never)]
fn measured_part<R>(work: impl FnOnce() -> R) -> R {
    black_box(work())
}

fn main() -> ExitCode {
    // cargo bench adds --bench.
    let arguments: Vec<_> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    let cases: Vec<&Case> = kernels::CASES.iter().chain(&engines::CASES).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["--list"] => cases.iter().for_each(|case| println!("{}", case.name)),
        [name] => match cases.iter().find(|case| case.name == name) {
            Some(case) => run(case),
            None => {
                eprintln!("unknown case \"{name}\"");
                return ExitCode::from(2);
            }
        },
        _ => {
            eprintln!("counts are made by: cargo xtask perf-check");
            cases.iter().for_each(|case| run(case));
        }
    }
    ExitCode::SUCCESS
}

/// Runs a case on this thread alone and says what it was: level, items, what an item is.
fn run(case: &Case) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().unwrap();
    let item_count = pool.install(case.run);
    println!("{}\t{item_count}\t{}", SimdLevel::best(), case.item);
}
