//! What surrounds the sections of every page.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::heading::{heading, title};
use crate::record::Record;

/// The style sheet, part of the page.
const STYLE: &str = include_str!("page.css");

/// The whole page around its `content`.
pub(super) fn page(record: &Record, content: &Markup) -> Markup {
    let (title, _) = title(record);
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { "Rayflock: " (title) ", " (day(&record.date)) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                main {
                    (heading(record))
                    (content)
                    (definition(record))
                }
                footer {
                    p {
                        "Times are wall-clock milliseconds, medians over rounds in which the "
                        "engines take turns. Figures of one run are comparable with each other; "
                        "those of two runs only as ratios."
                    }
                }
            }
        }
    }
}

fn definition(record: &Record) -> Markup {
    html! {
        @if let Some(text) = &record.definition {
            section {
                h2 { "The work" }
                details {
                    summary { "The definition that was measured" }
                    pre { (text) }
                }
            }
        }
    }
}

fn day(date: &str) -> &str {
    date.split('T').next().unwrap_or(date)
}
