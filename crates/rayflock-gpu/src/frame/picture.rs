//! What a picture is rendered from, band by band.

use std::ops::Range;

use rayflock_engine::TraceStats;
use rayflock_render::prepared::{PictureLights, PreparedFrame, ThrownLight, sample_place};
use rayflock_render::{FrameStats, Lens, RenderSettings, StageStats, View};
use rayflock_scene::{Background, Falloff, LightKind};

use super::gather_lights::GatherSums;
use crate::layout::{DIRECTIONAL, DeviceLight, EMITTERS, FrameParams, POINT, SPOT};
use crate::slots::{RUN_SLOTS, TILE_RAYS};

/// Pixels along the side of a tile.
const TILE: usize = 8;

/// Pixels that a row may have: one row of tiles is what a wave may hold, at most.
pub(super) const MOST_COLUMNS: usize = RUN_SLOTS / TILE;

/// What stays the same for one picture.
#[derive(Debug)]
pub(super) struct Picture<'a> {
    pub(super) settings: RenderSettings,
    pub(super) lights: PictureLights,
    /// Whence mirrors and glass throw light, if that is found.
    pub(super) thrown: Option<ThrownLight>,
    pub(super) prepared: &'a PreparedFrame,
    pub(super) view: &'a View,
}

/// Some rows of a picture.
#[derive(Clone, Debug)]
pub(super) struct Band {
    pub(super) rows: Range<usize>,
    pub(super) width: usize,
    pub(super) height: usize,
}

/// What came of a band.
#[derive(Debug)]
pub(super) enum Rendered {
    /// Its pixels are written.
    Done(Box<BandStats>),
    /// There were more rays or pairs than buffers may hold.
    TooMuch,
}

/// What a band took.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BandStats {
    pub(super) primary: TraceStats,
    pub(super) secondary: TraceStats,
    pub(super) shadow: TraceStats,
    pub(super) mirror_rays: u64,
    /// Rays from the camera that were not traced.
    pub(super) scanned: u64,
    pub(super) gathered: GatherSums,
}

impl BandStats {
    pub(super) fn add_to(self, stats: &mut FrameStats) {
        let stages = &mut stats.stages;
        for (stage, trace) in [
            (&mut stages.primary, self.primary),
            (&mut stages.secondary, self.secondary),
            (&mut stages.shadow, self.shadow),
        ] {
            *stage += StageStats { trace, seconds: 0.0 };
            stats.trace += trace;
        }
        stats.rays.primary += self.primary.rays;
        stats.scanned += self.scanned;
        stats.rays.shadow += self.shadow.rays;
        stats.rays.mirror += self.mirror_rays;
        stats.rays.refraction += self.secondary.rays - self.mirror_rays;
        self.gathered.add_to(stats);
    }
}

impl<'a> Picture<'a> {
    pub(super) fn new(
        prepared: &'a PreparedFrame,
        view: &'a View,
        settings: RenderSettings,
    ) -> Self {
        let lights = prepared.lights(view, &settings);
        let caustics = settings.caustics.as_ref();
        let thrown = caustics.and_then(|caustics| prepared.thrown(&lights.lights, caustics));
        Self { lights, thrown, settings, prepared, view }
    }

    /// Rows whose rays a wave may hold.
    pub(super) fn rows_at_once(&self, width: usize) -> usize {
        let columns = width.max(1).next_multiple_of(TILE);
        let rows = RUN_SLOTS.min(self.settings.batch_rays) / columns;
        (rows - rows % TILE).max(TILE)
    }

    /// `conserves` of the parameters of a wave.
    pub(super) fn conserves(&self) -> u32 {
        u32::from(self.lights.conserves)
    }

    /// What a sample of a band begins with.
    pub(super) fn params(&self, band: &Band, sample_idx: u32) -> FrameParams {
        let [zenith, horizon, ground] = match self.lights.background {
            Background::Uniform(radiance) => [radiance; 3],
            Background::Gradient { zenith, horizon, ground } => [zenith, horizon, ground],
        }
        .map(|radiance| radiance.to_array());
        FrameParams {
            zenith,
            sky_share: self.lights.sky_share,
            horizon,
            ground,
            ambient: self.lights.ambient.to_array(),
            conserves: self.conserves(),
            subpixel: sample_place(sample_idx).to_array(),
            ..lens_params(&Lens::new(self.view, band.width, band.height), band)
        }
    }

    /// What is asked for shadow rays, one after the other, at a sample of the picture.
    pub(super) fn device_lights(
        &self,
        sample_idx: u32,
        emitter_count: usize,
    ) -> impl Iterator<Item = DeviceLight> + '_ {
        let sample_count = self.settings.light_samples;
        let on_emitters = move |light_sample: u32| DeviceLight {
            kind: EMITTERS,
            sample_idx: sample_idx.wrapping_mul(sample_count).wrapping_add(light_sample),
            sample_count,
            emitter_count: emitter_count as u32,
            ..DeviceLight::default()
        };
        let samples = if emitter_count > 0 { 0..sample_count } else { 0..0 };
        self.lights.lights.iter().map(device_light).chain(samples.map(on_emitters))
    }
}

impl Band {
    /// Slots of the rays from the camera.
    pub(super) fn slot_count(&self) -> usize {
        self.width.div_ceil(TILE) * self.rows.len().div_ceil(TILE) * TILE_RAYS
    }

    pub(super) fn pixel_count(&self) -> usize {
        self.width * self.rows.len()
    }
}

/// Where the rays of a band begin, and where they go.
pub(super) fn lens_params(lens: &Lens, band: &Band) -> FrameParams {
    let (eye, film, is_parallel) = match lens {
        Lens::Pinhole { origin, film } => (origin, film, 0),
        Lens::Parallel { direction, film } => (direction, film, 1),
    };
    FrameParams {
        top_left: film.top_left.to_array(),
        width: band.width as u32,
        right: film.right.to_array(),
        row_count: band.rows.len() as u32,
        down: film.down.to_array(),
        first_row: band.rows.start as u32,
        eye: eye.to_array(),
        is_parallel,
        ..FrameParams::default()
    }
}

pub(super) fn device_light(light: &LightKind) -> DeviceLight {
    match *light {
        LightKind::Point { position, intensity, falloff } => DeviceLight {
            position: position.to_array(),
            kind: POINT,
            is_constant: u32::from(falloff == Falloff::Constant),
            intensity: intensity.to_array(),
            ..DeviceLight::default()
        },
        LightKind::Directional { direction, irradiance } => DeviceLight {
            kind: DIRECTIONAL,
            direction: direction.normalize_or_zero().to_array(),
            intensity: irradiance.to_array(),
            ..DeviceLight::default()
        },
        LightKind::Spot { position, direction, intensity, cos_inner, cos_outer } => DeviceLight {
            position: position.to_array(),
            kind: SPOT,
            direction: direction.normalize_or_zero().to_array(),
            intensity: intensity.to_array(),
            cos_inner,
            cos_outer,
            ..DeviceLight::default()
        },
    }
}
