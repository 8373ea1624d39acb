//! Tests of `python/tools`, which turns USD and Alembic files into frame sets.
//!
//! Where the packages that they need cannot be had, the tests are skipped, and that is told.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::tools::target;
use crate::venv::Venv;

const TOOLS: &str = "python/tools";

/// Tests the converter with the program that the tests before have built.
pub(crate) fn test(root: &Path) -> Result<()> {
    println!("== converter of USD and Alembic: pytest {TOOLS}");
    let tools = root.join(TOOLS);
    let python = match prepare(root, &tools) {
        Ok(python) => python,
        Err(error) => {
            println!("== converter of USD and Alembic: skipped: {error:#}");
            return Ok(());
        }
    };
    let program = format!("rayflock{}", std::env::consts::EXE_SUFFIX);
    let program = target(root).join("debug").join(program);
    ensure!(program.exists(), "{} is not there: the tests build it", program.display());
    let mut pytest = Command::new(python);
    pytest.args(["-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider", "tests"]);
    pytest.env("RAYFLOCK", program).env("PYTHONDONTWRITEBYTECODE", "1").current_dir(tools);
    let status = pytest.status().context("cannot run pytest")?;
    ensure!(status.success(), "the tests of {TOOLS} failed ({status})");
    Ok(())
}

/// A Python with the packages that the tests need.
fn prepare(root: &Path, tools: &Path) -> Result<PathBuf> {
    let venv = Venv::want(root, "convert-tools-venv")?;
    venv.install(&tools.join("requirements-test.txt"))?;
    Ok(venv.python())
}
