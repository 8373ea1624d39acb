//! The record as text: a row a way to see.

use comfy_table::{CellAlignment, Table, presets};

use crate::record::{Cell, Record};
use crate::text::short;

const HEADER: [&str; 8] = [
    "visibility",
    "fit ms",
    "gather ms",
    "total ms",
    "spread",
    "times faster",
    "mean FLIP",
    "relative RMSE",
];

/// The record for people, ending in a line break.
pub fn format(record: &Record) -> String {
    let Some(first) = record.cells.first() else { return String::new() };
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(HEADER);
    table.add_rows(record.cells.iter().map(|cell| row(first, cell)));
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let Cell { scene, threads, triangles, engine, .. } = first;
    let lights = first.facts.get("virtual lights").copied().unwrap_or_default();
    format!(
        "{scene}: {triangles} triangles, {lights:.0} virtual lights, {threads} threads, {}; \
         times faster than {engine}, and compared with it\n\n{}\n",
        record.machine.simd,
        table.trim_fmt()
    )
}

fn row(first: &Cell, cell: &Cell) -> [String; 8] {
    let optional = |value: Option<f64>| value.map_or_else(String::new, short);
    let fact =
        |name: &str| cell.facts.get(name).map_or_else(String::new, |value| format!("{value:.4}"));
    let faster = first.total_ms.zip(cell.total_ms).map(|(first, total)| first / total);
    [
        cell.engine.clone(),
        optional(cell.commit_ms),
        optional(cell.trace_ms),
        optional(cell.total_ms),
        format!("{:.0}%", 100.0 * cell.spread),
        faster.map_or_else(String::new, |faster| format!("{faster:.2}")),
        fact("mean FLIP"),
        fact("relative RMSE"),
    ]
}
