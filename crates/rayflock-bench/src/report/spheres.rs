//! The sections of indirect light past spheres: error against speed, and every way to see.

use maud::{Markup, html};

use super::chart::{self, Chart, Scale, Series};
use super::figures::{factor, milliseconds};
use super::times;
use crate::BenchError;
use crate::record::{Cell, Record};

/// All sections.
pub(super) fn sections(record: &Record) -> Result<Markup, BenchError> {
    Ok(html! {
        section {
            h2 { "Error against speed" }
            p.note { "A dot is a number of spheres, fewer to the right as a rule. Speed is that of "
                     "fitting and gathering together, over gathering with the first exact way; "
                     "errors are those of whole pictures against its." }
            (chart(record)?)
        }
        section { h2 { "Every way to see" } (table(record)) }
        (times::settings(record))
    })
}

fn chart(record: &Record) -> Result<Markup, BenchError> {
    let curve = |label: &str, color_idx| {
        let spheres = record.cells.iter().filter(|cell| cell.engine.starts_with("spheres:"));
        let point = |cell: &Cell| Some((speed(record, cell)?, *cell.facts.get(label)?));
        let mut points: Vec<(f64, f64)> = spheres.filter_map(point).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Series { label: label.to_owned(), color_idx, dashed: false, points }
    };
    Chart {
        title: "Mean FLIP and relative RMSE by times faster",
        x_label: "times faster",
        y_label: "error",
        x_text: factor,
        scale: Scale::Linear,
        series: vec![curve("mean FLIP", 0), curve("relative RMSE", 1)],
        size: chart::SIZE,
    }
    .draw()
}

fn speed(record: &Record, cell: &Cell) -> Option<f64> {
    Some(record.cells.first()?.total_ms? / cell.total_ms?)
}

fn table(record: &Record) -> Markup {
    let time = |value: Option<f64>| value.map_or_else(String::new, milliseconds);
    let fact = |cell: &Cell, name: &str| {
        cell.facts.get(name).map_or_else(String::new, |value| format!("{value:.4}"))
    };
    html! {
        div.scroll { table {
            thead { tr {
                th { "visibility" } th { "fit ms" } th { "gather ms" } th { "total ms" }
                th { "times faster" } th { "mean FLIP" } th { "relative RMSE" }
            } }
            tbody { @for cell in &record.cells { tr {
                th { (cell.engine) }
                td.number { (time(cell.commit_ms)) }
                td.number { (time(cell.trace_ms)) }
                td.number { (time(cell.total_ms)) }
                td.number { (speed(record, cell).map_or_else(String::new, factor)) }
                td.number { (fact(cell, "mean FLIP")) }
                td.number { (fact(cell, "relative RMSE")) }
            } } }
        } }
    }
}
