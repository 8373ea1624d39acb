//! Milliseconds of every cell and engine, and Embree's settings behind its figures.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use maud::{Markup, html};

use super::figures::{count, factor, milliseconds, percent};
use crate::ratio::{Ratio, Ratios, Work, distinct};
use crate::record::{Cell, Record};

/// Which settings gave the figures: how often each, then cell by cell; nothing where no engine has
/// settings.
pub(super) fn settings(record: &Record) -> Markup {
    let mut chosen: BTreeMap<(&str, &str), Vec<&Cell>> = BTreeMap::new();
    for cell in record.cells.iter().filter(|cell| !cell.setting.is_empty()) {
        chosen.entry((&cell.engine, &cell.setting)).or_default().push(cell);
    }
    let mut chosen: Vec<_> = chosen.into_iter().collect();
    chosen.sort_by_key(|(_, cells)| Reverse(cells.len()));
    let engines = distinct(chosen.iter().map(|((engine, _), _)| *engine));
    html! {
        @if !chosen.is_empty() {
            section {
                h2 { "The settings behind the figures" }
                (setting_counts(&chosen))
                @if record.benchmark == "map" {
                    @for engine in engines {
                        details {
                            summary { (engine) ", cell by cell" }
                            div.heats {
                                @for kind in record.kinds() { (setting_table(record, engine, kind)) }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn setting_counts(chosen: &[((&str, &str), Vec<&Cell>)]) -> Markup {
    html! {
        div.scroll { table.figures {
            thead { tr {
                th { "engine" } th { "setting" } th.number { "cells" } th { "rays" }
                th { "triangles" }
            } }
            tbody {
                @for ((engine, setting), cells) in chosen {
                    tr {
                        td { (engine) } td { code { (setting) } }
                        td.number { (cells.len()) }
                        td { (list(cells.iter().map(|cell| cell.kind.clone()))) }
                        td { (list(cells.iter().map(|cell| count(cell.triangles as u64)))) }
                    }
                }
            }
        } }
    }
}

/// Triangles down, rays across, the words of a setting in each cell.
fn setting_table(record: &Record, engine: &str, kind: &str) -> Markup {
    let cells = record
        .cells
        .iter()
        .filter(|cell| (cell.engine.as_str(), cell.kind.as_str()) == (engine, kind));
    let cells: Vec<&Cell> = cells.collect();
    let triangles = distinct(cells.iter().map(|cell| cell.triangles));
    let rays = distinct(cells.iter().map(|cell| cell.rays));
    let find = |triangles, rays| {
        cells.iter().find(|cell| (cell.triangles, cell.rays) == (triangles, rays))
    };
    html! {
        figure.heat {
            figcaption { (kind) }
            table.words {
                thead { tr {
                    td.corner { span.down { "T" } span.across { "R" } }
                    @for &rays in &rays { th scope="col" { (count(rays)) } }
                } }
                tbody { @for &triangles in &triangles { tr {
                    th scope="row" { (count(triangles as u64)) }
                    @for &rays in &rays { td.none {
                        @if let Some(cell) = find(triangles, rays) {
                            @for word in cell.setting.split('+') { span { (word) } }
                        }
                    } }
                } } }
            }
        }
    }
}

fn list(words: impl Iterator<Item = String>) -> String {
    distinct(words).join(", ")
}

/// A table for each kind and scene, folded up.
pub(super) fn section(record: &Record, ratios: &Ratios<'_>) -> Markup {
    let groups = distinct(record.works().iter().map(|work| (work.scene, work.kind)));
    html! {
        section {
            h2 { "Milliseconds" }
            p.note { "Commit and trace of a frame, both together, and the distance of the outer "
                     "quartiles as a share of the median." }
            @for (scene, kind) in groups {
                details {
                    summary { (kind) @if record.benchmark != "map" { ", " (scene) } }
                    (table(record, ratios, scene, kind))
                }
            }
        }
    }
}

fn table(record: &Record, ratios: &Ratios<'_>, scene: &str, kind: &str) -> Markup {
    let works = record.works().into_iter().filter(|work| (work.scene, work.kind) == (scene, kind));
    html! {
        div.scroll { table.figures {
            thead { tr {
                th.number { "triangles" } th.number { "rays" } th.number { "threads" }
                th { "engine" } th.number { "commit" } th.number { "trace" } th.number { "total" }
                th.number { "spread" } th.number { "ratio" } th { "setting" }
            } }
            @for work in works {
                tbody {
                    @for (idx, cell) in record.cells.iter().filter(|cell| cell.work() == work).enumerate() {
                        (row(ratios, &work, cell, idx == 0))
                    }
                }
            }
        } }
    }
}

fn row(ratios: &Ratios<'_>, work: &Work<'_>, cell: &Cell, is_first: bool) -> Markup {
    let optional = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), milliseconds);
    let ratio = ratios.get(&cell.engine, work).and_then(Ratio::value);
    html! {
        tr {
            @if is_first {
                td.number { (count(work.triangles as u64)) } td.number { (count(cell.rays)) }
                td.number { (work.threads) }
            } @else { td { } td { } td { } }
            td { (cell.engine) }
            td.number { (optional(cell.commit_ms)) } td.number { (optional(cell.trace_ms)) }
            td.number { strong { (optional(cell.total_ms)) } }
            td.number.noisy[cell.noisy] {
                (percent(cell.spread))
                @if cell.noisy { span.mark { "~" } }
            }
            td.number { (ratio.map_or_else(String::new, factor)) }
            td {
                @match &cell.skipped {
                    Some(reason) => { span.muted { "skipped: " (reason) } }
                    None => { code { (cell.setting) } }
                }
            }
        }
    }
}
