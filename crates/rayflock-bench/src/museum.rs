//! The first paper's graph: what the frames of an animation cost with each engine, rendered by the
//! wavefront renderer; update, trace and shade time of each frame.
//!
//! For each run and each frame, all engines in turn get the frame before (not measured, so that
//! an update is that of a playing animation), then in turn the frame itself: engine A, engine B,
//! next frame, A, B, and so on. What slows the machine for a while slows all engines alike. The
//! first frame is once rendered for warming up. Moving the scene to its place is done once for
//! all engines and not measured. What an engine spends on the layout of a foreign library is taken
//! off, as said in [`TraceStats`](rayflock::engine::TraceStats::conversion_ns).
//!
//! The films of all engines are compared with the first one's, bit by bit.
//!
//! **Cost**: one film, one renderer and its engine for each engine.

mod contestant;
mod summarize;

use std::sync::Arc;

use rayflock::engine::EngineKind;
use rayflock::render::{RenderError, RenderSettings, View};
use rayflock::scene::{Evaluator, Scene, SceneFrame};

use crate::BenchError;
use crate::record::Record;

use contestant::Contestant;
use summarize::summarize;

/// What is measured.
#[derive(Clone, Debug)]
pub struct MuseumBench {
    /// What the record calls the scene.
    pub name: String,
    /// The engines in the order of their turns; the first is what the others are compared with.
    pub engines: Vec<EngineKind>,
    /// The frames, counted from 0.
    pub frames: Vec<u32>,
    /// Frames a second.
    pub frame_rate: f64,
    /// Width and height of the films in pixels.
    pub size: [usize; 2],
    /// How often each frame is measured.
    pub run_count: usize,
    /// How frames are rendered.
    pub settings: RenderSettings,
}

/// Measures on the current rayon thread pool. `view` says where a frame is seen from; `on_frame`
/// is called when all engines have rendered a frame, which is once for warming up and then
/// `frames.len() * run_count` times.
///
/// # Errors
/// [`BenchError`] when there is nothing to measure or a frame cannot be made or rendered.
pub fn measure(
    bench: &MuseumBench,
    evaluator: &mut Evaluator,
    view: &dyn Fn(&SceneFrame) -> View,
    on_frame: &mut dyn FnMut(),
) -> Result<Record, BenchError> {
    let &[warm_up, ..] = &bench.frames[..] else { return Err(BenchError::Nothing("frames")) };
    if bench.run_count == 0 {
        return Err(BenchError::Nothing("runs"));
    }
    if bench.engines.is_empty() {
        return Err(BenchError::Nothing("engines"));
    }

    let contestants = bench.engines.iter().map(|&engine| Contestant::new(engine, bench.size));
    let mut round = Round { bench, evaluator, view, contestants: contestants.collect() };
    round.render(warm_up)?;
    on_frame();
    round.contestants.iter_mut().for_each(Contestant::forget_samples);
    for _ in 0..bench.run_count {
        for &frame in &bench.frames {
            round.render(frame)?;
            on_frame();
        }
    }
    let mut record = Record::new("museum");
    record.cells =
        round.contestants.iter().map(|contestant| summarize(bench, contestant)).collect();
    Ok(record)
}

/// All engines at the same frame.
struct Round<'a> {
    bench: &'a MuseumBench,
    evaluator: &'a mut Evaluator,
    view: &'a dyn Fn(&SceneFrame) -> View,
    contestants: Vec<Contestant>,
}

impl Round<'_> {
    /// Every engine gets the frame before `frame` (after it, for frame 0), then renders `frame`.
    fn render(&mut self, frame: u32) -> Result<(), BenchError> {
        self.each_at(frame.checked_sub(1).unwrap_or(1), Contestant::prepare)?;
        let MuseumBench { settings, .. } = self.bench;
        let view = self.view;
        self.each_at(frame, |contestant, scene, scene_frame| {
            contestant.render(scene, scene_frame, &view(scene_frame), settings)
        })?;
        if let [first, others @ ..] = &mut self.contestants[..] {
            others.iter_mut().for_each(|other| other.compare_film(first));
        }
        Ok(())
    }

    /// Moves the scene to `frame` and gives every engine its turn.
    fn each_at(
        &mut self,
        frame: u32,
        mut turn: impl FnMut(&mut Contestant, &Scene, &SceneFrame) -> Result<(), RenderError>,
    ) -> Result<(), BenchError> {
        let scene = Arc::clone(self.evaluator.scene());
        let time = f64::from(frame) / self.bench.frame_rate;
        let scene_frame =
            self.evaluator.evaluate(time).map_err(|source| BenchError::Scene { frame, source })?;
        for contestant in &mut self.contestants {
            turn(contestant, &scene, scene_frame)
                .map_err(|source| BenchError::Render { frame, source })?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use rayflock::render::View;
    use rayflock::scene::builtin;

    use super::*;

    fn measure_cornell(change: impl Fn(&mut MuseumBench)) -> (Result<Record, BenchError>, usize) {
        let scene = Arc::new(builtin::build("cornell").unwrap());
        let mut evaluator = Evaluator::new(Arc::clone(&scene), None).unwrap();
        let mut bench = MuseumBench {
            name: "cornell".to_owned(),
            engines: vec![EngineKind::Hierarchy, EngineKind::Brute, EngineKind::Hierarchy],
            frames: vec![0, 7],
            frame_rate: 24.0,
            size: [8, 6],
            run_count: 3,
            settings: RenderSettings::default(),
        };
        change(&mut bench);
        let view = |frame: &SceneFrame| View::new(frame.cameras[0], scene.cameras[0].projection);
        let mut frame_count = 0;
        let record = measure(&bench, &mut evaluator, &view, &mut || frame_count += 1);
        (record, frame_count)
    }

    #[test]
    fn every_engine_gets_every_frame_in_every_run_and_one_to_warm_up() {
        let (record, frame_count) = measure_cornell(|_| ());
        let record = record.unwrap();
        assert_eq!(frame_count, 1 + 2 * 3);
        assert_eq!(record.cells.iter().map(|cell| cell.mismatches).sum::<u64>(), 0);
        let engines: Vec<_> = record.cells.iter().map(|cell| &cell.engine).collect();
        assert_eq!(engines, ["hierarchy", "brute", "hierarchy"]);
        for cell in &record.cells {
            let [first, second] = &cell.phases[..] else { panic!("two frames") };
            assert_eq!((first.frame, second.frame), (Some(0), Some(7)));
            assert_eq!((first.rounds, second.rounds), (3, 3));
            let mean = 0.5 * (first.total_ms + second.total_ms);
            assert!((cell.total_ms.unwrap() - mean).abs() < 1e-9 * mean);
            assert_eq!(cell.rays, (first.rays + second.rays).div_ceil(2));
            assert!(first.shade_ms.unwrap() > 0.0 && cell.memory_bytes > 0);
        }
    }

    #[test]
    fn nothing_to_measure_is_an_error() {
        let message = |change: fn(&mut MuseumBench)| {
            let (record, frame_count) = measure_cornell(change);
            assert_eq!(frame_count, 0);
            record.unwrap_err().to_string()
        };
        assert!(message(|bench| bench.frames.clear()).contains("no frames"));
        assert!(message(|bench| bench.engines.clear()).contains("no engines"));
        assert!(message(|bench| bench.run_count = 0).contains("no runs"));
    }
}
