//! Brings a record to where the user wants it.

use std::fs;
use std::path::Path;

use anyhow::Result;
use rayflock_bench::record::Record;
use rayflock_bench::report;

use crate::args::OutputArguments;
use crate::failure::{Blame, Failure};
use crate::output::atomic;

/// Finds out before measuring whether everything can be written, without touching what is there.
pub(super) fn check(args: &OutputArguments) -> Result<(), Failure> {
    args.paths().try_for_each(|path| atomic::check_writable(path)).blame_output()
}

/// Writes the files the user asked for, each whole or not at all.
pub(super) fn write(args: &OutputArguments, record: &Record) -> Result<(), Failure> {
    write_files(args, record).blame_output()
}

fn write_files(args: &OutputArguments, record: &Record) -> Result<()> {
    if let Some(path) = &args.json {
        write_text(path, serde_json::to_string_pretty(record)? + "\n")?;
    }
    if let Some(path) = &args.html {
        write_text(path, report::html(record)?)?;
    }
    if let Some(path) = &args.csv {
        write_text(path, report::csv(record))?;
    }
    if let Some(path) = &args.markdown {
        write_text(path, report::markdown(record))?;
    }
    Ok(())
}

fn write_text(path: &Path, text: String) -> Result<()> {
    atomic::write_whole(path, |partial| Ok(fs::write(partial, text)?))
}
