//! Has the lights of a picture leave photons, view by view and wave by wave.

use std::time::Instant;

use rayflock_engine::TraceStats;
use rayflock_render::caustics::LightView;
use rayflock_render::prepared::ThrownLight;
use rayflock_render::{FrameStats, Lens, StageStats};
use rayflock_scene::LightKind;

use super::store_bytes;
use crate::buffer::part_of;
use crate::compute::Room;
use crate::frame::DeviceFrame;
use crate::frame::buffers::FOLLOWED;
use crate::frame::picture::{Band, Picture, device_light, lens_params};
use crate::frame::render_band::{surfaces, tiles, trace_stats};
use crate::frame::trace_log::{Logged, Traced};
use crate::layout::{FrameParams, PHOTONS_OFFSET};
use crate::pass::StageEncoder;
use crate::slots::RUN_SLOTS;
use crate::{GpuContext, GpuError};

/// Photons that there may be at most: 128 MiB less what lies before them.
const LARGEST_CAPACITY: usize = (1 << 21) - 1;

/// Rows of texels in a row of tiles.
const TILE_ROWS: usize = 8;

/// What leaving photons took.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::frame) struct ShotStats {
    trace: TraceStats,
    photons: u64,
    seconds: f64,
}

/// Why photons are to be left anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Short {
    /// There is more room now.
    Grown,
    /// Waves had too many rays or pairs.
    Slots,
    /// There are more photons, or rays of a row of tiles, than bindings may hold.
    Photons,
}

impl ShotStats {
    pub(in crate::frame) fn add_to(self, stats: &mut FrameStats) {
        stats.stages.indirect += StageStats { trace: self.trace, seconds: 0.0 };
        stats.trace += self.trace;
        stats.rays.indirect += self.trace.rays;
        stats.caustics.photons += self.photons;
        stats.caustics.shoot_seconds += self.seconds;
    }
}

impl DeviceFrame {
    /// Leaves the photons of a picture and sorts them; `Ok(None)` where there are more than the
    /// device may hold.
    ///
    /// # Errors
    /// [`GpuError::Lost`] when the device fails.
    pub(in crate::frame) fn shoot_photons(
        &mut self,
        context: &GpuContext,
        picture: &Picture<'_>,
    ) -> Result<Option<ShotStats>, GpuError> {
        self.photons.count = 0;
        let (Some(thrown), true) = (&picture.thrown, self.scene.mirrors()) else {
            return Ok(Some(ShotStats::default()));
        };
        let start = Instant::now();
        let mut spread = if self.scene.transmits() { 2 } else { 1 };
        loop {
            match self.leave_photons(context, picture, thrown, spread)? {
                Ok(trace) => {
                    if self.photons.count > 0 {
                        let mut encoder = StageEncoder::new(context, &mut self.clock);
                        self.photons.sort(&mut encoder, thrown);
                        encoder.submit();
                    }
                    let photons = self.photons.count as u64;
                    let seconds = start.elapsed().as_secs_f64();
                    return Ok(Some(ShotStats { trace, photons, seconds }));
                }
                Err(Short::Grown) => {}
                Err(Short::Slots) => spread *= 2,
                Err(Short::Photons) => return Ok(None),
            }
        }
    }

    /// Leaves the photons of all lights, in waves with room for `spread` times as many rays as
    /// leave a light.
    fn leave_photons(
        &mut self,
        context: &GpuContext,
        picture: &Picture<'_>,
        thrown: &ThrownLight,
        spread: usize,
    ) -> Result<Result<TraceStats, Short>, GpuError> {
        let photons = &mut self.photons;
        let store = photons.store.reserve(context, store_bytes(photons.capacity));
        let mut encoder = context.device.create_command_encoder(&Default::default());
        encoder.clear_buffer(store, 0, Some(PHOTONS_OFFSET as u64));
        context.queue.submit([encoder.finish()]);
        let mut stats = TraceStats::default();
        for (light, view) in &thrown.views {
            let edge = view.edge as usize;
            let rows_at_once = RUN_SLOTS / (spread * edge) / TILE_ROWS * TILE_ROWS;
            if rows_at_once == 0 {
                return Ok(Err(Short::Photons));
            }
            for first_row in (0..edge).step_by(rows_at_once) {
                let rows = first_row..edge.min(first_row + rows_at_once);
                let band = Band { rows, width: edge, height: edge };
                let slot_count = spread * band.slot_count();
                match self.leave_rows(context, picture, (light, view), &band, slot_count)? {
                    Ok(of_rows) => stats += of_rows,
                    Err(short) => return Ok(Err(short)),
                }
            }
        }
        Ok(self.count_photons(context)?.map(|()| stats))
    }

