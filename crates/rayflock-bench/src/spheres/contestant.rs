//! One way to see virtual lights under measurement.

use rayflock::engine::EngineKind;
use rayflock::render::occluders::SphereSettings;
use rayflock::render::vpl::{LookoutSettings, Visibility};
use rayflock::render::{
    Film, FrameRenderer, FrameStats, Indirect, RenderError, RenderSettings, View, WhittedRenderer,
};
use rayflock::scene::{Scene, SceneFrame};

use super::{KIND, SpheresBench};
use crate::contest::{of_frame, of_phases};
use crate::difference::{Difference, difference};
use crate::peer::PeerError;
use crate::peer::embree::EmbreeLibrary;
use crate::record::{Cell, Phase};
use crate::{BenchError, EngineSpec};

/// Width and height of the pictures that bring a frame before to everything.
const TINY: (usize, usize) = (8, 6);

/// How visibility is found.
#[derive(Clone, Copy, Debug)]
pub(super) enum Way {
    /// By rays through an engine.
    Exact(EngineSpec),
    /// Past so many spheres.
    Spheres(usize),
    /// By rays that so many points share.
    Lookouts(usize),
}

/// A renderer that sees in one way, with what was measured of it.
#[derive(Debug)]
pub(super) struct Contestant {
    /// `embree:best`, `auto`, `spheres:512`, `lookouts:32`.
    pub(super) name: String,
    setting: String,
    renderer: WhittedRenderer,
    settings: RenderSettings,
    film: Film,
    samples: Vec<Sample>,
}

/// One frame, rendered once.
#[derive(Clone, Copy, Debug)]
struct Sample {
    fit_ms: f64,
    gather_ms: f64,
    stats: FrameStats,
    difference: Difference,
    triangles: usize,
}

impl Sample {
    fn total_ms(&self) -> f64 {
        self.fit_ms + self.gather_ms
    }
}

impl Contestant {
    /// Nothing is rendered yet.
    ///
    /// # Errors
    /// [`PeerError`] when the engine cannot be had.
    pub(super) fn new(
        bench: &SpheresBench,
        way: Way,
        library: Option<&EmbreeLibrary>,
    ) -> Result<Self, PeerError> {
        let (name, visibility, spec) = match way {
            Way::Exact(spec) => (spec.to_string(), Visibility::Exact, spec),
            Way::Spheres(count) => {
                let visibility = Visibility::Spheres(SphereSettings { count });
                (format!("spheres:{count}"), visibility, EngineKind::Auto.into())
            }
            Way::Lookouts(points) => {
                let visibility = Visibility::Lookouts(LookoutSettings { points });
                (format!("lookouts:{points}"), visibility, EngineKind::Auto.into())
            }
        };
        let setting = match spec {
            EngineSpec::Embree(setting) => setting.to_string(),
            _ => String::new(),
        };
        let lights = rayflock::render::vpl::VplSettings { visibility, ..bench.lights() };
        let settings = RenderSettings {
            depth: bench.depth,
            indirect: Indirect::Vpl(lights),
            ..RenderSettings::default()
        };
        let [width, height] = bench.size;
        Ok(Self {
            name,
            setting,
            renderer: WhittedRenderer::new(spec.create(library)?),
            settings,
            film: Film::new(width, height),
            samples: Vec::new(),
        })
    }

    /// Whether what was measured is the engine's own work.
    ///
    /// # Errors
    /// [`BenchError::HandedOver`] when it is not.
    pub(super) fn check(&self) -> Result<(), BenchError> {
        BenchError::unless_own(&self.name, self.renderer.notice())
    }

    /// Mean of fitting and gathering over everything measured, in milliseconds.
    pub(super) fn mean_total_ms(&self) -> f64 {
        let sum: f64 = self.samples.iter().map(Sample::total_ms).sum();
        sum / self.samples.len().max(1) as f64
    }

    /// Forgets what was measured so far.
    pub(super) fn forget_samples(&mut self) {
        self.samples.clear();
    }

    /// Makes a frame the current one, spheres and all, unmeasured.
    pub(super) fn prepare(
        &mut self,
        scene: &Scene,
        frame: &SceneFrame,
        view: &View,
    ) -> Result<(), RenderError> {
        self.renderer.commit(scene, frame)?;
        self.renderer.render(view, &self.settings, &mut Film::new(TINY.0, TINY.1));
        Ok(())
    }

    /// Renders a frame, and keeps what it took.
    pub(super) fn render(
        &mut self,
        scene: &Scene,
        frame: &SceneFrame,
        view: &View,
    ) -> Result<(), RenderError> {
        self.renderer.commit(scene, frame)?;
        let stats = self.renderer.render(view, &self.settings, &mut self.film);
        let conversion = stats.stages.indirect.trace.conversion_ns as f64 * 1e-9;
        let gather_seconds = (stats.indirect.gather_seconds - conversion).max(0.0);
        self.samples.push(Sample {
            fit_ms: 1e3 * stats.indirect.fit_seconds,
            gather_ms: 1e3 * gather_seconds,
            stats,
            difference: Difference::default(),
            triangles: frame.geometry.prim_count(),
        });
        Ok(())
    }

    /// Tells the last picture from that of another one.
    pub(super) fn compare_film(&mut self, reference: &Self) {
        if let Some(sample) = self.samples.last_mut() {
            sample.difference = difference(&self.film, &reference.film);
        }
    }

    /// What was measured: medians over the runs of a frame, means over the frames.
    pub(super) fn summarize(&self, bench: &SpheresBench) -> Cell {
        let frame_count = bench.frames.len();
        let phases = bench.frames.iter().enumerate().map(|(idx, &frame)| {
            let samples: Vec<Sample> =
                self.samples.iter().skip(idx).step_by(frame_count).copied().collect();
            phase(frame, &samples)
        });
        let of_samples = |value: fn(&Sample) -> f64| {
            self.samples.iter().map(value).sum::<f64>() / self.samples.len().max(1) as f64
        };
        let facts = [
            ("mean FLIP", of_samples(|sample| sample.difference.mean_flip)),
            ("relative RMSE", of_samples(|sample| sample.difference.relative_rmse)),
            ("spheres", of_samples(|sample| sample.stats.indirect.spheres as f64)),
            ("virtual lights", of_samples(|sample| sample.stats.indirect.lights as f64)),
        ];
        Cell {
            kind: KIND.to_owned(),
            scene: bench.name.clone(),
            engine: self.name.clone(),
            setting: self.setting.clone(),
            memory_bytes: self.renderer.memory_usage(),
            facts: facts.map(|(name, value)| (name.to_owned(), value)).into(),
            ..of_phases(phases.collect())
        }
    }
}

/// One frame.
fn phase(frame: u32, samples: &[Sample]) -> Phase {
    let last = samples.last();
    let times = |sample: &Sample| [sample.fit_ms, sample.gather_ms];
    Phase {
        triangles: last.map_or(0, |sample| sample.triangles),
        rays: last.map_or(0, |sample| sample.stats.indirect.visibility.pairs),
        ..of_frame(frame, &samples.iter().map(times).collect::<Vec<_>>())
    }
}
