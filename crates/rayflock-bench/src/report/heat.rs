//! Heat tables: a kind of rays, triangles down, rays across, in each cell a ratio and its colour.

use maud::{Markup, html};

use super::color;
use super::figures::{count, factor, milliseconds, percent};
use crate::contest::NOISY;
use crate::ratio::{Ratio, Ratios, Work, distinct};
use crate::record::{Cell, Record};

/// The heat table of one engine and one kind, with geometric means at the right and below.
pub(super) fn table(record: &Record, ratios: &Ratios<'_>, engine: &str, kind: &str) -> Markup {
    let works: Vec<Work<'_>> =
        record.works().into_iter().filter(|work| work.kind == kind).collect();
    let triangles = distinct(works.iter().map(|work| work.triangles));
    let rays = distinct(works.iter().map(|work| work.rays));
    let mean = |wanted: &dyn Fn(&Work<'_>) -> bool| {
        mean_cell(ratios.summary(engine, |work| work.kind == kind && wanted(work)).mean)
    };
    html! {
        figure.heat {
            figcaption { (kind) }
            table {
                thead {
                    tr {
                        td.corner { span.down { "T" } span.across { "R" } }
                        @for &rays in &rays { th scope="col" { (count(rays)) } }
                        th.mean scope="col" { "mean" }
                    }
                }
                tbody {
                    @for &triangles in &triangles {
                        tr {
                            th scope="row" { (count(triangles as u64)) }
                            @for &rays in &rays {
                                @let work = works.iter().find(|w| (w.triangles, w.rays) == (triangles, rays));
                                (cell(work.and_then(|work| ratios.get(engine, work))))
                            }
                            (mean(&|work| work.triangles == triangles))
                        }
                    }
                    tr.mean {
                        th scope="row" { "mean" }
                        @for &rays in &rays { (mean(&|work| work.rays == rays)) }
                        (mean(&|_| true))
                    }
                }
            }
        }
    }
}

fn cell(ratio: Option<&Ratio<'_>>) -> Markup {
    let Some(ratio) = ratio else {
        return html! { td.none title="not measured" { } };
    };
    let title = title(ratio);
    match ratio.value() {
        Some(value) => html! {
            td.ratio.noisy[ratio.is_noisy()] style=(color::style(value)) title=(title) {
                (factor(value))
                @if ratio.is_noisy() { span.mark { "~" } }
            }
        },
        None => html! { td.skipped title=(title) { "–" } },
    }
}

fn mean_cell(mean: Option<f64>) -> Markup {
    html! {
        @match mean {
            Some(mean) => { td.mean { (factor(mean)) } }
            None => { td.mean { "–" } }
        }
    }
}

/// What the pointer shows over a cell: both sides in figures.
fn title(ratio: &Ratio<'_>) -> String {
    let Work { triangles, rays, kind, .. } = ratio.ours.work();
    let (triangles, rays) = (count(triangles as u64), count(rays));
    format!(
        "{kind}, {triangles} triangles, {rays} rays\n{}\n{}",
        side(ratio.ours),
        side(ratio.theirs)
    )
}

/// One engine's figures, or why there are none.
fn side(cell: &Cell) -> String {
    let name = match cell.setting.as_str() {
        "" => cell.engine.clone(),
        setting => format!("{} ({setting})", cell.engine),
    };
    let (Some(commit), Some(trace), Some(total)) = (cell.commit_ms, cell.trace_ms, cell.total_ms)
    else {
        return format!(
            "{name}: skipped, {}",
            cell.skipped.as_deref().unwrap_or("for no stated reason")
        );
    };
    let [commit, trace, total] = [commit, trace, total].map(milliseconds);
    format!("{name}: commit {commit} + trace {trace} = {total} ms, spread {}", percent(cell.spread))
}

/// What the colours and marks of heat tables mean.
pub(super) fn legend(opponent: &str) -> Markup {
    let steps = [1.0 / 16.0, 0.25, 0.5, 1.0, 2.0, 4.0, 16.0];
    html! {
        div.legend {
            span { "behind " (opponent) }
            span.scale {
                @for step in steps {
                    span.step style=(color::style(step)) { (short(step)) }
                }
            }
            span { "ahead" }
            span.marks {
                span { "T triangles, R rays a frame; means are geometric" }
                span { span.mark { "~" } " noisy: quartiles more than "
                       (percent(NOISY)) " of the median apart" }
                span { span.swatch.skipped { "–" } " skipped" }
            }
        }
    }
}

fn short(step: f64) -> String {
    if step < 1.0 { format!("1/{}", (1.0 / step).round()) } else { format!("{step}") }
}
