//! `cargo xtask test`: every check, cheapest first; the first that fails ends the run.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result, ensure};

use crate::{convert_tools, fuzz, invariants, tools, vulkan};

/// A call of cargo and what it is for. Lints and documentation share their builds of the
/// dependencies; tests need another one, because they are optimised.
struct Step {
    name: &'static str,
    args: &'static [&'static str],
    env: Option<(&'static str, &'static str)>,
}

const STEPS: [Step; 6] = [
    Step { name: "format", args: &["fmt", "--all", "--check"], env: None },
    Step {
        name: "lints",
        args: &["clippy", "--workspace", "--all-targets", GPU, "--", "-D", "warnings"],
        env: None,
    },
    Step {
        name: "lints without the graphics card",
        args: &["clippy", "--workspace", "--", "-D", "warnings"],
        env: None,
    },
    Step {
        name: "lints of the wheel, without benchmarks",
        args: &["clippy", "-p", "rayflock-python", "--", "-D", "warnings"],
        env: None,
    },
    Step { name: "tests", args: &["test", "--workspace", GPU], env: None },
    Step {
        name: "documentation",
        args: &["doc", "--workspace", "--no-deps", GPU],
        env: Some(("RUSTDOCFLAGS", "-D warnings")),
    },
];

/// The program with all it can do.
const GPU: &str = "--features=rayflock-cli/gpu";

/// Runs everything from the repository's `root`.
pub(crate) fn run(root: &Path) -> Result<()> {
    let start = Instant::now();
    tools::want_ffmpeg();
    tools::want_embree(root);
    tools::want_python(root);
    let drivers = vulkan::want_drivers();
    say_where_real_scenes_are(root);
    println!("== invariants");
    invariants::check(root)?;
    for step in &STEPS {
        run_step(root, step, &drivers)?;
    }
    convert_tools::test(root)?;
    fuzz::test(root)?;
    println!("== all checks passed in {} s", start.elapsed().as_secs());
    Ok(())
}

/// Says whether the tests on real scenes run; each that does not says so too, but cargo shows
/// that only of tests that fail.
fn say_where_real_scenes_are(root: &Path) {
    let beside = root.join("../shared/data");
    let folder = std::env::var_os("RAYFLOCK_DATA").map_or(beside, PathBuf::from);
    if folder.is_dir() {
        println!("== real scenes: {}", folder.display());
    } else {
        println!(
            "== real scenes: {} is not there, tests on them are skipped; RAYFLOCK_DATA says where \
             they are",
            folder.display()
        );
    }
}

fn run_step(root: &Path, step: &Step, drivers: &[(&str, String)]) -> Result<()> {
    let env = step.env.map_or_else(String::new, |(name, value)| format!("{name}=\"{value}\" "));
    println!("== {}: {env}cargo {}", step.name, step.args.join(" "));
    let start = Instant::now();
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(step.args).envs(step.env).current_dir(root);
    command.envs(drivers.iter().map(|(name, value)| (*name, value)));
    let status = command.status().with_context(|| format!("cannot run cargo for {}", step.name))?;
    ensure!(status.success(), "{} failed ({status})", step.name);
    println!("== {}: passed in {} s", step.name, start.elapsed().as_secs());
    Ok(())
}
