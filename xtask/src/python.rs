//! `cargo xtask python`: the Python with which the tests of the package `rayflock` run.
//!
//! It has what the tests need and the libraries that the package is compared with, in the versions
//! of `python/tests/requirements`. A library that cannot be had costs its comparison, not the tests.
//! Nothing is done where all is there.

use std::path::Path;

use anyhow::Result;

use crate::venv::Venv;

/// What must be there, then what may be missing, each a file of requirements.
const NEEDED: &str = "needed.txt";
const COMPARED: [&str; 3] = ["trimesh.txt", "embreex.txt", "open3d.txt"];

/// Makes the environment, and says where it is and what is missing.
pub(crate) fn run(root: &Path) -> Result<()> {
    let venv = Venv::want(root, "python-venv")?;
    let requirements = root.join("python/tests/requirements");
    venv.install(&requirements.join(NEEDED))?;
    for name in COMPARED {
        if let Err(error) = venv.install(&requirements.join(name)) {
            println!("== python: nothing is compared with what {name} names: {error:#}");
        }
    }
    println!("Python is at {}", venv.python().display());
    Ok(())
}
