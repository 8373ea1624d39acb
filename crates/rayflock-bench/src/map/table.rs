//! A record of the map as text.

use std::collections::BTreeSet;
use std::fmt::Write;

use comfy_table::{CellAlignment, Table, presets};

use crate::notes::notes;
use crate::ratio::{Ratio, Ratios};
use crate::record::{Cell, Record};
use crate::text::{count, short};

/// The record for people: for each engine and kind of rays a table of how many times as fast as
/// the opponent it is, then what that says together. For a single engine, tables of milliseconds.
/// Ends in a line break.
pub fn format(record: &Record) -> String {
    let ratios = record.ratios();
    let mut text = String::new();
    if ratios.entries.is_empty() {
        for engine in record.engines() {
            add_tables(&mut text, record, engine, "milliseconds a frame", &milliseconds);
        }
    }
    let what = format!("times as fast as {}", ratios.opponent);
    for engine in ratios.engines() {
        let value = |cell: &Cell| times(&ratios, cell);
        add_tables(&mut text, record, engine, &what, &value);
        text.push_str(&summary(&ratios, engine));
    }
    text + &notes(record)
}

/// What the engines needed for one cell, in a line.
pub fn one_line(cells: &[Cell]) -> String {
    let Some(first) = cells.first() else { return String::new() };
    let (triangles, rays) = (count(first.triangles), count(first.rays as usize));
    let record = Record { cells: cells.to_vec(), ..Record::new("map") };
    let ratios = record.ratios();
    let entries = cells.iter().map(|cell| one_entry(&ratios, cell)).collect::<Vec<_>>();
    format!("{triangles} x {rays} {}: {}", first.kind, entries.join(", "))
}

fn one_entry(ratios: &Ratios<'_>, cell: &Cell) -> String {
    let engine = &cell.engine;
    let (Some(commit), Some(trace)) = (cell.commit_ms, cell.trace_ms) else {
        let reason = cell.skipped.as_deref().unwrap_or("not measured");
        return format!("{engine} skipped ({reason})");
    };
    let times = ratio_of(ratios, cell).and_then(Ratio::value);
    let times = times.map_or_else(String::new, |times| format!(" ({} x)", short(times)));
    let noisy = if cell.noisy { " noisy" } else { "" };
    format!("{engine} {} + {} ms{times}{noisy}", short(commit), short(trace))
}

/// A table for each kind of rays.
fn add_tables(
    text: &mut String,
    record: &Record,
    engine: &str,
    what: &str,
    value: &dyn Fn(&Cell) -> String,
) {
    for kind in record.kinds() {
        let cells: Vec<&Cell> = record
            .cells
            .iter()
            .filter(|cell| (cell.engine.as_str(), cell.kind.as_str()) == (engine, kind))
            .collect();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{kind}, {engine}: {what}\n{}\n", table(&cells, value));
    }
}

fn table(cells: &[&Cell], value: &dyn Fn(&Cell) -> String) -> Table {
    let triangles: BTreeSet<usize> = cells.iter().map(|cell| cell.triangles).collect();
    let rays: BTreeSet<u64> = cells.iter().map(|cell| cell.rays).collect();
    let mut table = Table::new();
    let counts = rays.iter().map(|&rays| format!("{} rays", count(rays as usize)));
    table.load_style(presets::NOTHING).set_header(std::iter::once(String::new()).chain(counts));
    for &triangles in &triangles {
        let entries = rays.iter().map(|&rays| {
            let found = cells.iter().find(|cell| (cell.triangles, cell.rays) == (triangles, rays));
            found.map_or_else(String::new, |cell| value(cell) + marks(cell))
        });
        table.add_row(std::iter::once(format!("{} triangles", count(triangles))).chain(entries));
    }
    for column in table.column_iter_mut() {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

fn milliseconds(cell: &Cell) -> String {
    cell.total_ms.map_or_else(|| "skipped".to_owned(), short)
}

fn times(ratios: &Ratios<'_>, cell: &Cell) -> String {
    let value = ratio_of(ratios, cell).and_then(Ratio::value);
    value.map_or_else(|| "skipped".to_owned(), short)
}

fn ratio_of<'a, 'b>(ratios: &'b Ratios<'a>, cell: &Cell) -> Option<&'b Ratio<'a>> {
    ratios.get(&cell.engine, &cell.work())
}

fn marks(cell: &Cell) -> &'static str {
    match (cell.noisy, cell.mismatches > 0) {
        (false, false) => "",
        (true, false) => "*",
        (false, true) => "!",
        (true, true) => "*!",
    }
}

fn summary(ratios: &Ratios<'_>, engine: &str) -> String {
    let summary = ratios.summary(engine, |_| true);
    let Some(mean) = summary.mean else { return format!("{engine}: skipped everywhere\n\n") };
    let opponent = ratios.opponent;
    format!(
        "{engine}: {} times as fast as {opponent} (geometric mean of {} cells); slower in {}, \
         skipped in {}\n\n",
        short(mean),
        summary.ahead + summary.behind,
        summary.behind,
        summary.skipped
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Judged;

    fn cell(engine: &str, triangles: usize, total_ms: Option<f64>) -> Cell {
        Cell {
            triangles,
            rays: 4096,
            kind: "mirror".to_owned(),
            engine: engine.to_owned(),
            commit_ms: total_ms.map(|_| 1.0),
            trace_ms: total_ms.map(|total| total - 1.0),
            total_ms,
            ..Cell::default()
        }
    }

    fn record(cells: Vec<Cell>) -> Record {
        Record { cells, ..Record::new("map") }
    }

    #[test]
    fn engines_are_compared_with_embree_and_losses_counted() {
        let mut cells = vec![
            cell("embree:best", 1024, Some(6.0)),
            cell("hierarchy", 1024, Some(3.0)),
            cell("embree:best", 4096, Some(8.0)),
            cell("hierarchy", 4096, Some(16.0)),
        ];
        cells[1].noisy = true;
        cells[3].mismatches = 5;
        cells[3].judged = Judged { rays: 5, only_this: 5, ..Judged::default() };
        let text = format(&record(cells));
        assert!(text.contains("mirror, hierarchy: times as fast as Embree"), "{text}");
        assert!(text.contains("2.00*") && text.contains("0.500!"), "{text}");
        assert!(text.contains("1.00 times as fast") && text.contains("slower in 1"), "{text}");
        assert!(text.contains("4K x 4K mirror, hierarchy: 5; of 5 judged"), "{text}");
    }

    #[test]
    fn a_single_engine_gets_milliseconds() {
        let text = format(&record(vec![cell("hierarchy", 1024, Some(3.0))]));
        assert!(text.contains("milliseconds a frame") && text.contains("3.00"), "{text}");
    }

    #[test]
    fn a_line_tells_times_ratio_and_reasons() {
        let mut cells = vec![cell("embree:best", 1024, Some(6.0)), cell("hierarchy", 1024, None)];
        cells[1].skipped = Some("too slow".to_owned());
        let expected = "1K x 4K mirror: embree:best 1.00 + 5.00 ms, hierarchy skipped (too slow)";
        assert_eq!(one_line(&cells), expected);
        cells[1] = cell("hierarchy", 1024, Some(3.0));
        assert!(one_line(&cells).ends_with("hierarchy 1.00 + 2.00 ms (2.00 x)"));
        assert_eq!(one_line(&[]), "");
    }
}
