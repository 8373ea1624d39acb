//! The wavefront Whitted renderer: whole batches of rays through any engine.
//!
//! The film is rendered in bands of rows, each sample of a band as one wave of rays from the
//! camera. A wave is traced, shaded and lit; its mirrored and refracted rays make the next wave.
//! Where both together exceed the batch limit, they make two, and the second waits; so at most
//! one wave a bounce waits, and memory is bounded by the limit times the depth.
//!
//! **Source**: T. Whitted, *An Improved Illumination Model for Shaded Display*, CACM 23(6), 1980;
//! S. Laine, T. Karras, T. Aila, *Megakernels Considered Harmful: Wavefront Path Tracing on GPUs*,
//! HPG 2013, for stages over whole batches.
//!
//! **Invariants**: the picture does not depend on the engine, the number of threads, or the batch
//! limit (light past spheres does, a little: see `vpl/gather_past_spheres`); agrees with
//! [`reference`](crate::reference) up to rounding.
//!
//! **Cost**: buffers are kept from batch to batch and frame to frame; about 300 bytes for each
//! ray of the largest batch.

use std::ops::Range;

use rayflock_engine::auto::Choice;
use rayflock_engine::{Budget, CommitStats, Fact, RayEngine};
use rayflock_geom::{Aabb, HitBuffer};
use rayflock_scene::{Background, LightKind, Scene, SceneFrame};
use tracing::debug_span;

use crate::caustics::{Caustics, Shooting};
use crate::frame_shading::FrameShading;
use crate::shading::background::{self, DEFAULT_SKY};
use crate::stages::accumulate::BandSums;
use crate::stages::camera_rays::{TILE, camera_rays};
use crate::stages::draw_spheres::draw_spheres;
use crate::stages::group_rays::group_rays;
use crate::stages::light_dots::light_dots;
use crate::stages::shade_surface::{Surroundings, shade_surface};
use crate::stages::shadow_rays::{ShadowTarget, shadow_batch, shadow_rays};
use crate::stages::show::{count_rays, count_shadow_rays, show_surface};
use crate::stats::{Stage, StageStats, Stopwatch};
use crate::vpl::indirect::IndirectLight;
use crate::wave::{ShadedRun, ShadowWave, Wave};
use crate::{Film, FrameRenderer, FrameStats, Indirect, RenderError, RenderSettings, Shown, View};

/// Renders frames in whole batches of rays over any engine.
#[derive(Debug)]
pub struct WhittedRenderer {
    engine: Box<dyn RayEngine>,
    /// The committed frame, if there is one.
    frame: Option<FrameShading>,
    /// Around the geometry of the committed frame.
    bounds: Aabb,
    indirect: IndirectLight,
    caustics: Caustics,
    buffers: Buffers,
}

/// Working memory, kept from batch to batch.
#[derive(Debug, Default)]
struct Buffers {
    /// Waves to be traced, the next one last.
    pending: Vec<Wave>,
    /// Waves out of use.
    spare: Vec<Wave>,
    hits: HitBuffer,
    runs: Vec<ShadedRun>,
    shadow: ShadowWave,
    occluded: Vec<bool>,
    sums: BandSums,
}

/// What changes while a picture is rendered.
struct Tracer<'a> {
    engine: &'a mut dyn RayEngine,
    indirect: &'a mut IndirectLight,
    caustics: &'a mut Caustics,
    buffers: &'a mut Buffers,
    stats: &'a mut FrameStats,
}

/// What stays the same for one picture.
struct Picture<'a> {
    settings: RenderSettings,
    surroundings: Surroundings<'a>,
    lights: Vec<LightKind>,
    /// Of the bounds of the geometry.
    diagonal: f32,
}

impl WhittedRenderer {
    /// A renderer that traces with `engine`.
    pub fn new(engine: Box<dyn RayEngine>) -> Self {
        Self {
            engine,
            frame: None,
            bounds: Aabb::EMPTY,
            indirect: IndirectLight::default(),
            caustics: Caustics::default(),
            buffers: Buffers::default(),
        }
    }

    /// The engine.
    pub fn engine(&self) -> &dyn RayEngine {
        &*self.engine
    }
}

