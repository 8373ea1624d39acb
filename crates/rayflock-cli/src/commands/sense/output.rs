//! Files of points, one format a file.

mod csv;
mod npz;
mod pcd;
mod ply;

use std::path::Path;

use anyhow::{Result, bail};
use tracing::debug_span;

use super::scan::Scan;
use crate::frames::FrameRange;
use crate::output::{FrameNames, atomic};

/// Files that points go to, one a sweep.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct OutputFile {
    names: FrameNames,
    format: OutputFormat,
}

/// How points are written down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum OutputFormat {
    Ply,
    Pcd,
    Npz,
    Csv,
}

impl OutputFile {
    /// Understands `path` by its extension.
    pub(super) fn new(path: &Path, sweeps: FrameRange) -> Result<Self> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let format = match extension.as_str() {
            "ply" => OutputFormat::Ply,
            "pcd" => OutputFormat::Pcd,
            "npz" => OutputFormat::Npz,
            "csv" => OutputFormat::Csv,
            _ => bail!(
                "cannot tell the format of the output \"{}\": expected a .ply, .pcd, .npz or .csv \
                 file",
                path.display()
            ),
        };
        Ok(Self { names: sweep_names(path, sweeps), format })
    }

    /// The paths of the files.
    pub(super) const fn names(&self) -> &FrameNames {
        &self.names
    }

    /// Writes the file of a sweep, whole or not at all.
    pub(super) fn write(&self, sweep: u32, scan: &Scan<'_>) -> Result<()> {
        let _span = debug_span!("write_points").entered();
        atomic::write_whole(&self.names.path(sweep), |partial| match self.format {
            OutputFormat::Ply => ply::write(partial, scan),
            OutputFormat::Pcd => pcd::write(partial, scan),
            OutputFormat::Npz => npz::write(partial, scan),
            OutputFormat::Csv => csv::write(partial, scan),
        })
    }
}

/// The paths of a file a sweep: of one, `path` itself, unless it is a pattern.
pub(super) fn sweep_names(path: &Path, sweeps: FrameRange) -> FrameNames {
    FrameNames::from_pattern(path).unwrap_or_else(|| match sweeps.count() {
        1 => FrameNames::Single(path.to_owned()),
        _ => FrameNames::numbered_from(path),
    })
}
