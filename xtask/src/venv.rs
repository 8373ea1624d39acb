//! Virtual environments of Python, in the folder that cargo builds in.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::tools;

/// A virtual environment that is there.
#[derive(Debug)]
pub(crate) struct Venv(PathBuf);

impl Venv {
    /// The environment of that name, made where it is missing.
    ///
    /// # Errors
    /// Says what Python says when it cannot.
    pub(crate) fn want(root: &Path, name: &str) -> Result<Self> {
        let venv = Self(tools::target(root).join(name));
        if !venv.python().is_file() {
            let mut make = Command::new("python3");
            make.args(["-m", "venv", "--clear"]).arg(&venv.0);
            finish(make, "python3 -m venv failed; is Python 3.11 or newer there?")?;
        }
        Ok(venv)
    }

    /// Its interpreter.
    pub(crate) fn python(&self) -> PathBuf {
        self.0.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" })
    }

    /// Installs what a file names, unless that has been done: then a copy of the file says so.
    ///
    /// # Errors
    /// Says what pip says when it cannot.
    pub(crate) fn install(&self, requirements: &Path) -> Result<()> {
        let wanted = fs::read(requirements)
            .with_context(|| format!("cannot read {}", requirements.display()))?;
        let done = self.0.join(requirements.file_name().unwrap_or_default());
        if fs::read(&done).is_ok_and(|installed| installed == wanted) {
            return Ok(());
        }
        println!("== tools: pip install -r {}", requirements.display());
        let mut pip = Command::new(self.python());
        pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
        pip.args(["--retries=1", "--timeout=15", "--requirement"]).arg(requirements);
        finish(pip, "pip install failed")?;
        fs::write(&done, wanted).with_context(|| format!("cannot write {}", done.display()))
    }
}

/// Runs a command of Python to its end.
pub(crate) fn finish(mut command: Command, failure: &str) -> Result<()> {
    let output = command.output().context("cannot run python3; install Python 3 with pip")?;
    let words = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{failure}: {}", words.trim());
    Ok(())
}
