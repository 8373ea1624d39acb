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
//! The films of all engines are compared with that of the first one of ours, bit by bit. Our own
//! must not differ; those of others do in a few pixels, where a ray grazes an edge.
//!
//! **Cost**: one film, one renderer and its engine for each engine.

mod contestant;
mod screen;
mod summarize;

use std::sync::Arc;

use rayflock::render::{RenderError, RenderSettings, View};
use rayflock::scene::{Evaluator, Scene, SceneFrame};
use serde::Serialize;

use crate::peer::embree::EmbreeLibrary;
use crate::record::{Cell, Record};
use crate::{BenchError, EngineSpec};

use contestant::Contestant;
use screen::screen;
use summarize::summarize;

/// What is measured.
#[derive(Clone, Debug)]
pub struct MuseumBench {
    /// What the record calls the scene.
    pub name: String,
    /// The engines in the order of their turns.
    pub engines: Vec<EngineSpec>,
    /// Where Embree is, if an engine needs it.
    pub library: Option<EmbreeLibrary>,
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

/// The work, as it stands in the record.
#[derive(Serialize)]
struct Definition<'a> {
    scene: &'a str,
    size: [usize; 2],
    samples_per_pixel: u32,
    depth: u32,
    frame_rate: f64,
    frames: &'a [u32],
}

/// Measures on the current rayon thread pool. `view` says where a frame is seen from; `on_frame`
/// is called when all engines have rendered a frame, which is once for warming up and then
/// `frames.len() * run_count` times.
///
/// # Errors
/// [`BenchError`] when there is nothing to measure, an engine cannot be had, or a frame cannot be
/// made or rendered.
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

    let mut stage = Stage { evaluator, view };
    let mut contestants = enter(bench, &mut stage, warm_up)?;
    stage.render(bench, &mut contestants, warm_up)?;
    on_frame();
    contestants.iter_mut().for_each(Contestant::forget_samples);
    for _ in 0..bench.run_count {
        for &frame in &bench.frames {
            stage.render(bench, &mut contestants, frame)?;
            on_frame();
        }
    }
    Ok(record(bench, &contestants))
}

/// One contestant for each engine, several for the best setting of Embree.
fn enter(
    bench: &MuseumBench,
    stage: &mut Stage<'_>,
    frame: u32,
) -> Result<Vec<Contestant>, BenchError> {
    let mut contestants = Vec::new();
    for &spec in &bench.engines {
        match spec {
            EngineSpec::EmbreeBest => contestants.extend(screen(bench, stage, frame)?),
            _ => contestants.push(Contestant::new(spec, bench.library.as_ref(), bench.size)?),
        }
    }
    Ok(contestants)
}

/// One cell for each engine that was asked for: of several settings that of the best.
fn record(bench: &MuseumBench, contestants: &[Contestant]) -> Record {
    let mut record = Record::new("museum");
    if let Some(library) = &bench.library {
        record.versions.insert("embree".to_owned(), library.version().to_owned());
        record.versions.insert("embree-isa".to_owned(), library.isa().to_owned());
    }
    record.definition = toml::to_string(&bench.definition()).ok();
    let best = bench.engines.iter().filter_map(|spec| {
        let of_engine = contestants.iter().filter(|one| one.name == spec.to_string());
        of_engine.min_by(|a, b| a.mean_total_ms().total_cmp(&b.mean_total_ms()))
    });
    record.cells = best.map(|contestant| summarize(bench, contestant)).collect();
    record
}

impl MuseumBench {
    fn definition(&self) -> Definition<'_> {
        let RenderSettings { samples_per_pixel, depth, .. } = self.settings;
        Definition {
            scene: &self.name,
            size: self.size,
            samples_per_pixel,
            depth,
            frame_rate: self.frame_rate,
            frames: &self.frames,
        }
    }
}

impl Record {
    /// Whether all engines of ours rendered the same films to the bit.
    pub fn same_films(&self) -> bool {
        let spec = |cell: &Cell| cell.engine.parse::<EngineSpec>();
        let is_own = |cell: &&Cell| spec(cell).is_ok_and(|spec| spec.is_own());
        self.cells.iter().filter(is_own).all(|cell| cell.mismatches == 0)
    }
}

