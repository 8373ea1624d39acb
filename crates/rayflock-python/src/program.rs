//! The program `rayflock`, for `python -m rayflock`.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Does what the words of a command line ask for, the first of which names the program, and returns
/// the exit code.
#[pyfunction]
pub(crate) fn run_program(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| rayflock_cli::run(words, None))
}
