//! What has to be said about a record below its tables.

use std::fmt::Write;

use crate::record::{Cell, Record};
use crate::text::count;

/// Which entries are noisy, and where engines disagree; ends in a line break if there is any.
pub(crate) fn notes(record: &Record) -> String {
    let mut text = String::new();
    let noisy = record.cells.iter().filter(|cell| cell.noisy).count();
    if noisy > 0 {
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "* noisy: quartiles more than a tenth of the median apart ({noisy} entries)"
        );
    }
    let differing: Vec<_> = record.cells.iter().filter(|cell| cell.mismatches > 0).collect();
    if !differing.is_empty() {
        text.push_str("! rays answered otherwise than by the reference:\n");
    }
    for cell in differing {
        let Cell { engine, kind, mismatches, judged, .. } = cell;
        let (triangles, rays) = (count(cell.triangles), count(cell.rays as usize));
        let _ = writeln!(
            text,
            "  {triangles} x {rays} {kind}, {engine}: {mismatches}; of {} judged, right are: both \
             {}, only this {}, only the reference {}, neither {}",
            judged.rays, judged.both_right, judged.only_this, judged.only_reference, judged.neither
        );
    }
    text
}