/// The scene and where it is seen from.
struct Stage<'a> {
    evaluator: &'a mut Evaluator,
    view: &'a dyn Fn(&SceneFrame) -> View,
}

impl Stage<'_> {
    /// Every contestant gets the frame before `frame` (after it, for frame 0), then renders
    /// `frame`.
    fn render(
        &mut self,
        bench: &MuseumBench,
        contestants: &mut [Contestant],
        frame: u32,
    ) -> Result<(), BenchError> {
        let before = frame.checked_sub(1).unwrap_or(1);
        self.each_at(bench, contestants, before, Contestant::prepare)?;
        let view = self.view;
        self.each_at(bench, contestants, frame, |contestant, scene, scene_frame| {
            contestant.render(scene, scene_frame, &view(scene_frame), &bench.settings)
        })?;
        // The first of ours is the reference; without any, the very first.
        let reference_idx = contestants.iter().position(|one| one.is_own).unwrap_or(0);
        let (before, others) = contestants.split_at_mut(reference_idx);
        if let [reference, after @ ..] = others {
            let others = before.iter_mut().chain(after);
            others.for_each(|other| other.compare_film(reference));
        }
        Ok(())
    }

    /// Moves the scene to `frame` and gives every contestant its turn.
    fn each_at(
        &mut self,
        bench: &MuseumBench,
        contestants: &mut [Contestant],
        frame: u32,
        mut turn: impl FnMut(&mut Contestant, &Scene, &SceneFrame) -> Result<(), RenderError>,
    ) -> Result<(), BenchError> {
        let scene = Arc::clone(self.evaluator.scene());
        let time = f64::from(frame) / bench.frame_rate;
        let scene_frame =
            self.evaluator.evaluate(time).map_err(|source| BenchError::Scene { frame, source })?;
        for contestant in contestants {
            turn(contestant, &scene, scene_frame)
                .map_err(|source| BenchError::Render { frame, source })?;
            contestant.check()?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use rayflock::render::View;
    use rayflock::scene::builtin;

    use rayflock::engine::EngineKind;

    use super::*;

    fn measure_cornell(change: impl Fn(&mut MuseumBench)) -> (Result<Record, BenchError>, usize) {
        measure_scene("cornell", change)
    }

    fn measure_scene(
        name: &str,
        change: impl Fn(&mut MuseumBench),
    ) -> (Result<Record, BenchError>, usize) {
        let scene = Arc::new(builtin::build(name).unwrap());
        let mut evaluator = Evaluator::new(Arc::clone(&scene), None).unwrap();
        let mut bench = MuseumBench {
            name: name.to_owned(),
            engines: vec![EngineKind::Hierarchy.into(), EngineKind::Brute.into()],
            library: None,
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
        assert_eq!(record.engines(), ["hierarchy", "brute"]);
        assert!(record.same_films());
        for cell in &record.cells {
            let [first, second] = &cell.phases[..] else { panic!("two frames") };
            assert_eq!((first.frame, second.frame), (Some(0), Some(7)));
            assert_eq!((first.rounds, second.rounds), (3, 3));
            let mean = 0.5 * (first.total_ms + second.total_ms);
            assert!((cell.total_ms.unwrap() - mean).abs() < 1e-9 * mean);
            assert_eq!(cell.rays, (first.rays + second.rays).div_ceil(2));
            assert!(first.shade_ms.unwrap() > 0.0 && cell.memory_bytes > 0);
            let rate = cell.frames_per_second().unwrap();
            assert!((rate - 1e3 / (mean + cell.shade_ms().unwrap())).abs() < 1e-6 * rate);
        }
        let definition = record.definition.unwrap();
        assert!(definition.contains("size = [8, 6]"), "{definition}");
    }

    #[test]
    fn films_of_others_may_differ_and_ours_are_the_reference_wherever_they_stand() {
        let engines = vec![EngineSpec::Obvhs, EngineKind::Hierarchy.into()];
        // Obvhs knows no spheres; there are none in the museum.
        let (record, _) = measure_scene("museum3", |bench| bench.engines.clone_from(&engines));
        let mut record = record.unwrap();
        assert_eq!(record.cells[1].mismatches, 0, "the reference");
        record.cells[0].mismatches = 5;
        assert!(record.same_films());
        record.cells[1].mismatches = 5;
        assert!(!record.same_films());
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
