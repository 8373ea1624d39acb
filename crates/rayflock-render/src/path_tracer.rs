//! The wavefront path tracer: all light there is, found by chance, to judge everything else by.
//!
//! Each sample of a pixel is a path that turns wherever a surface would scatter light. At each
//! turn it asks lights and emitters by shadow rays, and goes on by one ray, chosen by what the
//! surface does; so a wave never grows, and every bounce is one batch through the engine. The
//! background lights like a sky, in place of ambient light.
//!
//! **Source**: J. T. Kajiya, *The Rendering Equation*, SIGGRAPH 1986; E. Veach, *Robust Monte
//! Carlo Methods for Light Transport Simulation*, 1997, chapter 9, for adding both ways to find an
//! emitter; S. Laine, T. Karras, T. Aila, *Megakernels Considered Harmful*, HPG 2013, for waves.
//!
//! **Departures**: with more than eight lights, all paths of a wave ask the same eight, chosen by
//! power, so that shadow rays share their origin. Materials are those of Whitted's model, scaled
//! down where they would send back more than arrives.
//!
//! **Invariants**: the picture does not depend on the engine, the number of threads, or the batch
//! limit. It converges, as samples grow, to all light that is scattered at most `depth + 1` times; but
//! for the light of lamps without size that comes through glass or by a mirror onto a rough
//! surface, which no path can find.
//!
//! **Cost**: for each sample and bounce, a ray a path and a shadow ray a light. Errors fall with the
//! square root of the samples.

use std::ops::Range;

use rayflock_engine::auto::Choice;
use rayflock_engine::{Budget, CommitStats, Fact, RayEngine};
use rayflock_geom::HitBuffer;
use rayflock_scene::{LightKind, Scene, SceneFrame};
use tracing::debug_span;

use crate::frame_shading::FrameShading;
use crate::lights::key_light::key_light;
use crate::lights::power::{LightChoice, brighter, flux};
use crate::shading::background::DEFAULT_SKY;
use crate::shading::sampling::PathSeed;
use crate::stages::accumulate::BandSums;
use crate::stages::camera_rays::camera_rays;
use crate::stages::group_rays::group_rays;
use crate::stages::scatter_paths::scatter_paths;
use crate::stages::shade_surface::Surroundings;
use crate::stages::shadow_rays::{ShadowTarget, shadow_batch, shadow_rays};
use crate::stats::{Stage, StageStats, Stopwatch};
use crate::wave::{ShadedRun, ShadowWave, Wave};
use crate::whitted::{bands, render_background};
use crate::{Film, FrameRenderer, FrameStats, RenderError, RenderSettings, View};

/// Renders frames by paths in whole batches over any engine.
#[derive(Debug)]
pub struct PathTracer {
    engine: Box<dyn RayEngine>,
    /// The committed frame, if there is one, and the radius of a sphere around it.
    frame: Option<(FrameShading, f32)>,
    buffers: Buffers,
}

/// Working memory, kept from batch to batch.
#[derive(Debug, Default)]
struct Buffers {
    wave: Wave,
    next: Wave,
    hits: HitBuffer,
    runs: Vec<ShadedRun>,
    shadow: ShadowWave,
    occluded: Vec<bool>,
    sums: BandSums,
}

/// What stays the same for one picture.
struct Picture<'a> {
    surroundings: Surroundings<'a>,
    lights: Vec<LightKind>,
    choice: LightChoice,
}

impl PathTracer {
    /// A path tracer that traces with `engine`.
    pub fn new(engine: Box<dyn RayEngine>) -> Self {
        Self { engine, frame: None, buffers: Buffers::default() }
    }
}

impl FrameRenderer for PathTracer {
    fn commit(&mut self, scene: &Scene, frame: &SceneFrame) -> Result<CommitStats, RenderError> {
        let _span = debug_span!("commit_frame").entered();
        self.frame = None;
        let shading = FrameShading::new(scene, frame)?;
        let stats = self.engine.commit(&frame.geometry, &frame.changes)?;
        self.frame = Some((shading, 0.5 * frame.geometry.bounds().size().length()));
        Ok(stats)
    }

    fn render(&mut self, view: &View, settings: &RenderSettings, film: &mut Film) -> FrameStats {
        let _span = debug_span!("render").entered();
        let settings = settings.clamped();
        let buffers = &mut self.buffers;
        let Some((frame, radius)) = &self.frame else {
            let background = settings.background.unwrap_or(DEFAULT_SKY);
            return render_background(view, &background, &mut buffers.wave, film);
        };
        let picture = Picture::new(frame, *radius, view, &settings);
        let stopwatch = Stopwatch::start();
        let (size, dropped_before) = ((film.width(), film.height()), buffers.sums.dropped());
        let mut stats = FrameStats::default();
        for rows in bands(size, settings.batch_rays) {
            buffers.sums.reset(size.0 * rows.len());
            for sample_idx in 0..settings.samples_per_pixel {
                camera_rays(view, size, rows.clone(), sample_idx, &mut buffers.wave);
                stats.rays.primary += buffers.wave.len() as u64;
                picture.trace_paths(&mut *self.engine, sample_idx, buffers, &mut stats);
            }
            let pixels = &mut film.pixels_mut()[pixels_of(&rows, size.0)];
            buffers.sums.write(settings.samples_per_pixel, pixels);
        }
        stats.dropped = buffers.sums.dropped() - dropped_before;
        stats.shade_seconds = (stopwatch.seconds() - stats.trace_seconds).max(0.0);
        stats
    }

