//! Files of hours, one format a file.

mod csv;
mod npz;
mod ply;

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use tracing::debug_span;

use super::hours::SunHours;
use crate::output::atomic;

/// A file that hours go to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct OutputFile {
    path: PathBuf,
    format: OutputFormat,
}

/// How hours are written down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum OutputFormat {
    Ply,
    Npz,
    Csv,
}

impl OutputFile {
    /// Understands `path` by its extension.
    pub(super) fn new(path: &Path) -> Result<Self> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let format = match extension.as_str() {
            "ply" => OutputFormat::Ply,
            "npz" => OutputFormat::Npz,
            "csv" => OutputFormat::Csv,
            _ => bail!(
                "cannot tell the format of the output \"{}\": expected a .ply, .npz or .csv file",
                path.display()
            ),
        };
        Ok(Self { path: path.to_owned(), format })
    }

    /// Where the hours go.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the file, whole or not at all.
    pub(super) fn write(&self, hours: &SunHours<'_>) -> Result<()> {
        let _span = debug_span!("write_hours").entered();
        atomic::write_whole(&self.path, |partial| match self.format {
            OutputFormat::Ply => ply::write(partial, hours),
            OutputFormat::Npz => npz::write(partial, hours),
            OutputFormat::Csv => csv::write(partial, hours),
        })
    }
}
