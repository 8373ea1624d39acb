//! A record as text: a row for each frame and engine, a row for the mean of each engine, and a
//! few lines on what they say together.

use std::fmt::Write;

use comfy_table::{CellAlignment, Table, presets};

use crate::scene::record::{Cell, Phase, Record};

const HEADER: [&str; 9] = [
    "frame",
    "engine",
    "update ms",
    "trace ms",
    "total ms",
    "quartiles",
    "ratio",
    "triangle tests/ray",
    "cone tests/ray",
];

/// The record for people, ending in a line break.
pub fn format(record: &Record) -> String {
    let Some(first) = record.cells.first() else { return String::new() };
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(HEADER);
    for idx in 0..first.phases.len() {
        table.add_rows(record.cells.iter().map(|cell| phase_row(cell, &cell.phases[idx])));
    }
    table.add_rows(record.cells.iter().map(mean_row));
    for column in table.column_iter_mut() {
        column.set_cell_alignment(CellAlignment::Right);
    }
    let table = table.trim_fmt();
    format!("{}\n\n{table}\n\n{}", title(record, first), summary(record, first))
}

fn title(record: &Record, first: &Cell) -> String {
    let Cell { scene, size: [width, height], threads, triangles, .. } = first;
    let (runs, simd) = (record.run_count, record.machine.simd);
    format!(
        "{scene}: {triangles} triangles, {width}x{height}, {threads} threads, {simd}, {runs} runs"
    )
}

fn phase_row(cell: &Cell, phase: &Phase) -> [String; 9] {
    let [lower, upper] = phase.total_quartiles_ms.map(milliseconds);
    let per_ray = |tests: u64| format!("{:.1}", tests as f64 / phase.rays.max(1) as f64);
    [
        phase.frame.to_string(),
        cell.engine.to_owned(),
        milliseconds(phase.commit_ms),
        milliseconds(phase.trace_ms),
        milliseconds(phase.total_ms),
        format!("{lower}..{upper}"),
        format!("{:.4}", phase.ratio),
        per_ray(phase.triangle_tests),
        per_ray(phase.cone_tests),
    ]
}

fn mean_row(cell: &Cell) -> [String; 9] {
    [
        "mean".to_owned(),
        cell.engine.to_owned(),
        milliseconds(cell.commit_ms),
        milliseconds(cell.trace_ms),
        milliseconds(cell.total_ms),
        format!("spread {:.0}%", 100.0 * cell.spread),
        format!("{:.4}", cell.ratio),
        format!("{:.1}", cell.triangle_tests_per_ray),
        format!("{:.1}", cell.cone_tests_per_ray),
    ]
}

/// Two digits behind the point while they say something.
fn milliseconds(value: f64) -> String {
    if value < 100.0 { format!("{value:.2}") } else { format!("{value:.0}") }
}

fn summary(record: &Record, first: &Cell) -> String {
    let mut text = String::new();
    for cell in &record.cells {
        let (engine, rays, kinds) = (cell.engine, cell.rays, cell.rays_by_kind);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{engine}: {rays:.0} rays a frame: {:.0} primary, {:.0} shadow, {:.0} mirror, {:.0} \
             refraction",
            kinds.primary, kinds.shadow, kinds.mirror, kinds.refraction
        );
    }
    for cell in record.cells.iter().skip(1).filter(|cell| cell.ratio > 0.0) {
        let (engine, ratio, than) = (cell.engine, cell.ratio, first.engine);
        let _ = writeln!(
            text,
            "{engine} takes {ratio:.4} of the time of {than}: {:.1} times as fast",
            1.0 / ratio
        );
    }
    for cell in record.cells.iter().skip(1) {
        let _ = writeln!(text, "{}", films(cell, first));
    }
    text
}

fn films(cell: &Cell, first: &Cell) -> String {
    let engines = format!("films of {} and {}", first.engine, cell.engine);
    match cell.differing_pixels {
        0 => format!("{engines}: the same in every bit"),
        count => format!("{engines}: {count} PIXELS DIFFER"),
    }
}
