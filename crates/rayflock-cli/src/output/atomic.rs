//! Files appear whole or not at all: written beside their place, then renamed into it.
//!
//! The name of the unfinished file is fixed (`.NAME.partial`), so that a run that was killed
//! leaves at most one, and the run that resumes it takes that one over.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

/// Has `write` write the file that is to become `path`. On failure nothing is left behind, and
/// what was at `path` before stays.
pub(crate) fn write_whole(path: &Path, write: impl FnOnce(&Path) -> Result<()>) -> Result<()> {
    if is_device(path) {
        return write(path).with_context(|| format!("cannot write {}", path.display()));
    }
    let partial = partial_path(path);
    let renamed = write(&partial)
        .and_then(|()| fs::rename(&partial, path).context("cannot rename the finished file"));
    if renamed.is_err() {
        // The failure itself is what the user needs to hear; the file may never have existed.
        let _ = fs::remove_file(&partial);
    }
    renamed.with_context(|| format!("cannot write {}", path.display()))
}

/// Finds out whether `path` can be written, without touching what is there.
pub(crate) fn check_writable(path: &Path) -> Result<()> {
    let check = || -> Result<()> {
        anyhow::ensure!(!path.is_dir(), "it is a folder; expected the path of a file");
        if is_device(path) {
            return Ok(());
        }
        let partial = partial_path(path);
        File::create(&partial)?;
        fs::remove_file(&partial)?;
        Ok(())
    };
    check().with_context(|| format!("cannot write {}", path.display()))
}

/// Whether `path` is something like `/dev/stdout`, which renaming a file would replace.
fn is_device(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir())
}

/// Where `path` is written to until it is finished.
fn partial_path(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.partial"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.txt");
        fs::write(&path, "old").unwrap();
        let result = write_whole(&path, |partial| {
            fs::write(partial, "half")?;
            anyhow::bail!("the disk is full")
        });
        let message = format!("{:#}", result.unwrap_err());
        assert!(message.ends_with("x.txt: the disk is full"), "{message}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_folder_is_not_a_writable_file() {
        let folder = tempfile::tempdir().unwrap();
        assert!(check_writable(folder.path()).is_err());
        assert!(check_writable(&folder.path().join("missing/x.png")).is_err());
        check_writable(&folder.path().join("x.png")).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
