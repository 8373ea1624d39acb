//! `rayflock bench`, one subcommand a file.

mod museum;

use std::fs;
use std::path::Path;

use anyhow::Result;
use serde::Serialize;

use crate::args::{BenchArguments, BenchCommand};
use crate::failure::Failure;
use crate::output::atomic;

/// Measures what the user asked for.
pub(super) fn run(args: &BenchArguments) -> Result<(), Failure> {
    match &args.command {
        BenchCommand::Scene(args) => museum::run(args),
    }
}

/// Writes a record to a file, whole or not at all.
fn write_json(path: &Path, record: &impl Serialize) -> Result<()> {
    let json = serde_json::to_string_pretty(record)?;
    atomic::write_whole(path, |partial| Ok(fs::write(partial, json + "\n")?))
}
