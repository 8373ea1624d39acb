//! Programs that some tests want. Nothing but cargo is needed: a test that misses a program says
//! so and passes.

use std::process::{Command, Stdio};

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
