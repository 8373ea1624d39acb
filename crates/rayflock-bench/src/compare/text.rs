//! A comparison as text.

use std::fmt::Write;

use comfy_table::{CellAlignment, Table, presets};

use super::{Comparison, Pair};
use crate::ratio::distinct;
use crate::text::{count, short};

/// How many of the best and of the worst changes are told.
const EXTREMES: usize = 10;

impl Comparison<'_> {
    /// The comparison for people, ending in a line break.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for warning in &self.warnings {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "warning: {warning}");
        }
        if self.warnings.iter().any(|warning| !warning.contains("rayflock")) {
            let _ = writeln!(
                text,
                "Times of the two can hardly be compared; the change of the ratio to {} can.",
                self.opponent
            );
        }
        if self.pairs.is_empty() {
            let _ = writeln!(text, "The two records have no cell in common.");
            return text;
        }
        let _ = write!(
            text,
            "{} cells in both, {} only in the old record, {} only in the new one.\n\
             Change is the new total over the old: below 1 the new one is faster.\n\n{}\n",
            self.pairs.len(),
            self.only_old,
            self.only_new,
            self.means_table()
        );
        let (faster, slower) = self.extremes();
        for (title, pairs) in [("Most gained", faster), ("Most lost", slower)] {
            if !pairs.is_empty() {
                let _ = write!(
                    text,
                    "\n{title} (* beyond the spread):\n\n{}\n",
                    self.pair_table(&pairs)
                );
            }
        }
        let _ = write!(text, "\nAll cells:\n\n{}\n", self.pair_table(&self.pairs));
        text
    }

    /// The pairs with the least and with the greatest changes, on the right side of 1.
    fn extremes(&self) -> (Vec<Pair<'_>>, Vec<Pair<'_>>) {
        let mut sorted: Vec<_> =
            self.pairs.iter().filter_map(|pair| Some((pair.change()?, *pair))).collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let faster = sorted.iter().filter(|(change, _)| *change < 1.0).take(EXTREMES);
        let slower = sorted.iter().rev().filter(|(change, _)| *change > 1.0).take(EXTREMES);
        (faster.map(|(_, pair)| *pair).collect(), slower.map(|(_, pair)| *pair).collect())
    }

    fn means_table(&self) -> String {
        let groups = distinct(
            self.pairs.iter().map(|pair| (pair.new.engine.as_str(), pair.new.kind.as_str())),
        );
        let rows = groups.into_iter().map(|(engine, kind)| {
            let [change, ratio_change] = self.means(engine, kind).map(optional);
            vec![engine.to_owned(), kind.to_owned(), change, ratio_change]
        });
        let against = format!("ratio to {}", self.opponent);
        format_table(&["engine", "rays", "mean change", &against], rows, 2)
    }

    fn pair_table(&self, pairs: &[Pair<'_>]) -> String {
        let rows = pairs.iter().map(|pair| {
            let (old, new) = (pair.old, pair.new);
            let mark = if pair.is_beyond_spread() { "*" } else { "" };
            let ratios = pair
                .ratios
                .map_or_else(String::new, |[old, new]| format!("{} -> {}", short(old), short(new)));
            let total = |total: Option<f64>| total.map_or_else(|| "skipped".to_owned(), short);
            vec![
                new.engine.clone(),
                new.kind.clone(),
                new.scene.clone(),
                count(new.triangles),
                count(new.rays as usize),
                total(old.total_ms),
                total(new.total_ms),
                optional(pair.change()) + mark,
                ratios,
            ]
        });
        let against = format!("ratio to {}", self.opponent);
        let header = ["engine", "rays", "scene", "T", "R", "old ms", "new ms", "change", &against];
        format_table(&header, rows, 3)
    }
}

fn optional(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), short)
}

/// A table whose first `word_count` columns are words, the others numbers.
fn format_table(
    header: &[&str],
    rows: impl Iterator<Item = Vec<String>>,
    word_count: usize,
) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(header.to_vec());
    table.add_rows(rows);
    for column in table.column_iter_mut().skip(word_count) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table.trim_fmt()
}
