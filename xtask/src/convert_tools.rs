//! Tests of `python/tools`, which turns USD and Alembic files into frame sets.
//!
//! The packages are installed into a folder of their own below the folder that cargo builds in,
//! once for each list of them. Where they cannot be had, the tests are skipped, and that is told.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::embree::{finish, target};

const TOOLS: &str = "python/tools";

/// Tests the converter with the program that the tests before have built.
pub(crate) fn test(root: &Path) -> Result<()> {
    println!("== converter of USD and Alembic: pytest {TOOLS}");
    let tools = root.join(TOOLS);
    let venv = target(root).join("convert-tools-venv");
    let python = match install(&venv, &tools.join("requirements-test.txt")) {
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

/// The Python of the folder `venv`, with the packages in the list.
fn install(venv: &Path, list: &Path) -> Result<PathBuf> {
    let wanted = fs::read(list).with_context(|| format!("cannot read {}", list.display()))?;
    let folder = if cfg!(windows) { "Scripts" } else { "bin" };
    let python = venv.join(folder).join("python");
    let installed = venv.join("installed.txt");
    if fs::read(&installed).is_ok_and(|installed| installed == wanted) {
        return Ok(python);
    }
    println!("== converter of USD and Alembic: pip install -r {}", list.display());
    let mut create = Command::new("python3");
    create.args(["-m", "venv", "--clear"]).arg(venv);
    finish(create, "python3 cannot make a virtual environment")?;
    let mut install = Command::new(&python);
    install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
    install.args(["--retries=1", "--timeout=15", "--requirement"]).arg(list);
    finish(install, "pip cannot install the packages")?;
    fs::write(&installed, wanted).context("cannot note what is installed")?;
    Ok(python)
}
