//! The sections of the map: who is ahead, then in every cell, then the figures behind it.

use maud::{Markup, html};

use super::figures::{factor, plural};
use super::{counters, heat, times, verdicts};
use crate::ratio::{Ratios, Summary};
use crate::record::Record;

/// All sections.
pub(super) fn sections(record: &Record) -> Markup {
    let ratios = record.ratios();
    html! {
        (overview(record, &ratios))
        @for engine in ratios.engines() { (heat_tables(record, &ratios, engine)) }
        (times::settings(record))
        (times::section(record, &ratios))
        (verdicts::section(record))
        (counters::section(record))
    }
}

/// The result in a few words, then by kind.
pub(super) fn overview(record: &Record, ratios: &Ratios<'_>) -> Markup {
    html! {
        section {
            h2 { "Who is ahead" }
            @if ratios.entries.is_empty() {
                p { "There is nothing to compare: only one engine was measured." }
            } @else {
                div.cards {
                    @for engine in ratios.engines() {
                        (card(engine, ratios.opponent, &ratios.summary(engine, |_| true)))
                    }
                }
                (how_to_read(ratios.opponent))
                (by_kind(record, ratios))
            }
        }
    }
}

fn card(engine: &str, opponent: &str, summary: &Summary) -> Markup {
    let compared = summary.ahead + summary.behind;
    html! {
        div.card {
            p.name { (engine) }
            @if let (Some(mean), Some(least), Some(most)) = (summary.mean, summary.least, summary.most) {
                p.big { (factor(mean)) "×" }
                @if compared == 1 {
                    p { "as fast as " (opponent) }
                } @else {
                    p { "as fast as " (opponent) " in the geometric mean of "
                        (plural(compared, "cell", "cells")) }
                    p.muted { "ahead in " (summary.ahead) ", behind in " (summary.behind)
                        @if summary.skipped > 0 { ", skipped in " (summary.skipped) }
                        "; from " (factor(least)) "× to " (factor(most)) "×" }
                }
            } @else {
                p.big { "–" }
                p { "skipped in " (plural(summary.skipped, "cell", "cells")) }
            }
        }
    }
}

/// What a ratio says, in words.
fn how_to_read(opponent: &str) -> Markup {
    html! {
        p.note {
            "A ratio is the total of " (opponent)
            @if opponent == "Embree" { ", in the best setting that was measured," }
            " divided by that of the engine; the total of a frame is to commit its geometry and to "
            "trace its rays. " strong { "Above 1 the engine is ahead" } ": 2 means that it needs "
            "half the time, 0.5 twice the time."
        }
    }
}

/// A row for each engine and kind.
fn by_kind(record: &Record, ratios: &Ratios<'_>) -> Markup {
    html! {
        div.scroll { table.figures {
            thead { tr {
                th { "engine" } th { "rays" } th.number { "geometric mean" } th.number { "least" }
                th.number { "most" } th.number { "ahead" } th.number { "behind" }
                th.number { "skipped" }
            } }
            tbody {
                @for engine in ratios.engines() {
                    @for kind in record.kinds() {
                        (summary_row(engine, kind, &ratios.summary(engine, |work| work.kind == kind)))
                    }
                }
            }
        } }
    }
}

fn summary_row(engine: &str, kind: &str, summary: &Summary) -> Markup {
    if *summary == Summary::default() {
        return Markup::default();
    }
    let optional = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), factor);
    html! {
        tr {
            td { (engine) } td { (kind) }
            td.number { strong { (optional(summary.mean)) } }
            td.number { (optional(summary.least)) } td.number { (optional(summary.most)) }
            td.number { (summary.ahead) } td.number { (summary.behind) }
            td.number { (summary.skipped) }
        }
    }
}

fn heat_tables(record: &Record, ratios: &Ratios<'_>, engine: &str) -> Markup {
    html! {
        section {
            h2 { (engine) " against " (ratios.opponent) }
            (heat::legend(ratios.opponent))
            div.heats {
                @for kind in record.kinds() { (heat::table(record, ratios, engine, kind)) }
            }
        }
    }
}
