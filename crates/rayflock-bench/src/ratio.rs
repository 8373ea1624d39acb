//! How many times as fast as the opponent, cell by cell and in the mean.
//!
//! The ratio of a cell is the opponent's total divided by that of the engine: **above 1 the engine
//! is ahead**, 2 means that it needs half the time. The opponent is Embree with the least total on
//! the same work; in a record without Embree it is the record's first engine. Means of ratios are
//! geometric, so that twice as fast and half as fast cancel out.

mod summary;
mod work;

use crate::record::{Cell, Record};

pub use summary::{Summary, geometric_mean};
pub(crate) use work::PICTURE;
pub use work::Work;

/// What names of Embree's engines begin with.
const EMBREE: &str = "embree";

/// An engine and its opponent on the same work.
#[derive(Clone, Copy, Debug)]
pub struct Ratio<'a> {
    /// The engine.
    pub ours: &'a Cell,
    /// Its opponent.
    pub theirs: &'a Cell,
}

/// The ratios of a record, in the order of its cells.
#[derive(Clone, Debug)]
pub struct Ratios<'a> {
    /// The opponent in words: `Embree` or the name of an engine.
    pub opponent: &'a str,
    /// One entry for each cell whose work the opponent was given too, without the opponent's own.
    pub entries: Vec<Ratio<'a>>,
}

impl Ratio<'_> {
    /// The opponent's total over that of the engine; `None` where one of them was skipped.
    pub fn value(&self) -> Option<f64> {
        let (ours, theirs) = (self.ours.total_ms?, self.theirs.total_ms?);
        (ours > 0.0 && theirs > 0.0).then(|| theirs / ours)
    }

    /// Whether one of the two was too noisy to say much.
    pub fn is_noisy(&self) -> bool {
        self.ours.noisy || self.theirs.noisy
    }
}

impl Record {
    /// What every engine is compared with, and how it comes off.
    pub fn ratios(&self) -> Ratios<'_> {
        let is_opponent = self.opponent();
        let opponent = match self.cells.iter().find(|cell| is_opponent(cell)) {
            Some(cell) if cell.is_embree() => "Embree",
            Some(cell) => &cell.engine,
            None => "",
        };
        let challengers = self.cells.iter().filter(|cell| !is_opponent(cell));
        let entries = challengers.filter_map(|ours| {
            let same_work = |cell: &&Cell| is_opponent(cell) && cell.work() == ours.work();
            let total = |cell: &Cell| cell.total_ms.unwrap_or(f64::INFINITY);
            let theirs = self.cells.iter().filter(same_work);
            let theirs = theirs.min_by(|a, b| total(a).total_cmp(&total(b)))?;
            Some(Ratio { ours, theirs })
        });
        Ratios { opponent, entries: entries.collect() }
    }

    /// Tells the cells of the opponent.
    fn opponent(&self) -> impl Fn(&Cell) -> bool {
        let has_embree = self.cells.iter().any(Cell::is_embree);
        let first = self.cells.first().map(|cell| cell.engine.clone()).unwrap_or_default();
        move |cell| if has_embree { cell.is_embree() } else { cell.engine == first }
    }
}

impl Cell {
    /// Whether Embree was measured, in any setting.
    pub fn is_embree(&self) -> bool {
        self.engine.split(':').next() == Some(EMBREE)
    }
}

impl<'a> Ratios<'a> {
    /// The engines that are compared with the opponent, in the order of the record.
    pub fn engines(&self) -> Vec<&'a str> {
        distinct(self.entries.iter().map(|ratio| ratio.ours.engine.as_str()))
    }

    /// The entry of `engine` for `work`.
    pub fn get(&self, engine: &str, work: &Work<'_>) -> Option<&Ratio<'a>> {
        let is_it = |ratio: &&Ratio<'_>| ratio.ours.engine == engine && ratio.ours.work() == *work;
        self.entries.iter().find(is_it)
    }

    /// Means and extremes of the ratios of `engine` on all work that `wanted` accepts.
    pub fn summary(&self, engine: &str, wanted: impl Fn(&Work<'_>) -> bool) -> Summary {
        let entries = self.entries.iter().filter(|ratio| ratio.ours.engine == engine);
        let entries = entries.filter(|ratio| wanted(&ratio.ours.work()));
        Summary::of(entries.map(Ratio::value))
    }
}

/// The different ones among `values`, in the order of their first appearance.
pub(crate) fn distinct<T: PartialEq>(values: impl Iterator<Item = T>) -> Vec<T> {
    let mut found = Vec::new();
    for value in values {
        if !found.contains(&value) {
            found.push(value);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(engine: &str, triangles: usize, total_ms: Option<f64>) -> Cell {
        let engine = engine.to_owned();
        Cell { engine, triangles, total_ms, kind: "primary".to_owned(), ..Cell::default() }
    }

    fn record(cells: Vec<Cell>) -> Record {
        Record { cells, ..Record::new("map") }
    }

    #[test]
    fn the_opponent_is_the_best_embree_on_the_same_work() {
        let record = record(vec![
            cell("hierarchy", 1, Some(2.0)),
            cell("hierarchy", 2, Some(8.0)),
            cell("hierarchy", 3, Some(1.0)),
            cell("embree:low", 1, Some(9.0)),
            cell("embree:best", 1, Some(3.0)),
            cell("embree:low", 2, Some(4.0)),
            cell("embree:best", 2, None),
        ]);
        let ratios = record.ratios();
        assert_eq!((ratios.opponent, ratios.engines()), ("Embree", vec!["hierarchy"]));
        let values: Vec<_> = ratios.entries.iter().map(Ratio::value).collect();
        assert_eq!(values, [Some(1.5), Some(0.5)], "nothing to compare at three triangles");
    }

    #[test]
    fn without_embree_the_first_engine_is_the_opponent() {
        let record = record(vec![cell("brute", 1, Some(6.0)), cell("hierarchy", 1, Some(2.0))]);
        let ratios = record.ratios();
        assert_eq!((ratios.opponent, ratios.engines()), ("brute", vec!["hierarchy"]));
        assert_eq!(ratios.entries[0].value(), Some(3.0));
    }

    #[test]
    fn skipped_cells_have_no_ratio_and_do_not_count_in_the_mean() {
        let record = record(vec![
            cell("embree", 1, Some(8.0)),
            cell("hierarchy", 1, Some(1.0)),
            cell("embree", 2, Some(1.0)),
            cell("hierarchy", 2, Some(2.0)),
            cell("embree", 3, Some(1.0)),
            cell("hierarchy", 3, None),
        ]);
        let ratios = record.ratios();
        let summary = ratios.summary("hierarchy", |_| true);
        assert_eq!((summary.ahead, summary.behind, summary.skipped), (1, 1, 1));
        assert!((summary.mean.unwrap() - 2.0).abs() < 1e-12);
        assert_eq!((summary.least, summary.most), (Some(0.5), Some(8.0)));
        assert_eq!(ratios.summary("hierarchy", |work| work.triangles == 3).mean, None);
    }

    #[test]
    fn a_record_of_nothing_has_no_ratios() {
        let record = record(Vec::new());
        let ratios = record.ratios();
        assert_eq!((ratios.opponent, ratios.entries.len()), ("", 0));
    }
}
