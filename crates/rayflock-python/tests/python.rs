//! Runs the tests of the Python package, `python/tests`, on the library that cargo has just built.
//!
//! They want a Python with what they need, in `python-venv` of cargo's target folder:
//! `cargo xtask python` puts one there. Without it, this test says so and passes.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs, io};

#[test]
fn the_python_package_passes_its_tests() {
    let Some(python) = python() else { return };
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let installed = Path::new(env!("CARGO_TARGET_TMPDIR")).join("python");
    install(&root, &installed).unwrap();
    let status = Command::new(python)
        .args(["-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider", "python/tests"])
        .current_dir(&root)
        .env("PYTHONPATH", &installed)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .status();
    assert!(status.unwrap().success(), "see what pytest says above");
}

/// The interpreter that has what the tests need.
fn python() -> Option<PathBuf> {
    let Some(target) = target() else { panic!("cargo runs tests in a folder of their own") };
    let folder = if cfg!(windows) { "Scripts" } else { "bin" };
    let program = target.join("python-venv").join(folder);
    let program = program.join(format!("python{}", env::consts::EXE_SUFFIX));
    if !program.is_file() {
        let program = program.display();
        eprintln!("skipped: there is no {program}; \"cargo xtask python\" makes it");
        return None;
    }
    Some(program)
}

/// The target folder: that of the profile lies in it, and in that one the folder of tests.
fn target() -> Option<PathBuf> {
    let test = env::current_exe().ok()?;
    test.parent()?.parent()?.parent().map(Path::to_owned)
}

/// Puts the package together in a folder, as it is in a wheel.
fn install(root: &Path, folder: &Path) -> io::Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder)?;
    }
    copy(&root.join("python/rayflock"), &folder.join("rayflock"))?;
    let (prefix, suffix) = (env::consts::DLL_PREFIX, env::consts::DLL_SUFFIX);
    let library = format!("{prefix}_native{suffix}");
    let library = env::current_exe()?.with_file_name(library);
    let name = if cfg!(windows) { "_native.pyd" } else { "_native.abi3.so" };
    fs::copy(library, folder.join("rayflock").join(name))?;
    Ok(())
}

fn copy(from: &Path, to: &Path) -> io::Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let place = to.join(entry.file_name());
        if entry.file_type()?.is_file() {
            fs::copy(entry.path(), place)?;
        } else if entry.file_name() != "__pycache__" {
            copy(&entry.path(), &place)?;
        }
    }
    Ok(())
}
