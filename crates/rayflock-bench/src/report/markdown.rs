//! A record as Markdown: who is ahead by kind and triangles, then every cell.

use std::fmt::Write;

use super::figures::{count, factor, plural};
use super::heading::title;
use crate::ratio::{Ratios, Work, distinct};
use crate::record::Record;

/// The record as Markdown, ending in a line break.
pub fn markdown(record: &Record) -> String {
    let ratios = record.ratios();
    let mut text = introduction(record, &ratios);
    for engine in ratios.engines() {
        let summary = ratios.summary(engine, |_| true);
        let compared = plural(summary.ahead + summary.behind, "cell", "cells");
        let mean = summary.mean.map_or_else(|| "–".to_owned(), factor);
        put(
            &mut text,
            format_args!(
                "\n**{engine}** is {mean} times as fast as {} in the geometric mean of {compared}: \
             ahead in {}, behind in {}, skipped in {}.\n\n",
                ratios.opponent, summary.ahead, summary.behind, summary.skipped
            ),
        );
        put(&mut text, format_args!("{}", by_triangles(record, &ratios, engine)));
    }
    for engine in ratios.engines() {
        for kind in record.kinds() {
            put(&mut text, format_args!("\n{engine}, {kind}:\n\n"));
            put(&mut text, format_args!("{}", cells(record, &ratios, engine, kind)));
        }
    }
    text
}

/// Writing to a string cannot fail.
fn put(text: &mut String, what: std::fmt::Arguments<'_>) {
    let _ = text.write_fmt(what);
}

fn introduction(record: &Record, ratios: &Ratios<'_>) -> String {
    let (machine, (title, _)) = (&record.machine, title(record));
    let versions: Vec<String> =
        record.versions.iter().map(|(name, version)| format!("{name} {version}")).collect();
    let mut text = format!(
        "{title}, on {} ({} logical processors, {} kernels), {}; commit `{}`, {}.\n",
        escaped(&machine.cpu),
        machine.cores,
        machine.simd,
        record.date,
        record.commit,
        versions.join(", ")
    );
    if !ratios.entries.is_empty() {
        put(
            &mut text,
            format_args!(
                "Numbers are the total (commit and trace) of {} divided by that of the engine: above 1 \
             the engine is ahead.\nMeans are geometric; `~` marks noisy cells, `–` skipped ones.\n",
                ratios.opponent
            ),
        );
    }
    text
}

/// Per kind the mean, the least and the greatest ratio, by triangles.
fn by_triangles(record: &Record, ratios: &Ratios<'_>, engine: &str) -> String {
    let triangles = distinct(record.works().iter().map(|work| work.triangles));
    let head = triangles.iter().map(|&triangles| format!("T = {}", count(triangles as u64)));
    let mut rows = vec![head.chain(["all".to_owned()]).collect::<Vec<_>>()];
    let mut names = vec!["rays".to_owned()];
    for kind in record.kinds() {
        let summary = |wanted: &dyn Fn(&Work<'_>) -> bool| {
            let summary = ratios.summary(engine, |work| work.kind == kind && wanted(work));
            match (summary.mean, summary.least, summary.most) {
                (Some(mean), Some(least), Some(most)) => {
                    format!("**{}** ({}..{})", factor(mean), factor(least), factor(most))
                }
                _ => "–".to_owned(),
            }
        };
        let of_triangles =
            triangles.iter().map(|&triangles| summary(&|work| work.triangles == triangles));
        names.push(escaped(kind));
        rows.push(of_triangles.chain([summary(&|_| true)]).collect());
    }
    table(&names, &rows)
}

/// Triangles down, rays across.
fn cells(record: &Record, ratios: &Ratios<'_>, engine: &str, kind: &str) -> String {
    let works: Vec<Work<'_>> =
        record.works().into_iter().filter(|work| work.kind == kind).collect();
    let triangles = distinct(works.iter().map(|work| (work.scene, work.triangles, work.threads)));
    let rays = distinct(works.iter().map(|work| work.rays));
    let mut rows =
        vec![rays.iter().map(|&rays| format!("R = {}", count(rays))).collect::<Vec<_>>()];
    let mut names = vec!["triangles".to_owned()];
    for (scene, triangles, threads) in triangles {
        let cell = |&rays: &u64| {
            let work = Work { scene, kind, triangles, rays, threads };
            let Some(ratio) = ratios.get(engine, &work) else { return String::new() };
            let mark = if ratio.is_noisy() { " ~" } else { "" };
            ratio.value().map_or_else(|| "–".to_owned(), |value| factor(value) + mark)
        };
        names.push(count(triangles as u64));
        rows.push(rays.iter().map(cell).collect());
    }
    table(&names, &rows)
}

/// A table of which the first row is the heading; `names` is the first column.
fn table(names: &[String], rows: &[Vec<String>]) -> String {
    let mut text = String::new();
    for (idx, (name, row)) in names.iter().zip(rows).enumerate() {
        put(&mut text, format_args!("| {name} | {} |\n", row.join(" | ")));
        if idx == 0 {
            put(&mut text, format_args!("|---|{}\n", "---:|".repeat(row.len())));
        }
    }
    text
}

/// Text that neither ends a cell of a table nor begins a tag.
fn escaped(text: &str) -> String {
    text.replace('|', "\\|").replace('<', "&lt;")
}
