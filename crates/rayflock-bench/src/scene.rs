//! Rays of each kind over the frames of any animation, traced by each engine.
//!
//! A frame is a phase: before each turn an engine gets the frame before, unmeasured, so that an
//! update is that of a playing animation; then it commits the frame and traces the rays. The rays
//! are made as for the [map](crate::map), from what the camera sees; lights and lengths are the
//! scene's own or suit its size, see
//! [`Surroundings::of_scene`](crate::work::Surroundings::of_scene).
//!
//! **Cost**: the geometry of all frames and the rays of one kind in memory.

mod table;

use rayflock::engine::RayEngine;
use rayflock::engine::hierarchy::HierarchyEngine;
use rayflock::geom::{FrameChanges, Geometry};
use rayflock::render::View;
use rayflock::scene::{Evaluator, SceneFrame};

use crate::BenchError;
use crate::contest::{Contest, Course, Piece, PieceFrame, PiecePhase, Setup, Watch};
use crate::record::Record;
use crate::work::{self, RayKind, Surroundings};

pub use table::format;

/// What every random number follows from.
const SEED: u64 = 1;

/// What is measured, and how.
#[derive(Clone, Debug)]
pub struct SceneBench {
    /// What the record calls the scene.
    pub name: String,
    /// The frames, counted from 0.
    pub frames: Vec<u32>,
    /// Frames a second.
    pub frame_rate: f64,
    /// Width and height in pixels, with a ray each.
    pub size: [usize; 2],
    /// Kinds of rays.
    pub kinds: Vec<RayKind>,
    /// Who takes part, and how.
    pub setup: Setup,
}

/// Measures on the current rayon thread pool. `view` says where a frame is seen from. Stopped, it
/// ends with the kinds of rays that are whole.
///
/// # Errors
/// [`BenchError`] when there is nothing to measure, a frame cannot be made, or an engine cannot be
/// had.
pub fn measure(
    bench: &SceneBench,
    evaluator: &mut Evaluator,
    view: &dyn Fn(&SceneFrame) -> View,
    watch: &mut dyn Watch,
) -> Result<Record, BenchError> {
    for (name, len) in [("frames", bench.frames.len()), ("kinds of rays", bench.kinds.len())] {
        if len == 0 {
            return Err(BenchError::Nothing(name));
        }
    }
    let mut record = bench.setup.record("scene");
    let mut contest = Contest::new(&bench.setup)?;
    let mut stage = Stage { bench, evaluator, view, finder: HierarchyEngine::default() };
    let mut course = Course::new(bench.kinds.iter().map(|_| (1, 1)));
    for &kind in &bench.kinds {
        let piece = stage.piece(kind)?;
        let Some(cells) = contest.measure(&piece, &|| watch.is_stopped())? else { break };
        watch.on_cell(&course.advance(1, 1, &cells));
        record.cells.extend(cells);
    }
    Ok(record)
}

/// Where frames come from.
struct Stage<'a> {
    bench: &'a SceneBench,
    evaluator: &'a mut Evaluator,
    view: &'a dyn Fn(&SceneFrame) -> View,
    /// Finds what the camera sees.
    finder: HierarchyEngine,
}

impl Stage<'_> {
    /// All frames with rays of `kind`.
    fn piece(&mut self, kind: RayKind) -> Result<Piece, BenchError> {
        let bench = self.bench;
        let phases = bench.frames.iter().map(|&frame| self.phase(frame, kind));
        let phases = phases.collect::<Result<Vec<_>, _>>()?;
        let counts = phases.iter().flat_map(|phase| &phase.frames);
        let triangles = counts.map(|frame| frame.geometry.prim_count()).max().unwrap_or(0);
        Ok(Piece { scene: bench.name.clone(), triangles, kind, phases })
    }

    fn phase(&mut self, frame: u32, kind: RayKind) -> Result<PiecePhase, BenchError> {
        let before = frame.checked_sub(1).unwrap_or(1);
        let before = self.evaluate(before)?.geometry.clone();
        let view = self.view;
        let scene_frame = self.evaluate(frame)?;
        let geometry: Geometry = scene_frame.geometry.clone();
        let surroundings =
            Surroundings::of_scene(&geometry.bounds(), view(scene_frame), &scene_frame.lights);
        self.finder.commit(&geometry, &FrameChanges::all())?;
        let size = self.bench.size;
        let rays = work::generate(kind, size, &surroundings, &geometry, &mut self.finder, SEED);
        Ok(PiecePhase {
            name: format!("frame {frame}"),
            frame: Some(frame),
            before,
            frames: vec![PieceFrame { geometry, rays }],
        })
    }

    fn evaluate(&mut self, frame: u32) -> Result<&SceneFrame, BenchError> {
        let time = f64::from(frame) / self.bench.frame_rate;
        self.evaluator.evaluate(time).map_err(|source| BenchError::Scene { frame, source })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use rayflock::scene::builtin;

    use super::*;
    use crate::EngineSpec;
    use crate::contest::{Effort, Unwatched};

    fn measure_cornell(change: impl Fn(&mut SceneBench)) -> Result<Record, BenchError> {
        let scene = Arc::new(builtin::build("cornell").unwrap());
        let mut evaluator = Evaluator::new(Arc::clone(&scene), None).unwrap();
        let engines = ["brute", "hierarchy"].map(|name| name.parse::<EngineSpec>().unwrap());
        let mut bench = SceneBench {
            name: "builtin:cornell".to_owned(),
            frames: vec![0, 7],
            frame_rate: 24.0,
            size: [8, 6],
            kinds: vec![RayKind::Primary, RayKind::PointShadow, RayKind::Ao],
            setup: Setup::new(engines.into(), Effort::of_runs(2)),
        };
        change(&mut bench);
        let view = |frame: &SceneFrame| View::new(frame.cameras[0], scene.cameras[0].projection);
        measure(&bench, &mut evaluator, &view, &mut Unwatched)
    }

    #[test]
    fn every_kind_is_measured_in_every_frame_by_every_engine() {
        let record = measure_cornell(|_| ()).unwrap();
        let cells: Vec<_> =
            record.cells.iter().map(|cell| (cell.kind.as_str(), cell.engine.as_str())).collect();
        let of = |kind| [(kind, "brute"), (kind, "hierarchy")];
        assert_eq!(cells, [of("primary"), of("pointshadow"), of("ao")].concat());
        for cell in &record.cells {
            let frames: Vec<_> = cell.phases.iter().map(|phase| phase.frame.unwrap()).collect();
            assert_eq!((frames, cell.mismatches), (vec![0, 7], 0));
            assert!(cell.phases.iter().all(|phase| phase.rounds == 2 && phase.rays > 0));
            assert!(cell.triangles > 0 && cell.scene == "builtin:cornell");
        }
        let text = format(&record);
        assert!(text.contains("pointshadow") && text.contains("hierarchy"), "{text}");
    }

    #[test]
    fn nothing_to_measure_is_an_error() {
        let message =
            |change: fn(&mut SceneBench)| measure_cornell(change).unwrap_err().to_string();
        assert!(message(|bench| bench.frames.clear()).contains("no frames"));
        assert!(message(|bench| bench.kinds.clear()).contains("no kinds of rays"));
        assert!(message(|bench| bench.setup.engines.clear()).contains("no engines"));
    }
}
