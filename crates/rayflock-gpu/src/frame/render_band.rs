//! Renders some rows of a picture, wave by wave, and reads them back.

use std::time::Instant;

use rayflock_engine::TraceStats;
use wgpu::BindingResource;

use super::DeviceFrame;
use super::attributes::AttributeStore;
use super::buffers::{FOLLOWED, FrameBuffers, MIRRORED, SHADOW};
use super::gather_lights::{GatherSums, SUM_BYTES};
use super::picture::{Band, BandStats, Picture, Rendered};
use super::scene_data::SceneData;
use super::trace_log::{Asked, Logged, Traced};
use crate::compute::{Room, Wave};
use crate::layout::{DeviceLight, FrameParams};
use crate::method::Question;
use crate::pass::{Groups, StageEncoder};
use crate::primitives::PrimitiveStore;
use crate::slots::{RUN_SLOTS, TILE_RAYS};
use crate::{GpuContext, GpuError};

impl DeviceFrame {
    /// Renders a band, and writes its pixels if there was room for everything.
    ///
    /// # Errors
    /// [`GpuError::Lost`] when the device fails.
    pub(super) fn render_band(
        &mut self,
        context: &GpuContext,
        picture: &Picture<'_>,
        band: &Band,
        pixels: &mut [[f32; 3]],
    ) -> Result<Rendered, GpuError> {
        // Where rays go on in two directions, a wave may have more rays than the one before.
        let most = if self.scene.transmits() { 2 * band.slot_count() } else { band.slot_count() };
        let slot_count = most.min(RUN_SLOTS);
        self.buffers.reserve(context, slot_count, band.pixel_count());
        loop {
            match self.render_samples(context, picture, band, slot_count)? {
                Ok(mut stats) => {
                    stats.gathered = self.read_film(context, picture, pixels)?;
                    return Ok(Rendered::Done(Box::new(stats)));
                }
                Err(Room::Grown) => {}
                Err(Room::Exhausted) => return Ok(Rendered::TooMuch),
            }
        }
    }

    /// Renders all samples to the film; tells if there was not enough room, and it is to be done
    /// again.
    fn render_samples(
        &mut self,
        context: &GpuContext,
        picture: &Picture<'_>,
        band: &Band,
        slot_count: usize,
    ) -> Result<Result<BandStats, Room>, GpuError> {
        let mut encoder = StageEncoder::new(context, &mut self.clock);
        encoder.encoder.clear_buffer(self.buffers.film.buffer(), 0, None);
        encoder.submit();
        let mut stats = BandStats::default();
        for sample_idx in 0..picture.settings.samples_per_pixel {
            let start = Instant::now();
            let params = FrameParams {
                slot_count: slot_count as u32,
                first_texture: self.scene.first_texture() as u32,
                ..picture.params(band, sample_idx)
            };
            self.render_waves(context, picture, params, sample_idx, band.pixel_count());
            let logged = self.log.read(context, &mut self.buffers.read_back)?;
            self.clock.collect(context, start)?;
            if let Some(short) = self.shortage(&logged, slot_count) {
                return Ok(Err(short));
            }
            let pixel_count = band.pixel_count() as u64;
            logged.iter().for_each(|logged| add_logged(&mut stats, logged, pixel_count));
        }
        Ok(Ok(stats))
    }

    /// Whether there was more than buffers hold.
    pub(super) fn shortage(&mut self, logged: &[Logged], slot_count: usize) -> Option<Room> {
        let most_rays = logged.iter().map(|logged| logged.counts[FOLLOWED]).max()?;
        let most_pairs = logged.iter().map(Logged::pairs_needed).max()?;
        if most_rays as usize > slot_count {
            return Some(Room::Exhausted);
        }
        self.compute.make_room(most_pairs)
    }

