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
