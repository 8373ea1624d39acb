//! A record as text. Of pictures: a row for each frame and engine, a row for the mean of each
//! engine, and a few lines on what they say together.

use std::fmt::Write;

use comfy_table::{CellAlignment, Table, presets};

use crate::record::{Cell, Counters, Phase, Record};
use crate::text::short;
use crate::{map, scaling, spheres};

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

/// The record for people, each benchmark in its own way, ending in a line break.
pub fn format(record: &Record) -> String {
    match record.benchmark.as_str() {
        "museum" => pictures(record),
        "scaling" => scaling::format(record),
        "spheres" => spheres::format(record),
        _ => map::format(record),
    }
}

fn pictures(record: &Record) -> String {
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
    format!("{}\n\n{table}\n\n{}", title(record, first), summary(record))
}

fn title(record: &Record, first: &Cell) -> String {
    let Cell { scene, threads, triangles, .. } = first;
    format!("{scene}: {triangles} triangles, {threads} threads, {}", record.machine.simd)
}

fn phase_row(cell: &Cell, phase: &Phase) -> [String; 9] {
    let [lower, upper] = phase.total_quartiles_ms.map(short);
    let [triangle_tests, cone_tests] = per_ray(&phase.counters, phase.rays);
    [
        phase.frame.map_or_else(|| phase.name.clone(), |frame| frame.to_string()),
        cell.engine.clone(),
        short(phase.commit_ms),
        short(phase.trace_ms),
        phase.shade_ms.map_or_else(String::new, short),
        short(phase.total_ms),
        format!("{lower}..{upper}"),
        triangle_tests,
        cone_tests,
    ]
}

fn mean_row(cell: &Cell) -> [String; 9] {
    let [triangle_tests, cone_tests] = per_ray(&cell.counters, cell.rays);
    let optional = |value: Option<f64>| value.map_or_else(String::new, short);
    [
        "mean".to_owned(),
        cell.engine.clone(),
        optional(cell.commit_ms),
        optional(cell.trace_ms),
        optional(cell.shade_ms()),
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

fn summary(record: &Record) -> String {
    let mut text = String::new();
    let ratios = record.ratios();
    for cell in &record.cells {
        let setting = if cell.setting.is_empty() { "" } else { " with " };
        let (engine, rate) = (&cell.engine, cell.frames_per_second().unwrap_or_default());
        // Writing to a string cannot fail.
        let _ =
            writeln!(text, "{engine}{setting}{}: {} frames a second", cell.setting, short(rate));
        if let (Some(share), Some(variation)) = (cell.update_share(), cell.update_variation()) {
            let [share, variation] = [share, variation].map(|part| 100.0 * part);
            let _ = writeln!(
                text,
                "updates of {engine}: {share:.1} % of the frame, varying by {variation:.0} %"
            );
        }
    }
    for ratio in &ratios.entries {
        let (engine, than) = (&ratio.ours.engine, &ratio.theirs.engine);
        let Some(value) = ratio.value() else { continue };
        let value = short(value);
        let _ = writeln!(text, "{engine} updates and traces {value} times as fast as {than}");
    }
    for cell in &record.cells {
        let _ = writeln!(text, "{}", film(cell));
    }
    text
}

fn film(cell: &Cell) -> String {
    let (engine, frames) = (&cell.engine, cell.phases.len());
    match cell.mismatches {
        0 => format!("films of {engine}: the same in every bit as the first of ours"),
        count => format!("films of {engine}: {count} PIXELS DIFFER over {frames} frames"),
    }
}
