//! Brings a record to where the user wants it.

use std::fs;

use anyhow::Result;
use rayflock_bench::record::Record;

use crate::args::OutputArguments;
use crate::failure::{Blame, Failure};
use crate::output::atomic;

/// Finds out before measuring whether everything can be written, without touching what is there.
pub(super) fn check(args: &OutputArguments) -> Result<(), Failure> {
    args.json.as_deref().map_or(Ok(()), atomic::check_writable).blame_output()
}

/// Writes the files the user asked for, each whole or not at all.
pub(super) fn write(args: &OutputArguments, record: &Record) -> Result<(), Failure> {
    let write = || -> Result<()> {
        if let Some(path) = &args.json {
            let json = serde_json::to_string_pretty(record)? + "\n";
            atomic::write_whole(path, |partial| Ok(fs::write(partial, json)?))?;
        }
        Ok(())
    };
    write().blame_output()
}
