//! A record of rays over an animation as text.

use comfy_table::{CellAlignment, Table, presets};

use crate::notes::notes;
use crate::ratio::Ratio;
use crate::record::{Cell, Record};
use crate::text::{count, short};

const HEADER: [&str; 8] =
    ["rays", "engine", "commit ms", "trace ms", "total ms", "slowest frame", "ratio", "setting"];

/// The record for people: a row for each kind of rays and engine with means over the frames, and
/// how many times as fast as the opponent each is. Ends in a line break.
pub fn format(record: &Record) -> String {
    let Some(first) = record.cells.first() else { return String::new() };
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(HEADER);
    table.add_rows(record.cells.iter().map(|cell| row(record, cell)));
    for column in table.column_iter_mut().skip(2).take(5) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let Cell { scene, triangles, rays, threads, .. } = first;
    let (triangles, rays, frames) = (count(*triangles), count(*rays as usize), first.phases.len());
    let opponent = record.ratios().opponent.to_owned();
    format!(
        "{scene}: {triangles} triangles, {rays} rays, {frames} frames, {threads} threads; means \
         over the frames, ratios to {opponent}\n\n{}\n\n{}",
        table.trim_fmt(),
        notes(record)
    )
}

fn row(record: &Record, cell: &Cell) -> [String; 8] {
    let optional = |value: Option<f64>| value.map_or_else(String::new, short);
    let total = cell.skipped.clone().map_or_else(|| optional(cell.total_ms), |_| "skipped".into());
    let slowest = cell.phases.iter().map(|phase| phase.total_ms).reduce(f64::max);
    let ratios = record.ratios();
    let ratio = ratios.get(&cell.engine, &cell.work()).and_then(Ratio::value);
    let noisy = if cell.noisy { "*" } else { "" };
    [
        cell.kind.clone(),
        cell.engine.clone(),
        optional(cell.commit_ms),
        optional(cell.trace_ms),
        total + noisy,
        optional(slowest),
        optional(ratio),
        cell.skipped.clone().unwrap_or_else(|| cell.setting.clone()),
    ]
}
