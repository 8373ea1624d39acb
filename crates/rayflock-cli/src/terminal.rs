//! What the program says: results on standard output, everything else on standard error.
//!
//! `println!` and `eprintln!` panic when nobody can read them (`rayflock info x | head -1`), so
//! nothing else in the program prints.

use std::fmt::Arguments;
use std::io::{self, IsTerminal, Write};

use anyhow::{Context, Result};

/// Writes a line to standard error. There is nowhere to report a failure to.
pub(crate) fn say(line: Arguments<'_>) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Writes `text` to standard output; a reader that has gone away has seen what it wanted.
pub(crate) fn answer(text: &str) -> Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(error).context("cannot write to standard output")
        }
        _ => Ok(()),
    }
}

/// Whether somebody watches standard error.
pub(crate) fn is_watched() -> bool {
    io::stderr().is_terminal()
}
