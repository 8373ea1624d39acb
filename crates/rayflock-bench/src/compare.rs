//! What has changed between two records: cells of the same engine on the same work.
//!
//! A change is the new total divided by the old: **below 1 the new one is faster**. Two runs are
//! comparable only where machine and work are the same; elsewhere the ratios to Embree within
//! each run are, so their change is told too.

mod text;

use crate::ratio::{Ratio, geometric_mean};
use crate::record::{Cell, Record};

/// Two records and the cells they share.
#[derive(Clone, Debug)]
pub struct Comparison<'a> {
    /// The cells present in both, in the order of the new record.
    pub pairs: Vec<Pair<'a>>,
    /// Why the two can be compared with care only.
    pub warnings: Vec<String>,
    /// Cells of the old record that the new one lacks.
    pub only_old: usize,
    /// Cells of the new record that the old one lacks.
    pub only_new: usize,
    /// What ratios are to: `Embree` or the name of an engine.
    pub opponent: &'a str,
}

/// The same work by the same engine in both records.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a> {
    /// The old cell.
    pub old: &'a Cell,
    /// The new one.
    pub new: &'a Cell,
    /// The old and the new ratio of the opponent's total to this engine's; `None` for the
    /// opponent.
    pub ratios: Option<[f64; 2]>,
}

impl<'a> Comparison<'a> {
    /// Finds what two records share.
    pub fn new(old: &'a Record, new: &'a Record) -> Self {
        let (old_ratios, new_ratios) = (old.ratios(), new.ratios());
        let pairs = new.cells.iter().filter_map(|new_cell| {
            let work = new_cell.work();
            let old_cell = old.cell(&new_cell.engine, &work)?;
            let value = |ratio: Option<&Ratio<'_>>| ratio.and_then(Ratio::value);
            let before = value(old_ratios.get(&new_cell.engine, &work));
            let after = value(new_ratios.get(&new_cell.engine, &work));
            let same_opponent = old_ratios.opponent == new_ratios.opponent;
            let ratios = before.zip(after).filter(|_| same_opponent);
            Some(Pair { old: old_cell, new: new_cell, ratios: ratios.map(|(a, b)| [a, b]) })
        });
        let pairs: Vec<Pair<'a>> = pairs.collect();
        Self {
            only_old: old.cells.len().saturating_sub(pairs.len()),
            only_new: new.cells.len() - pairs.len(),
            warnings: warnings(old, new),
            opponent: new_ratios.opponent,
            pairs,
        }
    }

    /// Geometric mean of the changes of `engine` for `kind`, and of the changes of its ratio to
    /// the opponent.
    pub fn means(&self, engine: &str, kind: &str) -> [Option<f64>; 2] {
        let pairs = self
            .pairs
            .iter()
            .filter(|pair| (pair.new.engine.as_str(), pair.new.kind.as_str()) == (engine, kind));
        let (changes, ratios): (Vec<_>, Vec<_>) =
            pairs.map(|pair| (pair.change(), pair.ratio_change())).unzip();
        [changes, ratios]
            .map(|values| geometric_mean(&values.into_iter().flatten().collect::<Vec<f64>>()))
    }
}

impl Pair<'_> {
    /// The new total over the old one; `None` where one of them was skipped.
    pub fn change(&self) -> Option<f64> {
        let (old, new) = (self.old.total_ms?, self.new.total_ms?);
        (old > 0.0 && new > 0.0).then(|| new / old)
    }

    /// The new ratio to the opponent over the old one: above 1 the engine has gained on it.
    pub fn ratio_change(&self) -> Option<f64> {
        self.ratios.map(|[old, new]| new / old)
    }

    /// Whether the totals lie further apart than their spreads explain: the ranges of half a
    /// spread around each do not meet.
    pub fn is_beyond_spread(&self) -> bool {
        let (Some(old), Some(new)) = (self.old.total_ms, self.new.total_ms) else { return false };
        let reach = 0.5 * (old * self.old.spread + new * self.new.spread);
        (new - old).abs() > reach
    }
}

