//! Indirect light for a renderer: lights are shot once a picture and gathered wave by wave.

use rayflock_engine::RayEngine;
use rayflock_geom::Aabb;
use rayflock_scene::{Background, LightKind};

use super::exact_visibility::{ExactVisibility, RayBuffers};
use super::gather::{GatherBuffers, gather};
use super::resample::{Eyes, gather_chosen};
use super::shoot::{ShootBuffers, shoot};
use super::sources::Sources;
use super::{PairTile, PairVisibility, VirtualLights, Visibility, VisibilityStats, VplSettings};
use crate::frame_shading::FrameShading;
use crate::stats::{FrameStats, Stopwatch};
use crate::wave::ShadedRun;

/// Virtual lights and the memory to make and gather them, kept from picture to picture.
#[derive(Debug, Default)]
pub(crate) struct IndirectLight {
    lights: VirtualLights,
    /// What the lights were made of; `None` when they are out of date.
    made_of: Option<MadeOf>,
    bound: f32,
    shoot: ShootBuffers,
    gather: GatherBuffers,
    rays: RayBuffers,
}

/// What lights depend on besides the frame.
#[derive(Clone, Debug, PartialEq)]
struct MadeOf {
    light_count: u32,
    lights: Vec<LightKind>,
    background: Background,
}

impl IndirectLight {
    /// The frame has changed.
    pub(crate) fn invalidate(&mut self) {
        self.made_of = None;
    }

    /// The lights.
    pub(crate) const fn lights(&self) -> &VirtualLights {
        &self.lights
    }

    /// Shoots virtual lights, unless those of the last picture are still right.
    pub(crate) fn shoot(
        &mut self,
        engine: &mut dyn RayEngine,
        frame: &FrameShading,
        (lights, background): (&[LightKind], Background),
        bounds: &Aabb,
        settings: &VplSettings,
        stats: &mut FrameStats,
    ) {
        let stopwatch = Stopwatch::start();
        let diagonal = bounds.size().length();
        let per_area = settings.walk_count() as f32 / (diagonal * diagonal);
        // No geometry, no diagonal: nothing is gathered then.
        self.bound = settings.bound * per_area.min(f32::MAX);
        let light_count = settings.light_count;
        let made_of = MadeOf { light_count, lights: lights.to_vec(), background };
        if self.made_of.as_ref() != Some(&made_of) {
            let sources = Sources::new(lights, &frame.lights.emitters, background, bounds);
            let counts = (settings.walk_count(), settings.sky_count());
            let shot =
                shoot(engine, frame, &sources, counts, diagonal, &mut self.shoot, &mut self.lights);
            stats.trace += shot.trace;
            stats.rays.indirect += shot.rays;
            self.made_of = Some(made_of);
        }
        stats.indirect.lights = self.lights.len() as u64;
        stats.indirect.shoot_seconds += stopwatch.seconds();
    }

    /// Gathers light at the points of `runs`; what arrives is left as `lit` of each run, one entry
    /// a point. `sample_idx` counts the samples of a pixel.
    pub(crate) fn gather(
        &mut self,
        engine: &mut dyn RayEngine,
        (settings, sample_idx): (&VplSettings, u32),
        runs: &mut [ShadedRun],
        stats: &mut FrameStats,
    ) {
        let stopwatch = Stopwatch::start();
        let (lights, bound) = (&self.lights, self.bound);
        let gathered = match (settings.chosen, settings.visibility) {
            (None, Visibility::None) => {
                gather(lights, bound, &mut Unhindered, runs, &mut self.gather)
            }
            (None, Visibility::Exact) => {
                let mut exact = ExactVisibility::new(engine, &mut self.rays);
                let gathered = gather(lights, bound, &mut exact, runs, &mut self.gather);
                stats.trace += exact.trace;
                gathered
            }
            (Some(chosen), _) => {
                let mut exact = ExactVisibility::new(engine, &mut self.rays);
                let mut eyes = Eyes { guess: &mut Unhindered, exact: &mut exact };
                let chosen = (chosen, sample_idx);
                let gathered =
                    gather_chosen(lights, bound, chosen, &mut eyes, runs, &mut self.gather);
                stats.trace += exact.trace;
                gathered
            }
        };
        stats.rays.shadow += gathered.visibility.rays;
        stats.indirect.visibility += gathered.visibility;
        stats.indirect.gathered += gathered.gathered;
        stats.indirect.clamped += gathered.lost;
        stats.indirect.gather_seconds += stopwatch.seconds();
    }

    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        self.lights.memory_usage()
            + self.shoot.memory_usage()
            + self.gather.memory_usage()
            + self.rays.memory_usage()
    }
}

/// Everything sees everything.
#[derive(Debug)]
struct Unhindered;

impl PairVisibility for Unhindered {
    fn multiply(&mut self, _tile: &PairTile<'_>, _shares: &mut [f32]) -> VisibilityStats {
        VisibilityStats::default()
    }
}
