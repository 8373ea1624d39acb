//! What all fuzz targets do: one has a parser read the bytes as a file, show its first frames, and
//! panics when that takes more memory than a file of that size may.
//!
//! `cargo xtask fuzz` builds and runs them; CONTRIBUTING.md tells how to keep what they find.

#[path = "../../crates/rayflock-import/tests/memory/limit.rs"]
mod limit;
#[path = "../../crates/rayflock-import/tests/damage/samples.rs"]
mod samples;
#[path = "../../crates/rayflock-import/tests/damage/survive.rs"]
mod survive;

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use tempfile::TempDir;

/// Where inputs are written, in memory where the system has such a place.
static FOLDER: LazyLock<TempDir> = LazyLock::new(|| {
    let in_memory = Path::new("/dev/shm");
    let folder = match in_memory.is_dir() {
        true => tempfile::tempdir_in(in_memory),
        false => tempfile::tempdir(),
    };
    let folder = folder.expect("a temporary folder can be made");
    samples::write_neighbours(folder.path());
    folder
});

/// Has the parser that `target` names read `bytes`.
///
/// # Panics
/// When it takes too much memory or time, or panics itself.
pub fn ask(target: &str, bytes: &[u8]) {
    let folder = FOLDER.path();
    // An error is an answer.
    let _ = limit::assert_within(target, bytes.len(), || survive::ask(target, folder, bytes));
}

/// Writes sound inputs of `target` to the folder that the variable `RAYFLOCK_SEEDS` of the
/// environment names, if it does.
///
/// # Panics
/// When the folder cannot be written to.
pub fn write_seeds(target: &str) {
    let Some(folder) = std::env::var_os("RAYFLOCK_SEEDS").map(PathBuf::from) else { return };
    std::fs::create_dir_all(&folder).expect("the folder for seeds can be made");
    for (seed_idx, bytes) in seeds(target).into_iter().enumerate() {
        let seed = folder.join(format!("seed_{seed_idx}"));
        std::fs::write(seed, bytes).expect("the folder for seeds is writable");
    }
}

fn seeds(target: &str) -> Vec<Vec<u8>> {
    match target {
        "mtl" => vec![samples::MTL.to_vec()],
        "npy" => {
            let arrays = (0..).zip(samples::arrays());
            arrays.map(|(array, (_, bytes))| [&[array], bytes.as_slice()].concat()).collect()
        }
        _ => {
            let named = |name: &str| name.rsplit('.').next() == Some(target);
            let samples = samples::samples().into_iter();
            samples.filter(|(name, _)| named(name)).map(|(_, bytes)| bytes).collect()
        }
    }
}
