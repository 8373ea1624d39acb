//! The sections of the museum: curves over the frames, means, films.
//!
//! **Source.** The figure of Khanna, Mortensen, Yu and Slater, "A Visibility Field for Ray
//! Tracing", CGIV 2007: update time stays level and low while render time follows the picture.

use maud::{Markup, html};

use super::chart::{self, Chart, Scale, Series};
use super::figures::{factor, grouped, milliseconds};
use super::{counters, map, times};
use crate::BenchError;
use crate::record::{Cell, Phase, Record};

/// All sections.
pub(super) fn sections(record: &Record) -> Result<Markup, BenchError> {
    let ratios = record.ratios();
    let render =
        curves(record, "Trace and shade", |phase| phase.trace_ms + phase.shade_ms.unwrap_or(0.0))?;
    let update = curves(record, "Update", |phase| phase.commit_ms)?;
    let together = paper(record)?;
    Ok(html! {
        section {
            h2 { "Frame by frame" }
            (together)
            div.charts { (update) (render) }
        }
        section {
            h2 { "Means over the frames" }
            p.note { "Variation is the standard deviation of the frames' updates, share is the "
                     "update's part of the picture's time." }
            (means(record))
        }
        (map::overview(record, &ratios))
        (times::settings(record))
        section {
            h2 { "Films" }
            p.note { "The films of our own engines have to be the same in every bit. Those of other "
                     "engines differ in the pixels where rays graze edges." }
            (films(record))
        }
        (counters::section(record))
    })
}

/// Update and render time of every engine in one chart.
fn paper(record: &Record) -> Result<Markup, BenchError> {
    let series = record.cells.iter().enumerate().flat_map(|(color_idx, cell)| {
        let engine = &cell.engine;
        let render = |phase: &Phase| phase.trace_ms + phase.shade_ms.unwrap_or(0.0);
        let render = curve(cell, format!("{engine}: trace and shade"), color_idx, false, render);
        let update = curve(cell, format!("{engine}: update"), color_idx, true, |p| p.commit_ms);
        [render, update]
    });
    let title = "Update and picture, milliseconds a frame";
    Chart { size: (1180, 440), ..chart(title, series.collect()) }.draw()
}

fn curves(record: &Record, title: &str, time: fn(&Phase) -> f64) -> Result<Markup, BenchError> {
    let cells = record.cells.iter().enumerate();
    let series = cells.map(|(idx, cell)| curve(cell, cell.engine.clone(), idx, false, time));
    chart(&format!("{title}, milliseconds a frame"), series.collect()).draw()
}

fn chart(title: &str, series: Vec<Series>) -> Chart<'_> {
    let x_text = |frame: f64| format!("{frame:.0}");
    let (x_label, y_label) = ("frame", "ms");
    Chart { title, x_label, y_label, x_text, scale: Scale::Linear, series, size: chart::SIZE }
}

fn curve(
    cell: &Cell,
    label: String,
    color_idx: usize,
    dashed: bool,
    time: impl Fn(&Phase) -> f64,
) -> Series {
    let frame = |idx: usize, phase: &Phase| phase.frame.map_or(idx as f64, f64::from);
    let points = cell.phases.iter().enumerate();
    let points = points.map(|(idx, phase)| (frame(idx, phase), time(phase))).collect();
    Series { label, color_idx, dashed, points }
}

fn means(record: &Record) -> Markup {
    html! {
        div.scroll { table.figures {
            thead { tr {
                th { "engine" } th { "setting" } th.number { "update ms" }
                th.number { "variation" } th.number { "share" } th.number { "trace ms" }
                th.number { "shade ms" } th.number { "frames a second" } th.number { "rays a frame" }
            } }
            tbody { @for cell in &record.cells { (mean_row(cell)) } }
        } }
    }
}

fn mean_row(cell: &Cell) -> Markup {
    let optional = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), milliseconds);
    let percent = |share: Option<f64>| {
        share.map_or_else(|| "–".to_owned(), |share| format!("{:.0} %", 100.0 * share))
    };
    html! {
        tr {
            td { (cell.engine) } td { code { (cell.setting) } }
            td.number { (optional(cell.commit_ms)) }
            td.number { (percent(cell.update_variation())) }
            td.number { (percent(cell.update_share())) }
            td.number { (optional(cell.trace_ms)) }
            td.number { (optional(cell.shade_ms())) }
            td.number { strong { (cell.frames_per_second().map_or_else(|| "–".to_owned(), factor)) } }
            td.number { (grouped(cell.rays)) }
        }
    }
}

fn films(record: &Record) -> Markup {
    html! {
        ul { @for cell in &record.cells {
            li {
                (cell.engine) ": "
                @match cell.mismatches {
                    0 => { "the reference, or the same in every bit" }
                    count => { (grouped(count)) " pixels differ from the reference, over "
                               (cell.phases.len()) " frames" }
                }
            }
        } }
    }
}
