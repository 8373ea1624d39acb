//! `cargo xtask python`: the Python with which the tests of the package `rayflock` run.
//!
//! It is a virtual environment in cargo's target folder, with what the tests need and the libraries
//! that the package is compared with, in the versions of `python/tests/requirements`. A library
//! that cannot be had costs its comparison, not the tests. Nothing is done where all is there.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};

use crate::tools;

/// What must be there, then what may be missing, each a file of requirements.
const NEEDED: &str = "needed.txt";
const COMPARED: [&str; 3] = ["trimesh.txt", "embreex.txt", "open3d.txt"];

/// Makes the environment, and says where it is and what is missing.
pub(crate) fn run(root: &Path) -> Result<()> {
    let venv = tools::target(root).join("python-venv");
    let python = venv.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    if !python.is_file() {
        let mut make = Command::new("python3");
        finish(make.args(["-m", "venv", "--clear"]).arg(&venv), "python3 -m venv")?;
    }
    let requirements = root.join("python/tests/requirements");
    install(&python, &requirements.join(NEEDED), &venv)?;
    for name in COMPARED {
        if let Err(error) = install(&python, &requirements.join(name), &venv) {
            println!("== python: nothing is compared with what {name} names: {error:#}");
        }
    }
    println!("Python is at {}", python.display());
    Ok(())
}

/// Installs what a file names, unless that has been done: then a copy of the file says so.
fn install(python: &Path, requirements: &Path, venv: &Path) -> Result<()> {
    let wanted = fs::read(requirements)
        .with_context(|| format!("cannot read {}", requirements.display()))?;
    let done = venv.join(requirements.file_name().unwrap_or_default());
    if fs::read(&done).is_ok_and(|installed| installed == wanted) {
        return Ok(());
    }
    let mut pip = Command::new(python);
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
    finish(pip.arg("--requirement").arg(requirements), "pip install")?;
    fs::write(&done, wanted).with_context(|| format!("cannot write {}", done.display()))
}

fn finish(command: &mut Command, what: &str) -> Result<()> {
    let output = command.stdin(Stdio::null()).output();
    let output =
        output.with_context(|| format!("cannot run {what}; is Python 3.11 or newer there?"))?;
    let words = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{what} failed: {}", words.trim());
    Ok(())
}