impl FrameRenderer for WhittedRenderer {
    fn commit(&mut self, scene: &Scene, frame: &SceneFrame) -> Result<CommitStats, RenderError> {
        let _span = debug_span!("commit_frame").entered();
        self.frame = None;
        self.indirect.invalidate(&frame.geometry);
        let shading = FrameShading::new(scene, frame)?;
        let stats = self.engine.commit(&frame.geometry, &frame.changes)?;
        self.frame = Some(shading);
        self.bounds = frame.geometry.bounds();
        Ok(stats)
    }

    fn render(&mut self, view: &View, settings: &RenderSettings, film: &mut Film) -> FrameStats {
        let _span = debug_span!("render").entered();
        let settings = settings.clamped();
        let Some(frame) = &self.frame else {
            let background = settings.background.unwrap_or(DEFAULT_SKY);
            let mut wave = self.buffers.spare.pop().unwrap_or_default();
            let stats = render_background(view, &background, &mut wave, film);
            self.buffers.spare.push(wave);
            return stats;
        };
        let diagonal = self.bounds.size().length();
        let picture = Picture::new(frame, diagonal, view, settings);
        let stopwatch = Stopwatch::start();
        let (size, dropped_before) = ((film.width(), film.height()), self.buffers.sums.dropped());
        let mut stats = FrameStats::default();
        let mut tracer = Tracer {
            engine: &mut *self.engine,
            indirect: &mut self.indirect,
            caustics: &mut self.caustics,
            buffers: &mut self.buffers,
            stats: &mut stats,
        };
        picture.shoot(&self.bounds, &mut tracer);
        picture.shoot_photons(&self.bounds, &mut tracer);
        for rows in bands(size, picture.settings.batch_rays) {
            picture.render_band(&mut tracer, view, size, &rows);
            let pixels = &mut film.pixels_mut()[rows.start * size.0..rows.end * size.0];
            tracer.buffers.sums.write(picture.settings.samples_per_pixel, pixels);
        }
        match picture.settings.shown {
            Shown::Vpls => light_dots(&mut *self.engine, self.indirect.lights(), view, film),
            Shown::Spheres => {
                let spheres = self.indirect.spheres(&picture.settings.indirect);
                draw_spheres(spheres, view, film);
            }
            _ => {}
        }
        stats.dropped = self.buffers.sums.dropped() - dropped_before;
        stats.shade_seconds = (stopwatch.seconds() - stats.trace_seconds).max(0.0);
        stats
    }

