//! What reading takes stays within limits: for files that claim to be large, for what fuzzing found
//! before, and for sequences however long.
//!
//! Memory is counted for the whole program, so that all of it is one test, in a program of its own.

#[path = "../damage/samples.rs"]
mod samples;
#[path = "../damage/survive.rs"]
mod survive;

mod claims;
mod limit;
mod sequence;

use std::path::{Path, PathBuf};

use samples::{samples, write_neighbours};

/// What fuzzing has found: a folder a target.
const REGRESSIONS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/regressions");

#[test]
fn memory_stays_within_limits() {
    let folder = tempfile::tempdir().unwrap();
    write_neighbours(folder.path());
    for (name, bytes) in samples() {
        let ask = || survive::load_in(folder.path(), name, &bytes);
        let loaded = limit::assert_within(name, bytes.len(), ask);
        assert!(loaded.is_ok(), "{name}: {loaded:?}");
    }
    for (name, bytes) in claims::large_claims().into_iter().chain(claims::bombs()) {
        let ask = || survive::load_in(folder.path(), name, &bytes);
        let loaded = limit::assert_within(name, bytes.len(), ask);
        let message = loaded.expect_err("the claim is false");
        assert!(message.contains(name), "{message}");
    }
    for (target, path) in regressions() {
        let bytes = std::fs::read(&path).unwrap();
        let name = path.to_string_lossy();
        println!("{name}");
        let ask = || survive::ask(&target, folder.path(), &bytes);
        let _ = limit::assert_within(&name, bytes.len(), ask);
    }
    sequence::assert_streams(folder.path());
}

/// The files in the folder of each target.
fn regressions() -> Vec<(String, PathBuf)> {
    let entries = |folder: &Path| {
        let entries = std::fs::read_dir(folder).expect("the folder is there");
        let mut paths: Vec<PathBuf> =
            entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
        paths.sort();
        paths
    };
    let targets = entries(Path::new(REGRESSIONS)).into_iter().filter(|path| path.is_dir());
    let files = |target: PathBuf| {
        let name = target.file_name().unwrap_or_default().to_string_lossy().into_owned();
        entries(&target).into_iter().map(move |path| (name.clone(), path))
    };
    targets.flat_map(files).collect()
}
