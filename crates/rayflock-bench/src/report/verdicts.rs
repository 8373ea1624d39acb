//! Rays that engines answered differently, and who is right.

use maud::{Markup, html};

use super::figures::{count, grouped};
use crate::record::{Cell, Judged, Record};

/// What was compared, by engine, then the cells with mismatches.
pub(super) fn section(record: &Record) -> Markup {
    let differing: Vec<&Cell> = record.cells.iter().filter(|cell| cell.mismatches > 0).collect();
    html! {
        section {
            h2 { "Answers" }
            p.note { "Hits of every engine are compared with the reference. Those that differ by "
                     "more than the stated tolerance are shown to an oracle, which decides in "
                     "arithmetic of its own which answer is right." }
            (table(record.engines().into_iter().map(|engine| {
                (engine.to_owned(), total(record.cells.iter().filter(|cell| cell.engine == engine)))
            }), "engine"))
            @if !differing.is_empty() {
                details {
                    summary { (grouped(differing.len() as u64)) " cells with mismatches" }
                    (table(differing.iter().map(|&cell| (name(cell), total([cell].into_iter()))), "cell"))
                }
            }
        }
    }
}

/// Rays, mismatches and verdicts.
type Verdict = (u64, u64, Judged);

fn total<'a>(cells: impl Iterator<Item = &'a Cell>) -> Verdict {
    cells.filter(|cell| cell.skipped.is_none()).fold((0, 0, Judged::default()), |sum, cell| {
        let (a, b) = (sum.2, cell.judged);
        let judged = Judged {
            rays: a.rays + b.rays,
            both_right: a.both_right + b.both_right,
            only_this: a.only_this + b.only_this,
            only_reference: a.only_reference + b.only_reference,
            neither: a.neither + b.neither,
        };
        let rays: u64 = cell.phases.iter().map(|phase| phase.rays).sum();
        (sum.0 + rays, sum.1 + cell.mismatches, judged)
    })
}

fn name(cell: &Cell) -> String {
    let (triangles, rays) = (count(cell.triangles as u64), count(cell.rays));
    format!("{}: {}, {triangles} triangles, {rays} rays", cell.engine, cell.kind)
}

fn table(rows: impl Iterator<Item = (String, Verdict)>, heading: &str) -> Markup {
    html! {
        div.scroll { table.figures {
            thead { tr {
                th { (heading) } th.number { "rays" } th.number { "differ" }
                th.number { "judged" } th.number { "both right" } th.number { "only this right" }
                th.number { "only reference right" } th.number { "neither" }
            } }
            tbody {
                @for (name, (rays, mismatches, judged)) in rows {
                    tr {
                        td { (name) }
                        @for number in [rays, mismatches, judged.rays, judged.both_right,
                                        judged.only_this, judged.only_reference, judged.neither] {
                            td.number { (grouped(number)) }
                        }
                    }
                }
            }
        } }
    }
}