    /// Counts the photons that were left; makes room where there was not enough.
    fn count_photons(&mut self, context: &GpuContext) -> Result<Result<(), Short>, GpuError> {
        let encoder = context.device.create_command_encoder(&Default::default());
        let (read_back, photons) = (&mut self.buffers.read_back, &mut self.photons);
        let left = read_back.run_for_number(context, encoder, photons.store.buffer())?;
        // The low word; the other counts what has a place among those that are sorted.
        let left = left as u32 as usize;
        if left > LARGEST_CAPACITY {
            return Ok(Err(Short::Photons));
        }
        if left > photons.capacity {
            photons.capacity = left.next_power_of_two().min(LARGEST_CAPACITY);
            return Ok(Err(Short::Grown));
        }
        photons.count = left;
        Ok(Ok(()))
    }

    /// Leaves the photons of some rows of a light's view.
    fn leave_rows(
        &mut self,
        context: &GpuContext,
        picture: &Picture<'_>,
        (light, view): (&LightKind, &LightView),
        band: &Band,
        slot_count: usize,
    ) -> Result<Result<TraceStats, Short>, GpuError> {
        let (start, depth) = (Instant::now(), picture.settings.depth);
        self.buffers.reserve(context, slot_count, band.pixel_count());
        self.buffers.light.write(context, &[device_light(light)]);
        self.log.begin(context, depth as usize + 1);
        for bounce in 0..=depth {
            let params = FrameParams {
                first_texture: self.scene.first_texture() as u32,
                goes_on: u32::from(bounce < depth),
                conserves: picture.conserves(),
                ..wave_params(&view.lens, band, slot_count as u32)
            };
            self.buffers.params.write(context, &[params]);
            self.begin_wave(context, bounce, &params);
            if bounce == 0 {
                self.find_primary(context, &params);
            } else {
                self.trace(context, Traced::Secondary, &params);
            }
            self.leave_wave(context, &params);
        }
        let logged = self.log.read(context, &mut self.buffers.read_back)?;
        self.clock.collect(context, start)?;
        if let Some(short) = self.shortage(&logged, slot_count) {
            return Ok(Err(if short == Room::Grown { Short::Grown } else { Short::Slots }));
        }
        Ok(Ok(logged.iter().fold(TraceStats::default(), |mut sum, logged| {
            sum += trace_stats(logged, rays_of(logged, band));
            sum
        })))
    }

    /// Turns hits into photons and the next wave.
    fn leave_wave(&mut self, context: &GpuContext, params: &FrameParams) {
        let (b, photons) = (&self.buffers, &self.photons);
        let [rays, paths, hits, primitives, attributes, scene] =
            surfaces(b, &self.primitives, &self.attributes, &self.scene);
        let store = part_of(photons.store.buffer(), store_bytes(photons.capacity));
        let (counts, light) = (b.counts(), b.light());
        let resources =
            [rays, paths, hits, primitives, attributes, scene, store, counts, b.params(), light];
        let mut encoder = StageEncoder::new(context, &mut self.clock);
        encoder.encoder.clear_buffer(b.counts.buffer(), 0, None);
        encoder.stage(&photons.leave_photons, &resources, tiles(params));
        encoder.submit();
    }
}

/// Rays of a wave from a light.
fn rays_of(logged: &Logged, band: &Band) -> u64 {
    match logged.traced {
        Traced::Primary => band.pixel_count() as u64,
        _ => logged.counts[FOLLOWED].into(),
    }
}

/// What a wave from a light begins with, of so many slots.
fn wave_params(lens: &Lens, band: &Band, slot_count: u32) -> FrameParams {
    FrameParams {
        slot_count,
        // Through the middles of texels.
        subpixel: [0.5; 2],
        ..lens_params(lens, band)
    }
}
