//! Runs the cases under callgrind.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};

use crate::tools::target;

/// The one function whose instructions are collected, what it calls included.
const COLLECTED: &str = "*measured_part*";

/// What one case took.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Counted {
    /// The case.
    pub(super) name: String,
    /// The SIMD level it ran on.
    pub(super) simd: String,
    /// Instructions.
    pub(super) instructions: u64,
    /// Items of work done.
    pub(super) item_count: u64,
    /// What an item is.
    pub(super) item: String,
}

/// Builds the cases and counts each of them.
pub(super) fn all(root: &Path) -> Result<Vec<Counted>> {
    println!("== build: cargo bench --package rayflock-bench --bench instructions --no-run");
    let list = output(&mut cases(root, &[], &["--list"])).context("cannot build the cases")?;
    let folder = target(root).join("perf-check");
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    println!("== count: profiles for callgrind_annotate go to {}", folder.display());
    list.lines().map(|name| count(root, &folder, name)).collect()
}

fn count(root: &Path, folder: &Path, name: &str) -> Result<Counted> {
    let profile = folder.join(format!("{name}.callgrind"));
    let runner = [
        "valgrind",
        "--quiet",
        "--tool=callgrind",
        "--collect-atstart=no",
        &format!("--toggle-collect={COLLECTED}"),
        &format!("--callgrind-out-file={}", profile.display()),
    ];
    let said = output(&mut cases(root, &runner, &[name])).with_context(|| name.to_owned())?;
    let read = || format!("cannot read {}", profile.display());
    let text = fs::read_to_string(&profile).with_context(read)?;
    let instructions = total(&text).with_context(read)?;
    ensure!(instructions > 0, "{name}: callgrind found no function {COLLECTED}");
    parse_case(name, instructions, &said)
}

/// A call of cargo that runs the cases' program through `runner` with `args`.
fn cases(root: &Path, runner: &[&str], args: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    if !runner.is_empty() {
        let runner: Vec<_> = runner.iter().map(|word| format!("{word:?}")).collect();
        command.arg("--config");
        command.arg(format!("target.'cfg(all())'.runner = [{}]", runner.join(", ")));
    }
    command.args(["bench", "--quiet", "--package", "rayflock-bench", "--bench", "instructions"]);
    command.arg("--").args(args).current_dir(root).stdin(Stdio::null()).stderr(Stdio::inherit());
    command
}

/// What a command prints; its errors go to the user.
fn output(command: &mut Command) -> Result<String> {
    let output = command.output().context("cannot run cargo")?;
    ensure!(output.status.success(), "the program of the cases failed ({})", output.status);
    String::from_utf8(output.stdout).context("the program of the cases prints UTF-8")
}

/// The total of a callgrind profile; 0 where nothing was collected.
fn total(profile: &str) -> Result<u64> {
    let line = profile.lines().find_map(|line| line.strip_prefix("totals:"));
    let line = line.context("it has no totals")?.trim();
    if line.is_empty() { Ok(0) } else { line.parse().context("its totals are one number") }
}

/// Reads what a case says of itself: `level TAB items TAB what an item is`.
fn parse_case(name: &str, instructions: u64, said: &str) -> Result<Counted> {
    let mut fields = said.trim_end().split('\t');
    let (Some(simd), Some(items), Some(item), None) =
        (fields.next(), fields.next(), fields.next(), fields.next())
    else {
        anyhow::bail!("{name}: expected level, items and what they are, found {said:?}");
    };
    Ok(Counted {
        name: name.to_owned(),
        simd: simd.to_owned(),
        instructions,
        item_count: items.parse().with_context(|| format!("{name}: {items:?} is no number"))?,
        item: item.to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_total_of_a_profile_is_found() {
        assert_eq!(total("events: Ir\nfn=(1)\n3 20\ntotals: 1234\n").unwrap(), 1234);
        assert_eq!(total("events: Ir\ntotals: \n").unwrap(), 0);
        assert!(total("events: Ir\n").is_err());
        assert!(total("totals: 1 2\n").is_err());
    }

    #[test]
    fn a_case_says_level_items_and_what_they_are() {
        let counted = parse_case("x", 9, "avx2\t4096\trays\n").unwrap();
        assert_eq!((counted.simd.as_str(), counted.item_count), ("avx2", 4096));
        for said in ["", "avx2\t4096\n", "avx2\tmany\trays\n", "avx2\t1\trays\tmore\n"] {
            assert!(parse_case("x", 9, said).is_err(), "{said:?}");
        }
    }
}