/// What makes the comparison of times doubtful.
fn warnings(old: &Record, new: &Record) -> Vec<String> {
    let mut warnings = Vec::new();
    let mut differ = |what: &str, old: &str, new: &str| {
        if old != new {
            warnings.push(format!("{what} differ: \"{old}\" and \"{new}\""));
        }
    };
    differ("benchmarks", &old.benchmark, &new.benchmark);
    differ("machines", &old.machine.class(), &new.machine.class());
    let names = old.versions.keys().chain(new.versions.keys());
    for name in names.collect::<std::collections::BTreeSet<_>>() {
        let version = |record: &Record| record.versions.get(name).cloned().unwrap_or_default();
        differ(&format!("versions of {name}"), &version(old), &version(new));
    }
    if old.definition != new.definition {
        warnings.push("the definitions of the work differ".to_owned());
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(engine: &str, triangles: usize, total_ms: f64, spread: f64) -> Cell {
        let (engine, kind) = (engine.to_owned(), "primary".to_owned());
        Cell { engine, kind, triangles, total_ms: Some(total_ms), spread, ..Cell::default() }
    }

    fn record(cells: Vec<Cell>) -> Record {
        Record { cells, ..Record::new("map") }
    }

    #[test]
    fn cells_of_both_are_compared_and_the_others_counted() {
        let old = record(vec![
            cell("hierarchy", 1, 4.0, 0.0),
            cell("embree", 1, 2.0, 0.0),
            cell("hierarchy", 2, 4.0, 0.0),
            cell("hierarchy", 3, 9.0, 0.0),
        ]);
        let new = record(vec![
            cell("hierarchy", 1, 2.0, 0.0),
            cell("embree", 1, 4.0, 0.0),
            cell("hierarchy", 2, 2.0, 0.0),
            cell("hierarchy", 4, 1.0, 0.0),
        ]);
        let comparison = Comparison::new(&old, &new);
        assert_eq!((comparison.pairs.len(), comparison.only_old, comparison.only_new), (3, 1, 1));
        assert_eq!(comparison.pairs[0].change(), Some(0.5));
        assert_eq!(comparison.pairs[0].ratios, Some([0.5, 2.0]));
        assert_eq!(comparison.pairs[1].ratios, None, "the opponent itself");
        assert_eq!(comparison.pairs[2].ratios, None, "Embree was not measured at two triangles");
        let [change, ratio_change] = comparison.means("hierarchy", "primary");
        assert!(
            (change.unwrap() - 0.5).abs() < 1e-12 && (ratio_change.unwrap() - 4.0).abs() < 1e-12
        );
    }

    #[test]
    fn a_change_within_the_spread_is_told_from_one_beyond() {
        let pair = |old: &Cell, new: &Cell| Pair { old, new, ratios: None }.is_beyond_spread();
        let old = cell("hierarchy", 1, 10.0, 0.2);
        assert!(!pair(&old, &cell("hierarchy", 1, 11.0, 0.1)), "9..11 meets 10.45..11.55");
        assert!(pair(&old, &cell("hierarchy", 1, 12.0, 0.1)), "9..11 and 11.4..12.6");
        let skipped = Cell { total_ms: None, ..old.clone() };
        assert!(!pair(&old, &skipped));
    }

    #[test]
    fn other_machines_versions_and_definitions_are_warned_of() {
        let old = record(Vec::new());
        assert!(Comparison::new(&old, &old).warnings.is_empty());
        let mut new = old.clone();
        new.machine.cores += 1;
        new.definition = Some("other".to_owned());
        new.versions.insert("embree".to_owned(), "4.4.0".to_owned());
        let warnings = Comparison::new(&old, &new).warnings.join("\n");
        for expected in
            ["machines differ", "versions of embree differ: \"\" and \"4.4.0\"", "definitions"]
        {
            assert!(warnings.contains(expected), "{warnings}");
        }
    }
}
