//! `cargo xtask perf-check`: instructions of kernels and engines, compared with the committed
//! baseline.
//!
//! Times differ from run to run and from machine to machine; the number of instructions does not.
//! It says nothing about caches and branches, so it does not tell how fast something is, but it
//! tells at once when something became slower by doing more.
//!
//! The cases are those of `crates/rayflock-bench/benches/instructions`. Each runs in a process of
//! its own under callgrind, which collects within one function only. Counts belong to an
//! instruction set and a compiler: there is a baseline for each SIMD level, and it names its
//! compiler. Callgrind hides from the program what it cannot emulate (valgrind 3.19: AVX-512), so
//! on a machine with AVX-512 the level counted may be `avx2`.
//!
//! Not part of `cargo xtask test`: the optimised build takes minutes where it is not there yet, and
//! valgrind is not everywhere.

mod baseline;
mod compare;
mod measure;

use std::path::Path;
use std::time::Instant;

use anyhow::{Context, Result, bail, ensure};

use crate::tools;
use baseline::Baseline;
use compare::Verdict;

/// What is done with the counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mode {
    /// Compare them with the baseline.
    Compare,
    /// Make them the baseline.
    Update,
}

/// Counts, then compares or updates; an error when a count grew too much, or there is nothing to
/// compare with.
pub(crate) fn run(root: &Path, mode: Mode) -> Result<()> {
    let start = Instant::now();
    tools::need_valgrind()?;
    let counted = measure::all(root)?;
    let Some(first) = counted.first() else { bail!("there are no cases") };
    let now = Baseline::new(root, &first.simd, &counted)?;
    let path = baseline::path(root, &first.simd);
    let before = Baseline::read(&path)?;

    let lines = compare::compare(before.as_ref(), &counted);
    print!("{}", compare::table(&lines));
    if let Some(before) = before.as_ref().filter(|before| before.rustc != now.rustc) {
        println!(
            "note: the baseline was counted with {}, this is {}; what differs may be the compiler's",
            before.rustc, now.rustc
        );
    }
    println!("== level {}, {} s", first.simd, start.elapsed().as_secs());
    if mode == Mode::Update {
        now.write(&path)?;
        println!("== wrote {}", path.display());
        return Ok(());
    }
    ensure!(
        before.is_some(),
        "there is no baseline for level {}: \"cargo xtask perf-check --update\" writes {}",
        first.simd,
        path.display()
    );
    let failed: Vec<_> = lines.iter().filter(|line| line.verdict.is_failure()).collect();
    if failed.is_empty() {
        return Ok(());
    }
    let names: Vec<_> = failed.iter().map(|line| line.name.as_str()).collect();
    Err(anyhow::anyhow!("{}", names.join(", "))).context(Verdict::ADVICE)
}