    fn memory_usage(&self) -> usize {
        let frame = self.frame.as_ref().map_or(0, |(frame, _)| frame.memory_usage());
        self.engine.memory_usage() + frame + self.buffers.memory_usage()
    }

    fn choices(&self) -> &[Choice] {
        self.engine.choices()
    }

    fn facts(&self) -> Vec<Fact> {
        self.engine.facts()
    }

    fn budget(&self) -> Budget {
        self.engine.budget()
    }

    fn notice(&self) -> Option<&str> {
        self.engine.notice()
    }
}

fn pixels_of(rows: &Range<usize>, width: usize) -> Range<usize> {
    rows.start * width..rows.end * width
}

impl<'a> Picture<'a> {
    fn new(frame: &'a FrameShading, radius: f32, view: &View, settings: &RenderSettings) -> Self {
        let sky_lights = frame.lights.are_missing();
        let lights = match sky_lights {
            true => vec![key_light(&view.world_from_camera)],
            false => frame.lights.lights.clone(),
        };
        let background = settings.background.or(frame.background).unwrap_or(DEFAULT_SKY);
        let surroundings =
            Surroundings { frame, background, sky_lights, indirect: true, depth: settings.depth };
        let choice = LightChoice::new(lights.iter().map(|light| flux(light, radius)));
        Self { surroundings, lights, choice }
    }

    /// Follows the paths whose first rays are the wave of `buffers` to their ends.
    fn trace_paths(
        &self,
        engine: &mut dyn RayEngine,
        sample_idx: u32,
        buffers: &mut Buffers,
        stats: &mut FrameStats,
    ) {
        while buffers.wave.len() > 0 {
            self.trace_wave(engine, sample_idx, buffers, stats);
            buffers.next.clear(buffers.wave.bounce + 1);
            group_rays(buffers.runs.iter().map(|run| &run.mirror), &mut buffers.next);
            stats.rays.indirect += buffers.next.len() as u64;
            std::mem::swap(&mut buffers.wave, &mut buffers.next);
        }
    }

    /// Traces, scatters and lights one wave.
    fn trace_wave(
        &self,
        engine: &mut dyn RayEngine,
        sample_idx: u32,
        buffers: &mut Buffers,
        stats: &mut FrameStats,
    ) {
        let wave = &buffers.wave;
        buffers.hits.reset(wave.len());
        let stopwatch = Stopwatch::start();
        let trace = engine.closest_hit(&wave.batch(), &mut buffers.hits.as_hits());
        let stage = if wave.bounce == 0 { Stage::Primary } else { Stage::Secondary };
        stats.add_traced(stage, StageStats { trace, seconds: stopwatch.seconds() });

        scatter_paths(&self.surroundings, sample_idx, wave, &buffers.hits, &mut buffers.runs);
        buffers.sums.add_unshadowed(&buffers.runs);
        let [random, ..] = PathSeed::of_walks(wave.bounce).unit_4_cube(sample_idx, 0);
        for (light_idx, factor) in self.choice.asked(random) {
            let light = brighter(&self.lights[light_idx], factor);
            light_points(engine, ShadowTarget::Light(&light), buffers, stats);
        }
        let emitters = &self.surroundings.frame.lights.emitters;
        if !emitters.is_empty() {
            let target = ShadowTarget::Emitters { emitters, sample_idx, sample_count: 1 };
            light_points(engine, target, buffers, stats);
        }
    }
}

/// Adds what one light sends to the points of the current wave.
fn light_points(
    engine: &mut dyn RayEngine,
    target: ShadowTarget<'_>,
    buffers: &mut Buffers,
    stats: &mut FrameStats,
) {
    shadow_rays(target, &mut buffers.runs, &mut buffers.shadow);
    let count = buffers.shadow.len();
    buffers.occluded.clear();
    buffers.occluded.resize(count, false);
    if count > 0 {
        let stopwatch = Stopwatch::start();
        let batch = shadow_batch(target, &buffers.shadow);
        let trace = engine.occluded(&batch, &mut buffers.occluded);
        let traced = StageStats { trace, seconds: stopwatch.seconds() };
        stats.add_traced(Stage::Shadow, traced);
        stats.rays.shadow += count as u64;
    }
    buffers.sums.add_lit(&buffers.runs, &buffers.occluded);
}

impl Buffers {
    fn memory_usage(&self) -> usize {
        let hits = self.hits.t.capacity() * (size_of::<f32>() * 3 + size_of::<u32>() * 2);
        self.wave.memory_usage()
            + self.next.memory_usage()
            + hits
            + self.runs.iter().map(ShadedRun::memory_usage).sum::<usize>()
            + self.shadow.memory_usage()
            + self.occluded.capacity()
            + self.sums.memory_usage()
    }
}
