//! CSV: a line a sample.

use std::path::Path;

use anyhow::Result;

use crate::commands::sun::hours::SunHours;

/// Writes number, place and hours of each sample.
pub(super) fn write(path: &Path, hours: &SunHours<'_>) -> Result<()> {
    let mut table = csv::Writer::from_path(path)?;
    table.write_record(["index", "x", "y", "z", "hours"])?;
    for (idx, (position, hours)) in hours.positions.iter().zip(&hours.hours).enumerate() {
        table.serialize((idx, position.x, position.y, position.z, hours))?;
    }
    Ok(table.flush()?)
}
