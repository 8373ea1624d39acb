//! CSV: a line a point.

use std::io::Write;

use super::{PointColumns, PointFileError};

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
pub(super) fn write(points: &PointColumns<'_>, out: &mut impl Write) -> Result<(), PointFileError> {
    let mut table = ::csv::Writer::from_writer(out);
    table.write_record(HEAD)?;
    for idx in 0..points.len() {
        table.serialize((
            points.position[idx].to_array(),
            points.position_in_sensor[idx].to_array(),
            points.normal[idx].to_array(),
            (points.range[idx], points.intensity[idx], points.time[idx]),
            (points.object_id[idx], points.prim_id[idx], points.row[idx], points.column[idx]),
            (points.return_number[idx], points.return_count[idx]),
        ))?;
    }
    Ok(table.flush()?)
}
