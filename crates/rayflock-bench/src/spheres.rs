//! Indirect light past spheres against exact visibility: the same virtual lights, gathered at the
//! same points, how much sooner and how wrong.
//!
//! For each run and frame, all ways to see take turns: each first gets the frame before and makes a
//! tiny picture of it, unmeasured, so that fitting is that of a playing animation; then it renders
//! the frame. Points that share lookouts see through the engine `auto`. What is measured is
//! gathering, and fitting where there are spheres; shooting, direct light and everything else is the
//! same for all and left out, and so is `commit` of the engines, which only rays need. What an
//! engine spends on the layout of a foreign library is taken off, as said in
//! [`TraceStats`](rayflock::engine::TraceStats::conversion_ns).
//!
//! Pictures are compared with that of the first exact way: mean FLIP of the pictures as they are
//! shown, and root mean squared error of the radiance relative to its root mean square
//! ([`difference`](crate::difference)).
//!
//! In the record, `commit` is fitting and `trace` is gathering; errors are facts.

mod contestant;
mod format;

use rayflock::render::vpl::VplSettings;
use rayflock::render::{RenderError, View};
use rayflock::scene::{Evaluator, Scene, SceneFrame};
use serde::Serialize;

use crate::peer::embree::{EmbreeLibrary, Setting};
use crate::record::Record;
use crate::{BenchError, EngineSpec};

use contestant::{Contestant, Way};

pub use format::format;

/// What cells are called that hold gathering.
pub const KIND: &str = "virtual lights";

/// What is measured.
#[derive(Clone, Debug)]
pub struct SpheresBench {
    /// What the record calls the scene.
    pub name: String,
    /// The engines that see exactly, in the order of their turns.
    pub engines: Vec<EngineSpec>,
    /// Where Embree is, if an engine needs it.
    pub library: Option<EmbreeLibrary>,
    /// Numbers of spheres.
    pub sphere_counts: Vec<usize>,
    /// Numbers of points that share a lookout.
    pub lookout_points: Vec<usize>,
    /// About how many virtual lights.
    pub light_count: u32,
    /// The frames, counted from 0.
    pub frames: Vec<u32>,
    /// Frames a second.
    pub frame_rate: f64,
    /// Width and height of the pictures in pixels.
    pub size: [usize; 2],
    /// How often a ray may be mirrored or refracted.
    pub depth: u32,
    /// How often each frame is measured.
    pub run_count: usize,
}

/// The work, as it stands in the record.
#[derive(Serialize)]
struct Definition<'a> {
    scene: &'a str,
    size: [usize; 2],
    light_count: u32,
    depth: u32,
    frame_rate: f64,
    frames: &'a [u32],
}

/// Measures on the current rayon thread pool. `view` says where a frame is seen from; `on_frame`
/// is called when all have rendered a frame, which is once for warming up and then
/// `frames.len() * run_count` times.
///
/// # Errors
/// [`BenchError`] when there is nothing to measure, an engine cannot be had, or a frame cannot be
/// made or rendered.
pub fn measure(
    bench: &SpheresBench,
    evaluator: &mut Evaluator,
    view: &dyn Fn(&SceneFrame) -> View,
    on_frame: &mut dyn FnMut(),
) -> Result<Record, BenchError> {
    let &[warm_up, ..] = &bench.frames[..] else { return Err(BenchError::Nothing("frames")) };
    for (name, len) in [("runs", bench.run_count), ("engines", bench.engines.len())] {
        if len == 0 {
            return Err(BenchError::Nothing(name));
        }
    }
    let mut stage = Stage { bench, evaluator, view };
    let mut contestants = stage.enter(warm_up)?;
    stage.render(&mut contestants, warm_up)?;
    on_frame();
    contestants.iter_mut().for_each(Contestant::forget_samples);
    for _ in 0..bench.run_count {
        for &frame in &bench.frames {
            stage.render(&mut contestants, frame)?;
            on_frame();
        }
    }
    Ok(bench.record(&contestants))
}

impl SpheresBench {
    fn record(&self, contestants: &[Contestant]) -> Record {
        let mut record = Record::new("spheres");
        if let Some(library) = &self.library {
            record.versions.insert("embree".to_owned(), library.version().to_owned());
            record.versions.insert("embree-isa".to_owned(), library.isa().to_owned());
        }
        let definition = Definition {
            scene: &self.name,
            size: self.size,
            light_count: self.light_count,
            depth: self.depth,
            frame_rate: self.frame_rate,
            frames: &self.frames,
        };
        record.definition = toml::to_string(&definition).ok();
        record.cells = contestants.iter().map(|contestant| contestant.summarize(self)).collect();
        record
    }

    fn lights(&self) -> VplSettings {
        VplSettings { light_count: self.light_count, ..VplSettings::default() }
    }
}

/// The scene and where it is seen from.
struct Stage<'a> {
    bench: &'a SpheresBench,
    evaluator: &'a mut Evaluator,
    view: &'a dyn Fn(&SceneFrame) -> View,
}

