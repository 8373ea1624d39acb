//! What engines counted, for each ray.

use maud::{Markup, html};

use super::figures::{bytes, count, factor};
use crate::record::{Cell, Counters, Record};

/// A table for each engine that counts, folded up; nothing where none does.
pub(super) fn section(record: &Record) -> Markup {
    let counted = |cell: &&Cell| {
        let Counters { cone_tests, box_tests, triangle_tests, bytes, .. } = cell.counters;
        cone_tests + box_tests + triangle_tests + bytes > 0
    };
    let mut engines = record.engines();
    engines.retain(|engine| record.cells.iter().filter(counted).any(|c| c.engine == *engine));
    html! {
        @if !engines.is_empty() {
            section {
                h2 { "Counters" }
                p.note { "Tests are counted in SIMD lanes, the idle ones included. Allocations are "
                         "those of a frame in the steady state, where they were counted." }
                @for engine in engines {
                    details {
                        summary { (engine) ", for each ray" }
                        (table(record.cells.iter().filter(counted).filter(|c| c.engine == engine)))
                        (facts(record.cells.iter().filter(|c| c.engine == engine)))
                    }
                }
            }
        }
    }
}

fn table<'a>(cells: impl Iterator<Item = &'a Cell>) -> Markup {
    html! {
        div.scroll { table.figures {
            thead { tr {
                th { "rays" } th.number { "triangles" } th.number { "rays" }
                th.number { "cone tests" } th.number { "box tests" } th.number { "triangle tests" }
                th.number { "tiles" } th.number { "pairs" } th.number { "bytes" } th.number { "allocations a frame" }
                th.number { "memory" }
            } }
            tbody { @for cell in cells { (row(cell)) } }
        } }
    }
}

/// What an engine tells about what it holds: a line a cell, nothing where it tells nothing.
fn facts<'a>(cells: impl Iterator<Item = &'a Cell>) -> Markup {
    let cells: Vec<&Cell> = cells.filter(|cell| !cell.facts.is_empty()).collect();
    html! {
        @if !cells.is_empty() {
            ul { @for cell in cells {
                li {
                    (cell.kind) ", " (count(cell.triangles as u64)) " triangles: "
                    @for (idx, (name, value)) in cell.facts.iter().enumerate() {
                        @if idx > 0 { ", " }
                        (factor(*value)) " " (name)
                    }
                }
            } }
        }
    }
}

fn row(cell: &Cell) -> Markup {
    let counters = &cell.counters;
    let per_ray = |number: u64| factor(number as f64 / cell.rays.max(1) as f64);
    let allocations = counters.allocations.map_or_else(|| "–".to_owned(), count);
    html! {
        tr {
            td { (cell.kind) } td.number { (count(cell.triangles as u64)) }
            td.number { (count(cell.rays)) }
            @for number in [counters.cone_tests, counters.box_tests, counters.triangle_tests,
                            counters.tiles, counters.pairs, counters.bytes] {
                td.number { (per_ray(number)) }
            }
            td.number { (allocations) } td.number { (bytes(cell.memory_bytes)) }
        }
    }
}