    /// All bounces of one sample.
    fn render_waves(
        &mut self,
        context: &GpuContext,
        picture: &Picture<'_>,
        mut params: FrameParams,
        sample_idx: u32,
        pixel_count: usize,
    ) {
        let bounces = if self.scene.mirrors() { picture.settings.depth } else { 0 };
        let emitter_count = self.scene.emitter_count();
        let lights: Vec<_> = picture.device_lights(sample_idx, emitter_count).collect();
        self.log.begin(context, (bounces as usize + 1) * (lights.len() + 1));
        for bounce in 0..=bounces {
            params.goes_on = u32::from(bounce < bounces);
            self.buffers.params.write(context, &[params]);
            self.begin_wave(context, bounce, &params);
            if bounce == 0 {
                self.find_primary(context, &params);
            } else {
                self.trace(context, Traced::Secondary, &params);
            }
            self.shade(context, &params);
            self.gather_photons(context, &params);
            for light in &lights {
                self.light(context, light, picture.settings.shadows, &params);
            }
            self.gather_lights(context, &params, pixel_count);
        }
    }

    /// Makes the rays from the camera, or those that the wave before left, a wave.
    pub(super) fn begin_wave(&mut self, context: &GpuContext, bounce: u32, params: &FrameParams) {
        let b = &self.buffers;
        let mut encoder = StageEncoder::new(context, &mut self.clock);
        if bounce == 0 {
            let [rays, paths, hits] = [&b.rays, &b.paths, &b.hits].map(|b| whole(b.buffer()));
            let resources = [rays, paths, hits, b.params()];
            encoder.stage(&self.stages.camera_rays, &resources, tiles(params));
        } else {
            let slot_count = params.slot_count as usize;
            self.wave_order.order(&mut encoder, b, slot_count, self.compute.bounds());
        }
        encoder.submit();
    }

    /// Finds what the rays of the wave hit, or its shadow rays.
    pub(super) fn trace(&mut self, context: &GpuContext, traced: Traced, params: &FrameParams) {
        let b = &self.buffers;
        let (rays, hits, question) = match traced {
            Traced::Shadow => (&b.shadow_rays, &b.shadow_hits, Question::Occluded),
            _ => (&b.rays, &b.hits, Question::Closest),
        };
        let wave = Wave {
            rays: rays.buffer(),
            hits: hits.buffer(),
            tile_count: params.slot_count as usize / TILE_RAYS,
            question,
        };
        let (log, counts) = (&mut self.log, b.counts.buffer());
        self.compute.trace_wave(
            context,
            &mut self.clock,
            &self.primitives,
            &wave,
            &mut |encoder, counters, asked| {
                log.add(encoder, traced, Asked::Traced(asked), [counters, counts]);
            },
        );
    }

    /// Turns hits into light, lit points and the next wave.
    fn shade(&mut self, context: &GpuContext, params: &FrameParams) {
        let b = &self.buffers;
        let [rays, paths, hits, primitives, attributes, scene] =
            surfaces(b, &self.primitives, &self.attributes, &self.scene);
        let points = whole(b.points.buffer());
        let resources =
            [rays, paths, hits, primitives, attributes, scene, points, b.counts(), b.params()];
        let mut encoder = StageEncoder::new(context, &mut self.clock);
        encoder.encoder.clear_buffer(b.counts.buffer(), 0, None);
        encoder.stage(&self.stages.shade_surface, &resources, tiles(params));
        let resources = [whole(b.points.buffer()), whole(b.film.buffer())];
        encoder.stage(&self.stages.add_emitted, &resources, tiles(params));
        encoder.submit();
    }

    /// Adds what one light sends to the points of the wave.
    fn light(
        &mut self,
        context: &GpuContext,
        light: &DeviceLight,
        has_shadows: bool,
        params: &FrameParams,
    ) {
        self.buffers.light.write(context, std::slice::from_ref(light));
        let b = &self.buffers;
        let emitters = self.scene.emitters();
        let resources = [
            whole(b.points.buffer()),
            whole(emitters),
            whole(b.shadow_rays.buffer()),
            whole(b.shadow_hits.buffer()),
            b.counts(),
            b.light(),
        ];
        let mut encoder = StageEncoder::new(context, &mut self.clock);
        let [offset, bytes] = [SHADOW, 1].map(|count| (count * size_of::<u32>()) as u64);
        encoder.encoder.clear_buffer(b.counts.buffer(), offset, Some(bytes));
        encoder.stage(&self.stages.shadow_rays, &resources, tiles(params));
        encoder.submit();
        if has_shadows {
            self.trace(context, Traced::Shadow, params);
        }
        let b = &self.buffers;
        let resources = [
            whole(b.points.buffer()),
            whole(self.scene.emitters()),
            whole(b.shadow_hits.buffer()),
            whole(b.film.buffer()),
            b.light(),
        ];
        let mut encoder = StageEncoder::new(context, &mut self.clock);
        encoder.stage(&self.stages.add_lit, &resources, tiles(params));
        encoder.submit();
    }

