//! The sections of scaling: the cost of a frame against triangles, rays and threads, with slopes.

use maud::{Markup, html};

use super::chart::{self, Chart, Scale, Series};
use super::figures::count;
use super::{counters, map, times, verdicts};
use crate::BenchError;
use crate::ratio::distinct;
use crate::record::Record;
use crate::scaling::{Slope, slopes};

/// All sections.
pub(super) fn sections(record: &Record) -> Result<Markup, BenchError> {
    let ratios = record.ratios();
    let slopes = slopes(record);
    let charts = distinct(slopes.iter().map(|slope| (slope.against, slope.kind.as_str())));
    let charts = charts.into_iter().map(|(against, kind)| {
        let lines =
            slopes.iter().filter(|slope| (slope.against, slope.kind.as_str()) == (against, kind));
        draw(record, &format!("{kind}: total against {against}"), &against.to_string(), lines)
    });
    let charts = charts.collect::<Result<Vec<Markup>, BenchError>>()?;
    Ok(html! {
        section {
            h2 { "How the cost grows" }
            @if slopes.is_empty() {
                p { "No line has three points." }
            } @else {
                p.note { "Totals of a frame; both axes are logarithmic. A slope of 1 is growth in "
                         "proportion, 0 is none; for threads, −1 is perfect use of them." }
                div.charts { @for chart in charts { (chart) } }
                (table(&slopes))
            }
        }
        (map::overview(record, &ratios))
        (times::section(record, &ratios))
        (verdicts::section(record))
        (counters::section(record))
    })
}

fn draw<'a>(
    record: &Record,
    title: &str,
    x_label: &str,
    lines: impl Iterator<Item = &'a Slope>,
) -> Result<Markup, BenchError> {
    let engines = record.engines();
    let series = lines.map(|line| Series {
        label: format!("{}, slope {:.2}", line.engine, line.total),
        color_idx: engines.iter().position(|engine| *engine == line.engine).unwrap_or(0),
        dashed: false,
        points: line.points.iter().map(|&(value, ms)| (value as f64, ms)).collect(),
    });
    Chart {
        title,
        x_label,
        y_label: "ms",
        x_text: |value| count(value.round() as u64),
        scale: Scale::Logarithmic,
        series: series.collect(),
        size: chart::SIZE,
    }
    .draw()
}

fn table(slopes: &[Slope]) -> Markup {
    html! {
        div.scroll { table.figures {
            thead { tr {
                th { "slope against" } th { "rays" } th { "engine" }
                th.number { "commit" } th.number { "trace" } th.number { "total" }
            } }
            tbody {
                @for slope in slopes {
                    tr {
                        td { (slope.against) } td { (slope.kind) } td { (slope.engine) }
                        @for exponent in [slope.commit, slope.trace, slope.total] {
                            td.number { (format!("{exponent:.2}")) }
                        }
                    }
                }
            }
        } }
    }
}
