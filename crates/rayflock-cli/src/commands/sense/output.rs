//! Files of points.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use anyhow::Result;
use rayflock::import::export::points::{PointFormat, write_points};
use tracing::debug_span;

use super::scan::Scan;
use crate::frames::FrameRange;
use crate::output::{FrameNames, atomic};

/// Files that points go to, one a sweep.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct OutputFile {
    names: FrameNames,
    format: PointFormat,
}

impl OutputFile {
    /// Understands `path` by its extension.
    pub(super) fn new(path: &Path, sweeps: FrameRange) -> Result<Self> {
        Ok(Self { names: sweep_names(path, sweeps), format: PointFormat::of_path(path)? })
    }

    /// The paths of the files.
    pub(super) const fn names(&self) -> &FrameNames {
        &self.names
    }

    /// Writes the file of a sweep, whole or not at all.
    pub(super) fn write(&self, sweep: u32, scan: &Scan<'_>) -> Result<()> {
        let _span = debug_span!("write_points").entered();
        atomic::write_whole(&self.names.path(sweep), |partial| {
            let mut file = BufWriter::new(File::create(partial)?);
            Ok(write_points(&scan.points(), self.format, &mut file)?)
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
