//! CSV: a line a point.

use std::path::Path;

use anyhow::Result;

use crate::commands::sense::scan::Scan;

/// The head of the table.
const HEAD: [&str; 18] = [
    "x",
    "y",
    "z",
    "x_sensor",
    "y_sensor",
    "z_sensor",
    "nx",
    "ny",
    "nz",
    "range",
    "intensity",
    "time",
    "object",
    "primitive",
    "row",
    "column",
    "return_number",
    "return_count",
];

/// Writes all that is known of each point.
pub(super) fn write(path: &Path, scan: &Scan<'_>) -> Result<()> {
    let sweep = scan.sweep;
    let mut table = csv::Writer::from_path(path)?;
    table.write_record(HEAD)?;
    for idx in 0..sweep.len() {
        table.serialize((
            sweep.position[idx].to_array(),
            sweep.position_in_sensor[idx].to_array(),
            sweep.normal[idx].to_array(),
            (sweep.range[idx], sweep.intensity[idx], sweep.time[idx]),
            (sweep.object_id[idx], sweep.prim_id[idx], sweep.row[idx], sweep.column[idx]),
            (sweep.return_number[idx], sweep.return_count[idx]),
        ))?;
    }
    Ok(table.flush()?)
}
