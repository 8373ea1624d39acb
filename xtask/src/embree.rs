//! `cargo xtask embree`: fetches the library Embree, which benchmarks and their tests compare with.
//!
//! It comes as the Python wheel `embreex`, which carries the library and its task scheduler. pip
//! downloads it and checks its digest; any Python will do, because the wheel is only unpacked.
//! Nothing is done when the library is there.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, anyhow, ensure};

use crate::tools;
use crate::venv::finish;

/// Also in `crates/rayflock-bench/src/peer/embree/library.rs`, which looks there.
const VERSION: &str = "4.4.0.post1";
/// Of the wheel for Linux on x86_64; the files of the library in all wheels are the same.
const SHA256: &str = "2cd0f7d5c6342e6247e31f700761689cae7829454d8c6de0c41e62124a023e1f";
const WHEEL: [&str; 10] = [
    "--platform=manylinux_2_28_x86_64",
    "--python-version=311",
    "--implementation=cp",
    "--abi=cp311",
    "--only-binary=:all:",
    "--no-deps",
    "--require-hashes",
    "--disable-pip-version-check",
    "--retries=1",
    "--timeout=15",
];
const OTHERWISE: &str = "EMBREE_LIB, or --embree-lib of the program, can say where the libembree4 \
                         of another Embree 4 is";

/// Fetches the library unless it is there, and says where it is.
pub(crate) fn run(root: &Path) -> Result<()> {
    let folder = tools::target(root).join("embree").join(VERSION);
    if library_in(&folder).is_err() {
        fetch(&folder)
            .map_err(|error| anyhow!("Embree cannot be fetched: {error:#}; {OTHERWISE}"))?;
    }
    println!("Embree is at {}", library_in(&folder)?.display());
    Ok(())
}

fn library_in(folder: &Path) -> Result<PathBuf> {
    let libraries = folder.join("embreex.libs");
    let list = || fs::read_dir(&libraries).with_context(|| format!("no {}", libraries.display()));
    let mut found = list()?.filter_map(|entry| Some(entry.ok()?.path()));
    let is_library = |path: &PathBuf| {
        path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("libembree4"))
    };
    found.find(is_library).with_context(|| format!("no libembree4 in {}", libraries.display()))
}

/// Downloads and unpacks the wheel; `folder` is there as a whole or not at all.
fn fetch(folder: &Path) -> Result<()> {
    ensure!(
        cfg!(all(target_os = "linux", target_arch = "x86_64")),
        "the wheel is for Linux on x86_64, this is {} on {}",
        std::env::consts::OS,
        std::env::consts::ARCH
    );
    let partial = folder.with_extension("partial");
    if partial.exists() {
        fs::remove_dir_all(&partial).context("cannot remove an earlier attempt")?;
    }
    fs::create_dir_all(&partial).with_context(|| format!("cannot create {}", partial.display()))?;

    let requirements = partial.join("requirements.txt");
    fs::write(&requirements, format!("embreex=={VERSION} --hash=sha256:{SHA256}\n"))?;
    let mut download = python(&["pip", "download", "--quiet"]);
    download.args(WHEEL).arg("--dest").arg(&partial).arg("--requirement").arg(&requirements);
    finish(download, "pip cannot download the wheel embreex")?;

    let files = fs::read_dir(&partial)?.filter_map(|entry| Some(entry.ok()?.path()));
    let mut wheels = files.filter(|path| path.extension().is_some_and(|name| name == "whl"));
    let wheel = wheels.next().context("pip left no wheel")?;
    let unpacked = partial.join("unpacked");
    let mut unpack = python(&["zipfile", "--extract"]);
    unpack.arg(&wheel).arg(&unpacked);
    finish(unpack, "the wheel cannot be unpacked")?;

    library_in(&unpacked)?;
    if folder.exists() {
        fs::remove_dir_all(folder).context("cannot remove an incomplete library")?;
    }
    fs::rename(&unpacked, folder).with_context(|| format!("cannot create {}", folder.display()))?;
    fs::remove_dir_all(&partial).context("cannot remove what was downloaded")
}

/// `python3 -m` with these words.
fn python(words: &[&str]) -> Command {
    let mut command = Command::new("python3");
    command.arg("-m").args(words);
    command
}
