//! Programs that some tests want. Nothing but cargo is needed: a test that misses a program says
//! so and passes.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::embree;

/// Installs ffmpeg where it is missing and can be had without asking: as root, with apt-get.
/// Without it, the test that writes an MP4 is skipped.
pub(crate) fn want_ffmpeg() {
    if succeeds("ffmpeg", &["-version"]) || !succeeds("apt-get", &["--version"]) || !is_root() {
        return;
    }
    println!("== tools: apt-get install ffmpeg");
    let install = ["install", "-y", "-q", "--no-install-recommends", "ffmpeg"];
    let installed = succeeds("apt-get", &install)
        || (succeeds("apt-get", &["update", "-q"]) && succeeds("apt-get", &install));
    if !installed {
        println!("== tools: ffmpeg cannot be installed; the test of MP4 will be skipped");
    }
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
