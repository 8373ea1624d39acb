//! A record as CSV: a heading, then one row a cell and engine.

use csv::Writer;

use crate::ratio::{Ratio, Ratios};
use crate::record::{Cell, Record};

const HEADING: [&str; 30] = [
    "benchmark",
    "scene",
    "kind",
    "triangles",
    "rays",
    "threads",
    "engine",
    "setting",
    "commit_ms",
    "trace_ms",
    "total_ms",
    "spread",
    "noisy",
    "opponent_ms",
    "ratio",
    "mismatches",
    "judged_rays",
    "judged_both_right",
    "judged_only_this",
    "judged_only_reference",
    "judged_neither",
    "cone_tests",
    "box_tests",
    "triangle_tests",
    "tiles",
    "pairs",
    "bytes",
    "allocations",
    "memory_bytes",
    "skipped",
];

/// The record as CSV with a heading. `ratio` is the opponent's total over that of the row's
/// engine, empty for the opponent itself; numbers that were not measured are empty.
pub fn csv(record: &Record) -> String {
    let ratios = record.ratios();
    let mut writer = Writer::from_writer(Vec::new());
    let rows = record.cells.iter().map(|cell| row(record, &ratios, cell));
    let written = writer
        .write_record(HEADING)
        .and_then(|()| rows.map(|row| writer.write_record(row)).collect::<Result<Vec<()>, _>>());
    let bytes = written.ok().and_then(|_| writer.into_inner().ok());
    let Some(text) = bytes.and_then(|bytes| String::from_utf8(bytes).ok()) else {
        unreachable!("rows of the same length are written to memory, and text stays text")
    };
    text
}

fn row(record: &Record, ratios: &Ratios<'_>, cell: &Cell) -> [String; 30] {
    let optional = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    let ratio = ratios.get(&cell.engine, &cell.work());
    let (judged, counters) = (&cell.judged, &cell.counters);
    [
        record.benchmark.clone(),
        cell.scene.clone(),
        cell.kind.clone(),
        cell.triangles.to_string(),
        cell.rays.to_string(),
        cell.threads.to_string(),
        cell.engine.clone(),
        cell.setting.clone(),
        optional(cell.commit_ms),
        optional(cell.trace_ms),
        optional(cell.total_ms),
        cell.spread.to_string(),
        cell.noisy.to_string(),
        optional(ratio.and_then(|ratio| ratio.theirs.total_ms)),
        optional(ratio.and_then(Ratio::value)),
        cell.mismatches.to_string(),
        judged.rays.to_string(),
        judged.both_right.to_string(),
        judged.only_this.to_string(),
        judged.only_reference.to_string(),
        judged.neither.to_string(),
        counters.cone_tests.to_string(),
        counters.box_tests.to_string(),
        counters.triangle_tests.to_string(),
        counters.tiles.to_string(),
        counters.pairs.to_string(),
        counters.bytes.to_string(),
        counters.allocations.map_or_else(String::new, |count| count.to_string()),
        cell.memory_bytes.to_string(),
        cell.skipped.clone().unwrap_or_default(),
    ]
}
