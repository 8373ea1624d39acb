//! The map: T moving triangles x R rays x kind of rays, each cell measured with every engine.
//!
//! Cells come in the order of their triangles, then rays, then kinds. All engines trace the same
//! rays through the same memory. Rays are made once a frame by the engine `hierarchy`, whose
//! answers are right by definition; that is not measured.
//!
//! **Cost**: the rays of all kinds of one (T, R) in memory, besides the geometry of each frame.

mod table;
mod work_of;

use crate::BenchError;
use crate::contest::{Contest, Course, Setup, Watch};
use crate::record::Record;
use crate::work::Definition;

pub use table::{format, one_line};
pub(crate) use work_of::MapWork;

/// What records call the scene of the map.
pub const SCENE: &str = "map";

/// What is measured, and how.
#[derive(Clone, Debug)]
pub struct MapBench {
    /// The work, with the triangles, rays and kinds to measure.
    pub definition: Definition,
    /// Who takes part, and how.
    pub setup: Setup,
}

/// Measures the map on the current rayon thread pool. Stopped, it ends with the cells that are
/// whole.
///
/// # Errors
/// [`BenchError`] when there is nothing to measure, or an engine cannot be had.
pub fn measure(bench: &MapBench, watch: &mut dyn Watch) -> Result<Record, BenchError> {
    let MapBench { definition, setup } = bench;
    let mut record = setup.record("map");
    record.definition = Some(definition.text().to_owned());

    let Definition { triangles, rays, kinds, .. } = definition;
    let lists = [("triangles", triangles.len()), ("rays", rays.len()), ("kinds", kinds.len())];
    if let Some((name, _)) = lists.into_iter().find(|&(_, len)| len == 0) {
        return Err(BenchError::Nothing(name));
    }
    let sizes =
        triangles.iter().flat_map(|&triangles| rays.iter().map(move |&rays| (triangles, rays)));
    let mut course = Course::new(sizes.flat_map(|size| vec![size; kinds.len()]));
    for &triangles in triangles {
        // Engines begin anew, so that they hold no more memory than this size needs.
        let mut contest = Contest::new(setup)?;
        let mut work = MapWork::new(definition, triangles)?;
        for &rays in rays {
            for piece in work.pieces(rays, kinds) {
                let Some(cells) = contest.measure(&piece, &|| watch.is_stopped())? else {
                    return Ok(record);
                };
                watch.on_cell(&course.advance(triangles, rays, &cells));
                record.cells.extend(cells);
            }
        }
    }
    Ok(record)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::EngineSpec;
    use crate::contest::{Effort, Progress};
    use crate::work::RayKind;

    /// Notes how it goes, and stops after some cells.
    struct Counting {
        seen: Vec<(usize, usize)>,
        last: usize,
    }

    impl Watch for Counting {
        fn on_cell(&mut self, progress: &Progress<'_>) {
            self.seen.push((progress.done_count, progress.count));
        }

        fn is_stopped(&self) -> bool {
            self.seen.len() >= self.last
        }
    }

    fn bench() -> MapBench {
        let mut definition = Definition::default_map();
        definition.triangles = vec![10, 30];
        definition.rays = vec![16, 64];
        definition.kinds = vec![RayKind::Mirror, RayKind::Suns];
        let engines = ["hierarchy", "brute"].map(|name| name.parse::<EngineSpec>().unwrap());
        MapBench { definition, setup: Setup::new(engines.into(), Effort::of_runs(1)) }
    }

    #[test]
    fn the_map_has_a_cell_for_each_size_kind_and_engine() {
        let mut watch = Counting { seen: Vec::new(), last: usize::MAX };
        let record = measure(&bench(), &mut watch).unwrap();
        assert_eq!(watch.seen, (1..=8).map(|done| (done, 8)).collect::<Vec<_>>());
        assert_eq!((record.benchmark.as_str(), record.cells.len()), ("map", 16));
        assert_eq!(record.definition.as_deref(), Some(bench().definition.text()));
        assert!(record.cells.iter().all(|cell| cell.mismatches == 0 && cell.total_ms.is_some()));
        let first = &record.cells[0];
        assert_eq!((first.triangles, first.rays, first.kind.as_str()), (10, 16, "mirror"));
    }

    #[test]
    fn stopped_it_keeps_the_cells_that_are_whole() {
        let mut watch = Counting { seen: Vec::new(), last: 3 };
        let record = measure(&bench(), &mut watch).unwrap();
        assert_eq!(record.cells.len(), 6);
    }

    #[test]
    fn nothing_to_measure_is_an_error() {
        let mut none = bench();
        none.definition.rays.clear();
        let mut watch = Counting { seen: Vec::new(), last: 1 };
        assert!(measure(&none, &mut watch).unwrap_err().to_string().contains("no rays"));
    }
}
