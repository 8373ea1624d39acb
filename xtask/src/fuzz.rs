//! `cargo xtask fuzz`: libFuzzer looks for files that make parsers crash, hang or take memory.
//!
//! The targets of `fuzz/` are built with the counters of coverage that libFuzzer goes by, which
//! stable Rust can. What it learns stays in `fuzz/corpus/` of the folder that cargo builds in, so
//! that the next run goes on from there; inputs that fail are put into `fuzz/artifacts/` beside it.
//! `cargo fuzz` works too, with `--sanitizer none` on stable Rust.

use std::fmt;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::thread;
use std::time::Duration;

use anyhow::{Context, Result, bail, ensure};

use crate::tools;

/// How much each target does where nothing is asked for.
const USUAL: Effort = Effort::Seconds(15);

/// How much a target does.
#[derive(Clone, Copy)]
enum Effort {
    Seconds(u64),
    Executions(u64),
}

impl Effort {
    /// libFuzzer's option for it.
    fn option(self) -> String {
        match self {
            Self::Seconds(seconds) => format!("-max_total_time={seconds}"),
            Self::Executions(count) => format!("-runs={count}"),
        }
    }
}

impl fmt::Display for Effort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Seconds(seconds) => write!(f, "{seconds} s"),
            Self::Executions(count) => write!(f, "{count} executions"),
        }
    }
}

/// What makes the compiler count, after the tool cargo-fuzz.
const COUNTERS: [&str; 7] = [
    "--cfg=fuzzing",
    "-Cpasses=sancov-module",
    "-Cllvm-args=-sanitizer-coverage-level=4",
    "-Cllvm-args=-sanitizer-coverage-inline-8bit-counters",
    "-Cllvm-args=-sanitizer-coverage-pc-table",
    "-Cllvm-args=-sanitizer-coverage-trace-compares",
    "-Ccodegen-units=1",
];

/// Limits of one input: seconds, megabytes of the whole program, bytes. The targets themselves
/// look closer at the first two.
const LIMITS: [&str; 3] = ["-timeout=20", "-rss_limit_mb=2048", "-max_len=16384"];

/// `[--minutes N | --executions N] [TARGET]...`
pub(crate) fn run(root: &Path, words: &[&str]) -> Result<()> {
    let (effort, targets) = match words {
        ["--minutes", minutes, targets @ ..] => (Effort::Seconds(seconds_of(minutes)?), targets),
        ["--executions", count, targets @ ..] => {
            let count = count.parse().context("--executions wants a whole number")?;
            (Effort::Executions(count), targets)
        }
        targets => (USUAL, targets),
    };
    let known = targets_in(root)?;
    if let Some(unknown) = targets.iter().find(|target| !known.iter().any(|name| name == *target)) {
        bail!("there is no target \"{unknown}\"; there are {}", known.join(", "));
    }
    let chosen = known.into_iter().filter(|name| targets.is_empty() || targets.contains(&&**name));
    Fuzzing::new(root)?.run(chosen.collect(), effort)
}

/// Whole seconds in `minutes`, one at least.
fn seconds_of(minutes: &str) -> Result<u64> {
    let minutes: f64 = minutes.parse().context("--minutes wants a number")?;
    let duration = Duration::try_from_secs_f64(60.0 * minutes);
    Ok(duration.context("--minutes wants a number of minutes")?.as_secs().max(1))
}

/// The usual run of all targets, where the machine has what it takes.
pub(crate) fn test(root: &Path) -> Result<()> {
    if !cfg!(unix) || !tools::want_cxx() {
        println!("== fuzzing: skipped: libFuzzer wants a C++ compiler on Linux or macOS");
        return Ok(());
    }
    println!("== fuzzing: {USUAL} a target");
    Fuzzing::new(root)?.run(targets_in(root)?, USUAL)
}

/// The names of all targets.
fn targets_in(root: &Path) -> Result<Vec<String>> {
    let files = fs::read_dir(root.join("fuzz/fuzz_targets")).context("cannot list the targets")?;
    let paths = files.filter_map(|entry| Some(entry.ok()?.path()));
    let mut names: Vec<String> =
        paths.filter_map(|path| Some(path.file_stem()?.to_string_lossy().into_owned())).collect();
    names.sort();
    Ok(names)
}