    fn memory_usage(&self) -> usize {
        let frame = self.frame.as_ref().map_or(0, FrameShading::memory_usage);
        let kept = self.indirect.memory_usage() + self.caustics.memory_usage();
        self.engine.memory_usage() + frame + kept + self.buffers.memory_usage()
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

/// The rows of the film in bands of at most `batch_rays` pixels, but at least one row; of whole
/// tiles where that fits.
pub(crate) fn bands(
    (width, height): (usize, usize),
    batch_rays: usize,
) -> impl Iterator<Item = Range<usize>> {
    let rows = (batch_rays / width.max(1)).clamp(1, height.max(1));
    let rows = if rows > TILE { rows - rows % TILE } else { rows };
    (0..height).step_by(rows).map(move |start| start..(start + rows).min(height))
}

/// A picture of nothing.
pub(crate) fn render_background(
    view: &View,
    background: &Background,
    wave: &mut Wave,
    film: &mut Film,
) -> FrameStats {
    let (width, height) = (film.width(), film.height());
    for y in 0..height {
        camera_rays(view, (width, height), y..y + 1, 0, wave);
        let batch = wave.batch();
        for (ray_idx, path) in wave.paths.iter().enumerate() {
            let radiance = background::radiance(background, batch.ray(ray_idx).direction);
            film.pixels_mut()[y * width + path.pixel_idx as usize] = radiance.to_array();
        }
    }
    FrameStats::default()
}

impl<'a> Picture<'a> {
    fn new(frame: &'a FrameShading, diagonal: f32, view: &View, settings: RenderSettings) -> Self {
        let lights = frame.lights.seen_from(view);
        let surroundings = Surroundings {
            frame,
            background: frame.background_of(&settings),
            sky_lights: frame.lights.are_missing(),
            indirect: settings.indirect != Indirect::Off,
            depth: settings.depth,
        };
        Self { settings, surroundings, lights, diagonal }
    }

    /// Leaves virtual lights, if light comes from them.
    fn shoot(&self, bounds: &Aabb, tracer: &mut Tracer<'_>) {
        let shown = self.settings.shown;
        let shows_light = !matches!(shown, Shown::Normals | Shown::Depth | Shown::Cost);
        if let Some(settings) = self.settings.indirect.lights()
            && shows_light
        {
            let frame = self.surroundings.frame;
            let shining = (&self.lights[..], self.surroundings.background);
            let Tracer { engine, indirect, stats, .. } = tracer;
            indirect.shoot(&mut **engine, frame, shining, bounds, settings, stats);
            indirect.fit(settings.visibility, stats);
        }
    }

    /// Leaves the photons of light that mirrors and glass throw, if that is shown.
    fn shoot_photons(&self, bounds: &Aabb, tracer: &mut Tracer<'_>) {
        let Tracer { engine, caustics, stats, .. } = tracer;
        let RenderSettings { depth, batch_rays, shown, .. } = self.settings;
        let shows_light = matches!(shown, Shown::Light | Shown::Vpls | Shown::Spheres);
        match self.settings.caustics {
            Some(settings) if shows_light => {
                let (frame, lights) = (self.surroundings.frame, &self.lights[..]);
                let conserves = self.surroundings.indirect;
                let shooting =
                    Shooting { frame, lights, bounds, settings, conserves, depth, batch_rays };
                caustics.shoot(&mut **engine, &shooting, stats);
            }
            _ => caustics.clear(),
        }
    }

    /// Renders all samples of a band of rows into the sums.
    fn render_band(
        &self,
        tracer: &mut Tracer<'_>,
        view: &View,
        size: (usize, usize),
        rows: &Range<usize>,
    ) {
        tracer.buffers.sums.reset(size.0 * rows.len());
        for sample_idx in 0..self.settings.samples_per_pixel {
            let mut wave = tracer.buffers.spare.pop().unwrap_or_default();
            camera_rays(view, size, rows.clone(), sample_idx, &mut wave);
            tracer.stats.rays.primary += wave.len() as u64;
            let limit = self.settings.batch_rays.max(wave.len());
            tracer.buffers.pending.push(wave);
            while let Some(wave) = tracer.buffers.pending.pop() {
                self.trace_wave(&wave, sample_idx, tracer);
                let next_bounce = wave.bounce + 1;
                tracer.buffers.spare.push(wave);
                next_waves(tracer.buffers, next_bounce, limit, tracer.stats);
            }
        }
    }

    /// Traces, shades and lights one wave.
    fn trace_wave(&self, wave: &Wave, sample_idx: u32, tracer: &mut Tracer<'_>) {
        let Tracer { engine, caustics, buffers, stats, .. } = tracer;
        buffers.hits.reset(wave.len());
        let stopwatch = Stopwatch::start();
        let span = debug_span!("closest_hit").entered();
        let trace = engine.closest_hit(&wave.batch(), &mut buffers.hits.as_hits());
        drop(span);
        let stage = if wave.bounce == 0 { Stage::Primary } else { Stage::Secondary };
        stats.add_traced(stage, StageStats { trace, seconds: stopwatch.seconds() });

        let shown = self.settings.shown;
        if matches!(shown, Shown::Normals | Shown::Depth) {
            let (frame, diagonal) = (self.surroundings.frame, self.diagonal);
            let Buffers { hits, runs, sums, .. } = &mut **buffers;
            show_surface((shown, diagonal), frame, wave, hits, runs);
            sums.add_unshadowed(runs);
            return;
        }
        shade_surface(&self.surroundings, wave, &buffers.hits, &mut buffers.runs);
        if shown == Shown::Cost {
            count_rays(wave, &mut buffers.runs);
        }
        caustics.gather(&mut buffers.runs, stats);
        if shown != Shown::Indirect {
            buffers.sums.add_unshadowed(&buffers.runs);
            self.light_directly(sample_idx, tracer);
        }
        if self.settings.indirect != Indirect::Off && shown != Shown::Cost {
            tracer.gather(&self.settings.indirect, sample_idx);
        }
    }

    /// Adds what lights and emitters send to the points of the current wave.
    fn light_directly(&self, sample_idx: u32, tracer: &mut Tracer<'_>) {
        for light in &self.lights {
            self.light(ShadowTarget::Light(light), tracer);
        }
        let emitters = &self.surroundings.frame.lights.emitters;
        if !emitters.is_empty() {
            let sample_count = self.settings.light_samples;
            for light_sample in 0..sample_count {
                let sample_idx = sample_idx.wrapping_mul(sample_count).wrapping_add(light_sample);
                let target = ShadowTarget::Emitters { emitters, sample_idx, sample_count };
                self.light(target, tracer);
            }
        }
    }

    /// Adds what one light sends to the points of the current wave.
    fn light(&self, target: ShadowTarget<'_>, tracer: &mut Tracer<'_>) {
        let Tracer { engine, buffers, stats, .. } = tracer;
        shadow_rays(target, &mut buffers.runs, &mut buffers.shadow);
        let count = buffers.shadow.len();
        buffers.occluded.clear();
        buffers.occluded.resize(count, false);
        if self.settings.shadows && count > 0 {
            let batch = shadow_batch(target, &buffers.shadow);
            let stopwatch = Stopwatch::start();
            let span = debug_span!("occluded").entered();
            let trace = engine.occluded(&batch, &mut buffers.occluded);
            drop(span);
            let traced = StageStats { trace, seconds: stopwatch.seconds() };
            stats.add_traced(Stage::Shadow, traced);
            stats.rays.shadow += count as u64;
        }
        if self.settings.shown == Shown::Cost {
            count_shadow_rays(&mut buffers.runs);
            buffers.occluded.fill(false);
        }
        buffers.sums.add_lit(&buffers.runs, &buffers.occluded);
    }
}

impl Tracer<'_> {
    /// Adds what virtual lights send to the points of the current wave.
    fn gather(&mut self, settings: &Indirect, sample_idx: u32) {
        let Tracer { engine, indirect, buffers, stats, .. } = self;
        let settings = (settings, sample_idx);
        indirect.gather(&mut **engine, settings, &mut buffers.runs, stats);
        buffers.occluded.clear();
        buffers.occluded.resize(buffers.runs.iter().map(|run| run.lit.len()).sum(), false);
        buffers.sums.add_lit(&buffers.runs, &buffers.occluded);
    }
}

/// Makes the mirrored and refracted rays of the runs waves of `bounce`, to be traced: one where
/// both fit in `limit` rays, else two.
fn next_waves(buffers: &mut Buffers, bounce: u32, limit: usize, stats: &mut FrameStats) {
    let count_of = |wave: fn(&ShadedRun) -> &Wave| -> usize {
        buffers.runs.iter().map(|run| wave(run).len()).sum()
    };
    let (mirrored, refracted) = (count_of(|run| &run.mirror), count_of(|run| &run.refraction));
    stats.rays.mirror += mirrored as u64;
    stats.rays.refraction += refracted as u64;

    let mut wave = buffers.spare_wave(bounce);
    let mirror = buffers.runs.iter().map(|run| &run.mirror);
    let refraction = buffers.runs.iter().map(|run| &run.refraction);
    if mirrored + refracted <= limit {
        group_rays(mirror.chain(refraction), &mut wave);
    } else {
        group_rays(mirror, &mut wave);
        let mut second = buffers.spare_wave(bounce);
        group_rays(buffers.runs.iter().map(|run| &run.refraction), &mut second);
        buffers.enqueue(second);
    }
    buffers.enqueue(wave);
}

impl Buffers {
    fn spare_wave(&mut self, bounce: u32) -> Wave {
        let mut wave = self.spare.pop().unwrap_or_default();
        wave.clear(bounce);
        wave
    }

    fn enqueue(&mut self, wave: Wave) {
        let queue = if wave.len() > 0 { &mut self.pending } else { &mut self.spare };
        queue.push(wave);
    }

    fn memory_usage(&self) -> usize {
        let waves = self.pending.iter().chain(&self.spare).map(Wave::memory_usage);
        let hits = self.hits.t.capacity() * (size_of::<f32>() * 3 + size_of::<u32>() * 2);
        waves.sum::<usize>()
            + self.runs.iter().map(ShadedRun::memory_usage).sum::<usize>()
            + hits
            + self.shadow.memory_usage()
            + self.occluded.capacity()
            + self.sums.memory_usage()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_cover_the_film_once() {
        for (size, limit) in [((640, 480), 1 << 17), ((7, 5), 1), ((3, 100), 64), ((0, 0), 10)] {
            let mut next = 0;
            for rows in bands(size, limit) {
                assert_eq!(rows.start, next);
                assert!(rows.len() == 1 || rows.len() * size.0 <= limit);
                next = rows.end;
            }
            assert_eq!(next, size.1);
        }
    }
}
