//! How fast costs grow, as slopes in a log-log plot, and as text.

use std::collections::BTreeMap;
use std::fmt;

use comfy_table::{CellAlignment, Table, presets};

use crate::record::{Cell, Record};
use crate::text::{count, short};

/// Counts that make a line.
const LEAST_POINTS: usize = 3;

/// What varies along a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Against {
    /// Moving triangles.
    Triangles,
    /// Rays a frame.
    Rays,
    /// Threads.
    Threads,
}

/// How the cost of one engine and kind of rays grows.
#[derive(Clone, Debug, PartialEq)]
pub struct Slope {
    /// What varies.
    pub against: Against,
    /// The kind of rays.
    pub kind: String,
    /// The engine.
    pub engine: String,
    /// What varies, and the milliseconds a frame, from few to many.
    pub points: Vec<(usize, f64)>,
    /// The exponent of the growth of the whole cost.
    pub total: f64,
    /// That of tracing alone.
    pub trace: f64,
    /// That of committing alone.
    pub commit: f64,
}

impl Against {
    const ALL: [Self; 3] = [Self::Triangles, Self::Rays, Self::Threads];

    /// What varies, and what must be the same along a line.
    fn split(self, cell: &Cell) -> (usize, [usize; 2]) {
        let [triangles, rays, threads] = [cell.triangles, cell.rays as usize, cell.threads];
        match self {
            Self::Triangles => (triangles, [rays, threads]),
            Self::Rays => (rays, [triangles, threads]),
            Self::Threads => (threads, [triangles, rays]),
        }
    }
}

impl fmt::Display for Against {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Triangles => "triangles",
            Self::Rays => "rays",
            Self::Threads => "threads",
        })
    }
}

/// All lines of at least three cells in which only one count varies.
pub fn slopes(record: &Record) -> Vec<Slope> {
    let mut slopes = Vec::new();
    for against in Against::ALL {
        let mut lines: BTreeMap<_, BTreeMap<usize, &Cell>> = BTreeMap::new();
        for cell in record.cells.iter().filter(|cell| cell.total_ms.is_some()) {
            let (varies, fixed) = against.split(cell);
            let line = lines.entry((&cell.kind, &cell.engine, fixed)).or_default();
            line.insert(varies, cell);
        }
        let long = lines.into_values().filter(|line| line.len() >= LEAST_POINTS);
        slopes.extend(long.map(|line| slope_of(against, &line)));
    }
    slopes
}

fn slope_of(against: Against, line: &BTreeMap<usize, &Cell>) -> Slope {
    let fit = |value: fn(&Cell) -> Option<f64>| {
        fit(line.iter().filter_map(|(&varies, cell)| Some((varies as f64, value(cell)?))))
    };
    let name = |value: fn(&Cell) -> &String| {
        line.values().next().map_or_else(String::new, |cell| value(cell).clone())
    };
    let points = line.iter().map(|(&varies, cell)| (varies, cell.total_ms.unwrap_or_default()));
    Slope {
        against,
        kind: name(|cell| &cell.kind),
        engine: name(|cell| &cell.engine),
        points: points.collect(),
        total: fit(|cell| cell.total_ms),
        trace: fit(|cell| cell.trace_ms),
        commit: fit(|cell| cell.commit_ms),
    }
}

/// The slope of the straight line that lies nearest to the logarithms of the points, by least
/// squares; 0 where the points do not tell.
fn fit(points: impl Iterator<Item = (f64, f64)>) -> f64 {
    let positive = points.filter(|&(x, y)| x > 0.0 && y > 0.0);
    let logs: Vec<(f64, f64)> = positive.map(|(x, y)| (x.ln(), y.ln())).collect();
    let mean = |value: fn(&(f64, f64)) -> f64| {
        logs.iter().map(value).sum::<f64>() / logs.len().max(1) as f64
    };
    let (x_mean, y_mean) = (mean(|point| point.0), mean(|point| point.1));
    let covariance: f64 = logs.iter().map(|(x, y)| (x - x_mean) * (y - y_mean)).sum();
    let variance: f64 = logs.iter().map(|(x, _)| (x - x_mean).powi(2)).sum();
    if variance > 0.0 { covariance / variance } else { 0.0 }
}

