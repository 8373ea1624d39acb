//! The sections of a scene: a bar for each kind of rays and engine.

use maud::{Markup, html};

use super::figures::{factor, milliseconds};
use super::{counters, map, times, verdicts};
use crate::ratio::{Ratio, Ratios, Work};
use crate::record::{Cell, Record};

/// All sections.
pub(super) fn sections(record: &Record) -> Markup {
    let ratios = record.ratios();
    html! {
        (map::overview(record, &ratios))
        section {
            h2 { "Milliseconds a frame" }
            p.note { span.bar.commit.sample { } " commit " span.bar.trace.sample { } " trace; means over the frames." }
            div.bars { @for work in record.works() { (bars(record, &ratios, &work)) } }
        }
        (times::settings(record))
        (times::section(record, &ratios))
        (verdicts::section(record))
        (counters::section(record))
    }
}

/// The bars of all engines for one kind, as long as the slowest's is wide.
fn bars(record: &Record, ratios: &Ratios<'_>, work: &Work<'_>) -> Markup {
    let cells: Vec<&Cell> = record.cells.iter().filter(|cell| cell.work() == *work).collect();
    let longest = cells.iter().filter_map(|cell| cell.total_ms).fold(0.0, f64::max);
    html! {
        figure {
            figcaption { (work.kind) }
            @for cell in cells {
                div.engine {
                    span.name { (cell.engine) }
                    span.track {
                        @if let (Some(commit), Some(trace)) = (cell.commit_ms, cell.trace_ms) {
                            span.bar.commit style=(width(commit, longest)) { }
                            span.bar.trace style=(width(trace, longest)) { }
                        } @else {
                            span.reason { (cell.skipped.as_deref().unwrap_or("not measured")) }
                        }
                    }
                    span.value { (value(cell)) }
                    span.times { (ratio(ratios, cell, work)) }
                }
            }
        }
    }
}

fn width(time: f64, longest: f64) -> String {
    format!("width:{:.2}%", 100.0 * time / longest.max(f64::MIN_POSITIVE))
}

fn value(cell: &Cell) -> String {
    match cell.total_ms {
        Some(total) => format!("{} ms{}", milliseconds(total), if cell.noisy { " ~" } else { "" }),
        None => "skipped".to_owned(),
    }
}

fn ratio(ratios: &Ratios<'_>, cell: &Cell, work: &Work<'_>) -> String {
    let ratio = ratios.get(&cell.engine, work).and_then(Ratio::value);
    ratio.map_or_else(String::new, |ratio| format!("{}×", factor(ratio)))
}
