//! The committed counts: `bench/baseline/<architecture>-<level>.toml`.

use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize};

use super::measure::Counted;

/// What stands at the head of the file.
const HEAD: &str = "# Instructions of each case; written by: cargo xtask perf-check --update\n\n";

/// Counts, and what they were made with.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Baseline {
    /// The SIMD level.
    pub(super) simd: String,
    /// The compiler.
    pub(super) rustc: String,
    /// Instructions of each case.
    pub(super) instructions: BTreeMap<String, u64>,
}

/// Where the baseline of a SIMD level is.
pub(super) fn path(root: &Path, simd: &str) -> PathBuf {
    root.join(format!("bench/baseline/{}-{simd}.toml", std::env::consts::ARCH))
}

impl Baseline {
    /// What was counted just now, by the compiler in use in `root`.
    pub(super) fn new(root: &Path, simd: &str, counted: &[Counted]) -> Result<Self> {
        let rustc = Command::new("rustc").arg("--version").current_dir(root).output();
        let rustc = rustc.context("cannot run rustc")?;
        ensure!(rustc.status.success(), "rustc --version failed ({})", rustc.status);
        let counts = counted.iter().map(|case| (case.name.clone(), case.instructions));
        Ok(Self {
            simd: simd.to_owned(),
            rustc: String::from_utf8_lossy(&rustc.stdout).trim().to_owned(),
            instructions: counts.collect(),
        })
    }

    /// The baseline in a file; `None` when there is no file.
    pub(super) fn read(path: &Path) -> Result<Option<Self>> {
        match fs::read_to_string(path) {
            Ok(text) => {
                let baseline = toml::from_str(&text);
                Ok(Some(baseline.with_context(|| format!("cannot read {}", path.display()))?))
            }
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error).with_context(|| format!("cannot read {}", path.display())),
        }
    }

    /// Writes the file, and its folder where it is missing.
    pub(super) fn write(&self, path: &Path) -> Result<()> {
        let write = || {
            fs::create_dir_all(path.parent().unwrap_or(path))?;
            fs::write(path, HEAD.to_owned() + &toml::to_string(self)?)?;
            Ok::<_, anyhow::Error>(())
        };
        write().with_context(|| format!("cannot write {}", path.display()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        let folder = std::env::temp_dir().join(format!("rayflock-xtask-{}", std::process::id()));
        let path = folder.join("baseline/x-y.toml");
        let baseline = Baseline {
            simd: "avx2".to_owned(),
            rustc: "rustc 1.95.0".to_owned(),
            instructions: BTreeMap::from([("ray_sphere".to_owned(), 12)]),
        };
        assert_eq!(Baseline::read(&path).unwrap(), None);
        baseline.write(&path).unwrap();
        assert_eq!(Baseline::read(&path).unwrap(), Some(baseline));
        fs::write(&path, "instructions = 3").unwrap();
        assert!(Baseline::read(&path).is_err());
        fs::remove_dir_all(folder).unwrap();
    }
}