/// The slopes for people, a table for each count that varies, ending in a line break.
pub fn format(record: &Record) -> String {
    let slopes = slopes(record);
    let tables = Against::ALL.into_iter().filter_map(|against| {
        let of: Vec<&Slope> = slopes.iter().filter(|slope| slope.against == against).collect();
        (!of.is_empty()).then(|| {
            format!(
                "against {against}: milliseconds a frame, and slopes of their logarithms\n{}\n",
                table(&of)
            )
        })
    });
    tables.collect::<Vec<_>>().join("\n")
}

fn table(slopes: &[&Slope]) -> Table {
    let mut counts: Vec<usize> =
        slopes.iter().flat_map(|slope| slope.points.iter().map(|point| point.0)).collect();
    counts.sort_unstable();
    counts.dedup();
    let mut table = Table::new();
    let names = ["kind", "engine"].map(str::to_owned).into_iter();
    let header = names.chain(counts.iter().map(|&value| count(value)));
    let header = header.chain(["commit", "trace", "total"].map(|name| format!("{name} slope")));
    table.load_style(presets::NOTHING).set_header(header);
    for slope in slopes {
        let at = |wanted: &usize| {
            let point = slope.points.iter().find(|(varies, _)| varies == wanted);
            point.map_or_else(String::new, |&(_, ms)| short(ms))
        };
        let names = [slope.kind.clone(), slope.engine.clone()].into_iter();
        let exponents = [slope.commit, slope.trace, slope.total].map(|slope| format!("{slope:.2}"));
        table.add_row(names.chain(counts.iter().map(at)).chain(exponents));
    }
    for column in table.column_iter_mut().skip(2) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(cells: impl IntoIterator<Item = (usize, u64, usize, f64)>) -> Record {
        let cells = cells.into_iter().map(|(triangles, rays, threads, ms)| Cell {
            triangles,
            rays,
            threads,
            kind: "primary".to_owned(),
            engine: "brute".to_owned(),
            commit_ms: Some(1.0),
            trace_ms: Some(ms),
            total_ms: Some(ms),
            ..Cell::default()
        });
        Record { cells: cells.collect(), ..Record::new("scaling") }
    }

    #[test]
    fn powers_are_found_where_only_one_count_varies() {
        let more_triangles = [1, 4, 16].map(|n| (n, 64, 2, 3.0 * (n as f64).powf(0.75)));
        let more_threads = [1, 2, 4].map(|n| (4, 64, n, 8.0 / n as f64));
        let slopes = slopes(&record(more_triangles.into_iter().chain(more_threads)));
        let found: Vec<_> = slopes.iter().map(|slope| slope.against).collect();
        assert_eq!(found, [Against::Triangles, Against::Threads], "two points make no line");
        assert!((slopes[0].total - 0.75).abs() < 1e-9 && slopes[0].commit == 0.0);
        assert!((slopes[1].trace + 1.0).abs() < 1e-9);
        assert_eq!(slopes[0].points[0], (1, 3.0));
    }

    #[test]
    fn skipped_cells_are_no_points() {
        let mut record = record([1, 2, 3, 4].map(|n| (n, 64, 2, n as f64)));
        record.cells[0].total_ms = None;
        assert_eq!(slopes(&record)[0].points.len(), 3);
        record.cells[1].total_ms = None;
        assert!(slopes(&record).is_empty());
        assert_eq!(format(&record), "");
    }

    #[test]
    fn the_text_has_a_row_for_each_line() {
        let text = format(&record([1024, 4096, 16384].map(|n| (n, 64, 2, n as f64 / 1024.0))));
        assert!(text.contains("against triangles") && text.contains("16K"), "{text}");
        assert!(text.contains("16.0") && text.contains("1.00"), "{text}");
    }
}
