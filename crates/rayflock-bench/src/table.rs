//! A record of pictures as text: a row for each frame and engine, a row for the mean of each
//! engine, and a few lines on what they say together.

use std::fmt::Write;

use comfy_table::{CellAlignment, Table, presets};

use crate::record::{Cell, Counters, Phase, Record};

const HEADER: [&str; 9] = [
    "frame",
    "engine",
    "update ms",
    "trace ms",
    "shade ms",
    "total ms",
    "quartiles",
    "triangle tests/ray",
    "cone tests/ray",
];

/// The record for people, ending in a line break.
pub fn format(record: &Record) -> String {
    let Some(first) = record.cells.first() else { return String::new() };
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(HEADER);
    for idx in 0..first.phases.len() {
        let phases = record.cells.iter().filter_map(|cell| Some((cell, cell.phases.get(idx)?)));
        table.add_rows(phases.map(|(cell, phase)| phase_row(cell, phase)));
    }
    table.add_rows(record.cells.iter().map(mean_row));
    for column in table.column_iter_mut() {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let table = table.trim_fmt();
    format!("{}\n\n{table}\n\n{}", title(record, first), summary(record, first))
}

fn title(record: &Record, first: &Cell) -> String {
    let Cell { scene, threads, triangles, .. } = first;
    format!("{scene}: {triangles} triangles, {threads} threads, {}", record.machine.simd)
}

fn phase_row(cell: &Cell, phase: &Phase) -> [String; 9] {
    let [lower, upper] = phase.total_quartiles_ms.map(milliseconds);
    let [triangle_tests, cone_tests] = per_ray(&phase.counters, phase.rays);
    [
        phase.frame.map_or_else(|| phase.name.clone(), |frame| frame.to_string()),
        cell.engine.clone(),
        milliseconds(phase.commit_ms),
        milliseconds(phase.trace_ms),
        phase.shade_ms.map_or_else(String::new, milliseconds),
        milliseconds(phase.total_ms),
        format!("{lower}..{upper}"),
        triangle_tests,
        cone_tests,
    ]
}

fn mean_row(cell: &Cell) -> [String; 9] {
    let [triangle_tests, cone_tests] = per_ray(&cell.counters, cell.rays);
    let optional = |value: Option<f64>| value.map_or_else(String::new, milliseconds);
    [
        "mean".to_owned(),
        cell.engine.clone(),
        optional(cell.commit_ms),
        optional(cell.trace_ms),
        String::new(),
        optional(cell.total_ms),
        format!("spread {:.0}%", 100.0 * cell.spread),
        triangle_tests,
        cone_tests,
    ]
}

fn per_ray(counters: &Counters, rays: u64) -> [String; 2] {
    [counters.triangle_tests, counters.cone_tests]
        .map(|tests| format!("{:.1}", tests as f64 / rays.max(1) as f64))
}

/// Two digits behind the point while they say something.
fn milliseconds(value: f64) -> String {
    if value < 100.0 { format!("{value:.2}") } else { format!("{value:.0}") }
}

fn summary(record: &Record, first: &Cell) -> String {
    let mut text = String::new();
    for cell in record.cells.iter().skip(1) {
        let (engine, than) = (&cell.engine, &first.engine);
        let (Some(total), Some(first_total)) = (cell.total_ms, first.total_ms) else { continue };
        let ratio = if total > 0.0 { first_total / total } else { 1.0 };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{engine} is {ratio:.1} times as fast as {than}");
    }
    for cell in record.cells.iter().skip(1) {
        let _ = writeln!(text, "{}", films(cell, first));
    }
    text
}

fn films(cell: &Cell, first: &Cell) -> String {
    let engines = format!("films of {} and {}", first.engine, cell.engine);
    match cell.mismatches {
        0 => format!("{engines}: the same in every bit"),
        count => format!("{engines}: {count} PIXELS DIFFER"),
    }
}