    /// Brings the means over all samples to the pixels; tells what gathering came to.
    fn read_film(
        &mut self,
        context: &GpuContext,
        picture: &Picture<'_>,
        pixels: &mut [[f32; 3]],
    ) -> Result<GatherSums, GpuError> {
        let share = 1.0 / picture.settings.samples_per_pixel as f32;
        let pixel_bytes = size_of_val(pixels);
        let bytes = pixel_bytes + SUM_BYTES;
        let read_back = &mut self.buffers.read_back;
        let target = read_back.target(context, bytes);
        let mut encoder = context.device.create_command_encoder(&Default::default());
        let film = self.buffers.film.buffer();
        encoder.copy_buffer_to_buffer(film, 0, &target, 0, Some(bytes as u64));
        let mut gathered = GatherSums::default();
        read_back.run(context, encoder, bytes, |bytes| {
            let (film, sums) = bytes.split_at(pixel_bytes);
            gathered = GatherSums::read(sums);
            let sums: &[[f32; 3]] = bytemuck::cast_slice(film);
            for (pixel, sum) in pixels.iter_mut().zip(sums) {
                *pixel = sum.map(|channel| (channel * share).min(f32::MAX));
            }
        })?;
        Ok(gathered)
    }
}

/// What a stage looks up that turns hits into anything: rays, paths and hits of the wave,
/// primitives, attributes, and materials with textures.
pub(super) fn surfaces<'a>(
    buffers: &'a FrameBuffers,
    primitives: &'a PrimitiveStore,
    attributes: &'a AttributeStore,
    scene: &'a SceneData,
) -> [BindingResource<'a>; 6] {
    let attributes = attributes.buffer();
    // Where there are no primitives none is looked up.
    let primitives = primitives.parts().next().map_or(attributes, |part| part.buffer);
    let FrameBuffers { rays, paths, hits, .. } = buffers;
    let [rays, paths, hits] = [rays, paths, hits].map(|buffer| whole(buffer.buffer()));
    [rays, paths, hits, whole(primitives), whole(attributes), whole(scene.entries())]
}

pub(super) fn whole(buffer: &wgpu::Buffer) -> BindingResource<'_> {
    buffer.as_entire_binding()
}

/// A workgroup for each tile of a wave.
pub(super) const fn tiles(params: &FrameParams) -> Groups<'static> {
    Groups::Count(params.slot_count as usize / TILE_RAYS)
}

fn add_logged(stats: &mut BandStats, logged: &Logged, pixel_count: u64) {
    let [mirrored, followed, shadow] =
        [MIRRORED, FOLLOWED, SHADOW].map(|kind| u64::from(logged.counts[kind]));
    let (stage, rays) = match logged.traced {
        Traced::Primary => {
            stats.scanned += if logged.asked == Asked::Scanned { pixel_count } else { 0 };
            (&mut stats.primary, pixel_count)
        }
        Traced::Secondary => {
            stats.mirror_rays += mirrored;
            (&mut stats.secondary, followed)
        }
        Traced::Shadow => (&mut stats.shadow, shadow),
    };
    *stage += trace_stats(logged, rays);
}

/// What tracing so many rays took.
pub(super) fn trace_stats(logged: &Logged, rays: u64) -> TraceStats {
    let tests = logged.tests();
    TraceStats {
        rays,
        cone_tests: tests.cones,
        triangle_tests: tests.triangles,
        sphere_tests: tests.spheres,
        pairs: tests.pairs,
        ..TraceStats::default()
    }
}
