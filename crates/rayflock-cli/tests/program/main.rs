//! The program as a user meets it: arguments in, files, messages and exit codes out.

mod bench;
mod convert;
mod demo_and_info;
mod engines;
mod errors;
mod explain;
mod formats;
mod resume;
mod sense;
mod sequences;
mod stats;
mod sun;
mod trace;

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

/// A folder of its own for one test.
struct Workplace(TempDir);

/// What a run left: exit code and words.
#[derive(Debug)]
struct Run {
    code: i32,
    stdout: String,
    stderr: String,
}

impl Workplace {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder for the test"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The program with words split at spaces, started in the folder.
    fn command(&self, words: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rayflock"));
        command.args(words.split_whitespace()).current_dir(self.0.path()).stdin(Stdio::null());
        // Mesa's layer that chooses among devices complains where there is no display.
        command.env("NODEVICE_SELECT", "1");
        command
    }

    fn run(&self, words: &str) -> Run {
        Run::from(self.command(words).output().expect("the program starts"))
    }

    /// Runs and expects success without a word on standard error.
    fn run_quietly(&self, words: &str) -> Run {
        let run = self.run(words);
        assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{words}");
        run
    }

    fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), bytes).expect("the folder is writable");
    }

    /// The names of everything in the folder, hidden files included, sorted.
    fn names(&self) -> Vec<String> {
        names_in(self.0.path())
    }
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        Self {
            // A signal has no exit code.
            code: output.status.code().unwrap_or(-1),
            stdout: text(&output.stdout),
            stderr: text(&output.stderr),
        }
    }
}

fn names_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("the folder can be listed");
    let mut names: Vec<_> = entries
        .map(|entry| entry.expect("the folder can be listed").file_name())
        .map(|name| name.to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}
