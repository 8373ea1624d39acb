//! Programs that some checks want. The tests need nothing but cargo: one that misses a program says
//! so and passes.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Result, bail};

use crate::{embree, python};

/// Installs ffmpeg where it is missing and can be had without asking: as root, with apt-get.
/// Without it, the test that writes an MP4 is skipped.
pub(crate) fn want_ffmpeg() {
    if !succeeds("ffmpeg", &["-version"]) && can_install() && !install("ffmpeg") {
        println!("== tools: ffmpeg cannot be installed; the test of MP4 will be skipped");
    }
}

/// Finds a C++ compiler, or installs one as [`want_ffmpeg`] does; tells whether there is one.
pub(crate) fn want_cxx() -> bool {
    let is_there = || succeeds("c++", &["--version"]);
    is_there() || (can_install() && install("g++") && is_there())
}

/// Finds valgrind, or installs it as [`want_ffmpeg`] does.
///
/// # Errors
/// Says how to get it, where it is missing and cannot be installed.
pub(crate) fn need_valgrind() -> Result<()> {
    let is_there = || succeeds("valgrind", &["--version"]);
    if is_there() || (can_install() && install("valgrind") && is_there()) {
        return Ok(());
    }
    bail!(
        "valgrind is missing: install it as root by \"apt-get install valgrind\", or from the \
         packages of your system (there is none for Windows and macOS on ARM)"
    )
}

pub(crate) fn can_install() -> bool {
    succeeds("apt-get", &["--version"]) && is_root()
}

pub(crate) fn install(package: &str) -> bool {
    println!("== tools: apt-get install {package}");
    let install = ["install", "-y", "-q", "--no-install-recommends", package];
    succeeds("apt-get", &install)
        || (succeeds("apt-get", &["update", "-q"]) && succeeds("apt-get", &install))
}

/// Fetches Embree where it is missing and nobody said where it is. Without it, tests of Embree are
/// skipped.
pub(crate) fn want_embree(root: &Path) {
    match std::env::var_os("EMBREE_LIB").filter(|path| !path.is_empty()) {
        Some(path) => println!("== tools: Embree: {}", Path::new(&path).display()),
        None => {
            println!("== tools: cargo xtask embree");
            if let Err(error) = embree::run(root) {
                println!("== tools: tests of Embree will be skipped: {error:#}");
            }
        }
    }
}

/// Makes the Python with which the package is tested. Without it, those tests are skipped.
pub(crate) fn want_python(root: &Path) {
    println!("== tools: cargo xtask python");
    if let Err(error) = python::run(root) {
        println!("== tools: tests of the Python package will be skipped: {error:#}");
    }
}

/// The folder that cargo builds in: cargo is called in the root, which relative names are below.
pub(crate) fn target(root: &Path) -> PathBuf {
    let given = std::env::var_os("CARGO_TARGET_DIR").filter(|folder| !folder.is_empty());
    given.map_or_else(|| root.join("target"), |folder| root.join(folder))
}

fn is_root() -> bool {
    let id = Command::new("id").arg("-u").output();
    id.is_ok_and(|id| id.stdout.trim_ascii() == b"0")
}

fn succeeds(program: &str, args: &[&str]) -> bool {
    let mut command = Command::new(program);
    command.args(args).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.env("DEBIAN_FRONTEND", "noninteractive");
    command.status().is_ok_and(|status| status.success())
}