impl Stage<'_> {
    /// One contestant for each engine, with the best setting of Embree, each number of spheres, and
    /// each number of points that share a lookout.
    fn enter(&mut self, frame: u32) -> Result<Vec<Contestant>, BenchError> {
        let (bench, library) = (self.bench, self.bench.library.as_ref());
        let mut contestants = Vec::new();
        for &spec in &bench.engines {
            contestants.push(match spec {
                EngineSpec::EmbreeBest => self.best_setting(frame)?,
                _ => Contestant::new(bench, Way::Exact(spec), library)?,
            });
        }
        for &count in &bench.sphere_counts {
            contestants.push(Contestant::new(bench, Way::Spheres(count), library)?);
        }
        for &points in &bench.lookout_points {
            contestants.push(Contestant::new(bench, Way::Lookouts(points), library)?);
        }
        Ok(contestants)
    }

    /// Embree with the setting that gathers a frame soonest.
    fn best_setting(&mut self, frame: u32) -> Result<Contestant, BenchError> {
        let mut best: Option<Contestant> = None;
        for setting in Setting::all().into_iter().filter(|setting| !setting.robust) {
            let way = Way::Exact(EngineSpec::Embree(setting));
            let mut tried = [Contestant::new(self.bench, way, self.bench.library.as_ref())?];
            self.render(&mut tried, frame)?;
            let [tried] = tried;
            if best.as_ref().is_none_or(|best| tried.mean_total_ms() < best.mean_total_ms()) {
                best = Some(tried);
            }
        }
        let mut best = best.ok_or(BenchError::Nothing("settings of Embree"))?;
        best.name = EngineSpec::EmbreeBest.to_string();
        Ok(best)
    }

    /// Every contestant gets the frame before `frame` (after it, for frame 0), then renders
    /// `frame`.
    fn render(&mut self, contestants: &mut [Contestant], frame: u32) -> Result<(), BenchError> {
        let before = frame.checked_sub(1).unwrap_or(1);
        self.each_at(contestants, before, Contestant::prepare)?;
        self.each_at(contestants, frame, Contestant::render)?;
        if let [reference, others @ ..] = contestants {
            others.iter_mut().for_each(|other| other.compare_film(reference));
        }
        Ok(())
    }

    /// Moves the scene to `frame` and gives every contestant its turn.
    fn each_at(
        &mut self,
        contestants: &mut [Contestant],
        frame: u32,
        turn: fn(&mut Contestant, &Scene, &SceneFrame, &View) -> Result<(), RenderError>,
    ) -> Result<(), BenchError> {
        let scene = std::sync::Arc::clone(self.evaluator.scene());
        let time = f64::from(frame) / self.bench.frame_rate;
        let scene_frame =
            self.evaluator.evaluate(time).map_err(|source| BenchError::Scene { frame, source })?;
        for contestant in contestants {
            turn(contestant, &scene, scene_frame, &(self.view)(scene_frame))
                .map_err(|source| BenchError::Render { frame, source })?;
            contestant.check()?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use rayflock::engine::EngineKind;
    use rayflock::scene::builtin;

    use super::*;

    #[test]
    fn every_way_to_see_has_a_cell_with_its_errors() {
        let scene = Arc::new(builtin::build("cornell").unwrap());
        let mut evaluator = Evaluator::new(Arc::clone(&scene), None).unwrap();
        let view = |frame: &SceneFrame| View::new(frame.cameras[0], scene.cameras[0].projection);
        let bench = SpheresBench {
            name: "cornell".to_owned(),
            engines: vec![EngineKind::Brute.into(), EngineKind::Hierarchy.into()],
            library: None,
            sphere_counts: vec![16],
            lookout_points: vec![16],
            light_count: 32,
            frames: vec![0, 3],
            frame_rate: 24.0,
            size: [16, 12],
            depth: 1,
            run_count: 1,
        };
        let mut rounds = 0;
        let record = measure(&bench, &mut evaluator, &view, &mut || rounds += 1).unwrap();
        assert_eq!(rounds, 3);
        let [brute, hierarchy, spheres, lookouts] = &record.cells[..] else { panic!("{record:?}") };
        assert_eq!((&brute.engine[..], &spheres.engine[..]), ("brute", "spheres:16"));
        assert_eq!((spheres.phases.len(), hierarchy.facts["relative RMSE"]), (2, 0.0));
        assert_eq!(lookouts.engine, "lookouts:16");
        for cell in [spheres, lookouts] {
            let flip = cell.facts["mean FLIP"];
            assert!(flip > 0.0 && flip < 0.1, "{flip}");
        }
        let text = format(&record);
        assert!(text.contains("spheres:16") && text.contains("times faster than brute"), "{text}");
        assert!(crate::report::html(&record).unwrap().contains("Error against speed"));

        let nothing = SpheresBench { frames: vec![], ..bench };
        let error = measure(&nothing, &mut evaluator, &view, &mut || ()).unwrap_err().to_string();
        assert_eq!(error, "nothing to measure: found no frames, expected at least one");
    }
}
