//! How cost grows: with triangles, with rays, with threads.
//!
//! For each kind of rays one count varies and the others stay: triangles from few to many under
//! a fixed number of rays, rays over a fixed number of triangles, and threads with both fixed.
//! How a cost grows is the slope of a straight line through its logarithm over that of the count,
//! by least squares: 1 for a cost in proportion, 0 for one that stays, -1 for threads that all
//! help.
//!
//! The work is that of the [map](crate::map).

mod slopes;

use rayon::ThreadPoolBuilder;

use crate::BenchError;
use crate::contest::{Contest, Course, Setup, Watch};
use crate::map::MapWork;
use crate::record::Record;
use crate::work::Definition;

pub use slopes::{Against, Slope, format, slopes};

/// What is measured, and how.
#[derive(Clone, Debug)]
pub struct ScalingBench {
    /// The work, with the triangles, rays and kinds to measure.
    pub definition: Definition,
    /// Triangles while something else varies.
    pub fixed_triangles: usize,
    /// Rays while something else varies.
    pub fixed_rays: usize,
    /// Numbers of threads; the last one is that of the other measurements.
    pub threads: Vec<usize>,
    /// Who takes part, and how.
    pub setup: Setup,
}

/// Triangles, rays and threads of one cell of each kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Point {
    triangles: usize,
    threads: usize,
    rays: usize,
}

/// Measures on thread pools of its own. Stopped, it ends with the cells that are whole.
///
/// # Errors
/// [`BenchError`] when there is nothing to measure, or engines or threads cannot be had.
pub fn measure(bench: &ScalingBench, watch: &mut dyn Watch) -> Result<Record, BenchError> {
    let mut record = bench.setup.record("scaling");
    record.definition = Some(bench.definition.text().to_owned());
    let points = bench.points()?;
    let sizes = points.iter().map(|point| (point.triangles, point.rays));
    let mut course = Course::new(sizes.flat_map(|size| vec![size; bench.definition.kinds.len()]));
    // Engines are made anew with each number of triangles and threads.
    for group in points.chunk_by(|a, b| (a.triangles, a.threads) == (b.triangles, b.threads)) {
        let pool = ThreadPoolBuilder::new().num_threads(group[0].threads).build()?;
        let is_whole =
            pool.install(|| bench.measure_group(group, &mut course, &mut record, watch))?;
        if !is_whole {
            break;
        }
    }
    Ok(record)
}

impl ScalingBench {
    /// Number of cells.
    ///
    /// # Errors
    /// [`BenchError::Nothing`] when there is nothing to measure.
    pub fn cell_count(&self) -> Result<usize, BenchError> {
        Ok(self.points()?.len() * self.definition.kinds.len())
    }

    /// All points, each once, sorted.
    fn points(&self) -> Result<Vec<Point>, BenchError> {
        let Some(&all_threads) = self.threads.last() else {
            return Err(BenchError::Nothing("threads"));
        };
        if self.definition.kinds.is_empty() {
            return Err(BenchError::Nothing("kinds"));
        }
        let middle =
            Point { triangles: self.fixed_triangles, threads: all_threads, rays: self.fixed_rays };
        let more_triangles =
            self.definition.triangles.iter().map(|&triangles| Point { triangles, ..middle });
        let more_rays = self.definition.rays.iter().map(|&rays| Point { rays, ..middle });
        let more_threads = self.threads.iter().map(|&threads| Point { threads, ..middle });
        let mut points: Vec<Point> = more_triangles.chain(more_rays).chain(more_threads).collect();
        points.sort_unstable();
        points.dedup();
        Ok(points)
    }

    /// Measures points that differ in their rays only; whether nobody stopped it.
    fn measure_group(
        &self,
        group: &[Point],
        course: &mut Course,
        record: &mut Record,
        watch: &mut dyn Watch,
    ) -> Result<bool, BenchError> {
        let mut contest = Contest::new(&self.setup)?;
        let mut work = MapWork::new(&self.definition, group[0].triangles)?;
        for point in group {
            for piece in work.pieces(point.rays, &self.definition.kinds) {
                let Some(cells) = contest.measure(&piece, &|| watch.is_stopped())? else {
                    return Ok(false);
                };
                watch.on_cell(&course.advance(point.triangles, point.rays, &cells));
                record.cells.extend(cells);
            }
        }
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::EngineSpec;
    use crate::contest::{Effort, Unwatched};
    use crate::work::RayKind;

    fn bench() -> ScalingBench {
        let mut definition = Definition::default_map();
        definition.triangles = vec![10, 20, 40];
        definition.rays = vec![16, 64];
        definition.kinds = vec![RayKind::Primary];
        let hierarchy: EngineSpec = "hierarchy".parse().unwrap();
        ScalingBench {
            definition,
            fixed_triangles: 20,
            fixed_rays: 64,
            threads: vec![1, 2],
            setup: Setup::new(vec![hierarchy], Effort::of_runs(1)),
        }
    }

    #[test]
    fn one_count_varies_at_a_time_and_no_cell_comes_twice() {
        let record = measure(&bench(), &mut Unwatched).unwrap();
        let cell = |cell: &crate::record::Cell| (cell.triangles, cell.threads, cell.rays);
        let cells: Vec<_> = record.cells.iter().map(cell).collect();
        assert_eq!(cells, [(10, 2, 64), (20, 1, 64), (20, 2, 16), (20, 2, 64), (40, 2, 64)]);
        assert_eq!(bench().cell_count().unwrap(), cells.len());
        let slopes = slopes(&record);
        assert_eq!((slopes.len(), slopes[0].against), (1, Against::Triangles));
    }

    #[test]
    fn nothing_to_measure_is_an_error() {
        let none = ScalingBench { threads: Vec::new(), ..bench() };
        assert!(measure(&none, &mut Unwatched).unwrap_err().to_string().contains("no threads"));
        let mut none = bench();
        none.definition.kinds.clear();
        assert!(none.cell_count().unwrap_err().to_string().contains("no kinds"));
    }
}