/// Targets that are built, and where their files lie.
struct Fuzzing {
    programs: PathBuf,
    regressions: PathBuf,
    folder: PathBuf,
}

impl Fuzzing {
    /// Builds all targets.
    fn new(root: &Path) -> Result<Self> {
        let folder = tools::target(root).join("fuzz");
        let host = host()?;
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut build = Command::new(cargo);
        // Naming the host keeps the counters out of what runs while building.
        build.args(["build", "--release", "--locked", "--target", &host]);
        build.env("CARGO_ENCODED_RUSTFLAGS", COUNTERS.join("\x1f"));
        build.env("CARGO_TARGET_DIR", &folder).current_dir(root.join("fuzz"));
        let status = build.status().context("cannot run cargo to build the fuzz targets")?;
        ensure!(status.success(), "the fuzz targets cannot be built ({status})");

        let programs = folder.join(host).join("release");
        for name in ["corpus", "artifacts", "logs"] {
            fs::create_dir_all(folder.join(name))
                .with_context(|| format!("cannot create {}", folder.join(name).display()))?;
        }
        Ok(Self { programs, regressions: root.join("testdata/regressions"), folder })
    }

    /// Runs these targets, as many at a time as there are processors, and tells what came of each.
    fn run(&self, targets: Vec<String>, effort: Effort) -> Result<()> {
        let workers = thread::available_parallelism().map_or(1, usize::from).min(targets.len());
        let waiting = Mutex::new(targets.into_iter());
        let next = || waiting.lock().map_or(None, |mut waiting| waiting.next());
        let work = || -> Result<()> {
            while let Some(name) = next() {
                self.run_target(&name, effort)?;
            }
            Ok(())
        };
        let results: Vec<Result<()>> = thread::scope(|scope| {
            let workers: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
            let crashed = || Err(anyhow::anyhow!("a worker of the automation crashed"));
            workers.into_iter().map(|worker| worker.join().unwrap_or_else(|_| crashed())).collect()
        });
        results.into_iter().collect()
    }

    fn run_target(&self, name: &str, effort: Effort) -> Result<()> {
        let log = self.folder.join("logs").join(format!("{name}.log"));
        let output = File::create(&log).context("cannot write the log of a fuzz target")?;
        let artifacts = self.folder.join("artifacts").join(format!("{name}-"));
        let mut fuzz = Command::new(self.programs.join(name));
        let corpus = self.folder.join("corpus").join(name);
        fuzz.arg(&corpus).env("RAYFLOCK_SEEDS", &corpus);
        let known = self.regressions.join(name);
        if known.is_dir() {
            fuzz.arg(known);
        }
        fuzz.args(LIMITS).arg("-print_final_stats=1");
        fuzz.arg(effort.option());
        fuzz.arg(format!("-artifact_prefix={}", artifacts.display()));
        let status = fuzz.stderr(output).status().with_context(|| format!("cannot run {name}"))?;
        let words = fs::read(&log).context("cannot read the log of a fuzz target")?;
        let words = String::from_utf8_lossy(&words);
        if !status.success() {
            let lines: Vec<&str> = words.lines().collect();
            let end = lines[lines.len().saturating_sub(40)..].join("\n");
            bail!("fuzz target {name} failed ({status}):\n{end}\nthe whole log: {}", log.display());
        }
        let executions = words.lines().rev().find_map(|line| {
            Some(line.strip_prefix("stat::number_of_executed_units:")?.trim().to_owned())
        });
        println!("{name:>8}: {} executions", executions.unwrap_or_default());
        Ok(())
    }
}

/// The platform that the compiler runs on.
fn host() -> Result<String> {
    let version = Command::new("rustc").arg("-vV").output().context("cannot run rustc")?;
    let words = String::from_utf8_lossy(&version.stdout);
    let host = words.lines().find_map(|line| line.strip_prefix("host: "));
    Ok(host.context("rustc does not say its host")?.to_owned())
}
