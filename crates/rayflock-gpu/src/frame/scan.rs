//! Primary visibility by scan conversion: what the rays from the camera hit is found by drawing the
//! primitives, not by tracing.
//!
//! 1. **scan_primitives** draws each primitive over the texels whose rays may hit it, one texel a
//!    pixel. The fragment stage applies the exact test to the ray of its texel and writes the
//!    distance as depth; the depth test keeps the nearest.
//! 2. **take_scanned** brings what was drawn to the hits of the wave.
//!
//! **Source.** L. Szecsi, "The Hierarchical Ray Engine", WSCG 2006: primary impact points come of
//! rendering the scene, and rays are traced from there. For outlines that leave no texel out, J.
//! Hasselgren, T. Akenine-Moeller, L. Ohlsson, "Conservative Rasterization", GPU Gems 2, 2005.
//!
//! **Departures.** What is covered and how deep it lies is the exact test's to say, not the
//! hardware's, so hits are those of tracing: outlines are a little larger than primitives, and
//! what lies at or behind a pinhole is drawn over the whole picture.
//!
//! **Invariants.** All rays are answered, none is left to trace. Of hits whose distances agree but
//! for their two lowest bits, that of the lowest rank is kept.
//!
//! **Cost.** Six runs of the vertex stage for each primitive, band and sample; a test for each
//! primitive and texel of its outline; 28 bytes a pixel of the band.

#[cfg(test)]
mod tests;

use glam::{DMat3, DVec3, Vec3};
use rayflock_engine::Budget;
use wgpu::{
    BindingResource, Buffer, BufferUsages, Color, Extent3d, LoadOp, Operations,
    RenderPassColorAttachment, RenderPassDepthStencilAttachment, RenderPassDescriptor, StoreOp,
    Texture, TextureDescriptor, TextureDimension, TextureFormat, TextureUsages,
};

use super::DeviceFrame;
use super::trace_log::{Asked, Traced};
use crate::GpuContext;
use crate::buffer::{GrowingBuffer, bind, part_of};
use crate::layout::{FrameParams, NO_RANK, ScanCounters, ScanParams};
use crate::pass::{Groups, StageEncoder};
use crate::pipeline::{ComputeStage, DrawStage, compute_stage, draw_stage};
use crate::primitives::Part;
use crate::ray_textures::{DEPTH_FORMAT, HIT_FORMAT, keep_nearest};
use crate::shaders;
use crate::slots::TILE_RAYS;

/// How a [`GpuRenderer`](crate::GpuRenderer) finds what the rays from the camera hit. Pictures are
/// the same but for hits that lie equally far to a few units in the last place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PrimaryVisibility {
    /// By drawing all primitives, with a depth test.
    #[default]
    ScanConverted,
    /// By the stages of the engine `gpu:compute`, like all other rays.
    Traced,
}

/// Texels that WebGPU guarantees along the side of a texture.
const MOST_TEXELS: u32 = 8192;

/// Vertices of the outline of a primitive.
const OUTLINE_VERTICES: usize = 6;

/// Words of a slot that count its tests.
const TEST_BYTES: usize = 2 * size_of::<u32>();

/// Draws primitives as the camera sees them.
#[derive(Debug)]
pub(super) struct Scan {
    scan_primitives: DrawStage,
    take_scanned: ComputeStage,
    target: Option<Target>,
    tests: GrowingBuffer,
    counters: GrowingBuffer,
    params: GrowingBuffer,
}

/// What is drawn to: a texel for each pixel of a band.
#[derive(Debug)]
struct Target {
    size: [u32; 2],
    hits: Texture,
    depths: Texture,
}

/// What is drawn: the rays from the camera, which are there, and the primitives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scanned<'a> {
    pub(super) rays: &'a Buffer,
    pub(super) hits: &'a Buffer,
    pub(super) primitives: Part<'a>,
    pub(super) slot_count: usize,
}

impl Scan {
    pub(super) fn new(context: &GpuContext) -> Self {
        let (shader, depth) = (shaders::SCAN_PRIMITIVES, Some(keep_nearest()));
        Self {
            scan_primitives: draw_stage(context, shader, &[], &[], &[HIT_FORMAT], depth),
            take_scanned: compute_stage(context, shaders::TAKE_SCANNED, &[]),
            target: None,
            tests: GrowingBuffer::storage("scan tests"),
            counters: GrowingBuffer::storage("scan counters"),
            params: GrowingBuffer::new("scan params", BufferUsages::UNIFORM),
        }
    }

    /// Finds what the rays of a band hit.
    pub(super) fn run(
        &mut self,
        encoder: &mut StageEncoder<'_>,
        params: &ScanParams,
        scanned: &Scanned<'_>,
    ) {
        let context = encoder.context;
        self.params.write(context, std::slice::from_ref(params));
        self.counters.reserve(context, size_of::<ScanCounters>());
        self.tests.reserve(context, scanned.slot_count * TEST_BYTES);
        let size = [params.width, params.row_count];
        let is_roomy = |target: &Target| target.size[0] >= size[0] && target.size[1] >= size[1];
        if !self.target.as_ref().is_some_and(is_roomy) {
            self.target = Some(Target::new(context, size));
        }
        encoder.encoder.clear_buffer(self.tests.buffer(), 0, None);
        encoder.encoder.clear_buffer(self.counters.buffer(), 0, None);
        if let Some(target) = &self.target {
            self.draw(encoder, target, size, scanned);
            self.take(encoder, target, scanned);
        }
    }

    /// Where the tests are counted.
    pub(super) fn counters(&self) -> &Buffer {
        self.counters.buffer()
    }

    fn draw(
        &self,
        encoder: &mut StageEncoder<'_>,
        target: &Target,
        [width, height]: [u32; 2],
        scanned: &Scanned<'_>,
    ) {
        let stage = &self.scan_primitives;
        let primitives = scanned.primitives;
        let resources = [
            part_of(primitives.buffer, primitives.bytes()),
            scanned.rays.as_entire_binding(),
            self.tests.buffer().as_entire_binding(),
            part_of(self.params.buffer(), size_of::<ScanParams>()),
        ];
        let layout = stage.pipeline.get_bind_group_layout(0);
        let group = bind(encoder.context, &layout, &resources);
        let [hits, depths] =
            [&target.hits, &target.depths].map(|texture| texture.create_view(&Default::default()));
        let nothing = Color { r: 0.0, g: 0.0, b: 0.0, a: f64::from(NO_RANK) };
        let mut pass = encoder.encoder.begin_render_pass(&RenderPassDescriptor {
            label: Some(stage.name),
            color_attachments: &[Some(RenderPassColorAttachment {
                view: &hits,
                depth_slice: None,
                resolve_target: None,
                ops: Operations { load: LoadOp::Clear(nothing), store: StoreOp::Store },
            })],
            depth_stencil_attachment: Some(RenderPassDepthStencilAttachment {
                view: &depths,
                depth_ops: Some(Operations { load: LoadOp::Clear(1.0), store: StoreOp::Discard }),
                stencil_ops: None,
            }),
            timestamp_writes: encoder.clock.render_pass(stage.name),
            ..Default::default()
        });
        pass.set_viewport(0.0, 0.0, width as f32, height as f32, 0.0, 1.0);
        pass.set_scissor_rect(0, 0, width, height);
        pass.set_pipeline(&stage.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..(OUTLINE_VERTICES * primitives.count) as u32, 0..1);
    }

    fn take(&self, encoder: &mut StageEncoder<'_>, target: &Target, scanned: &Scanned<'_>) {
        let drawn = target.hits.create_view(&Default::default());
        let resources = [
            BindingResource::TextureView(&drawn),
            self.tests.buffer().as_entire_binding(),
            scanned.hits.as_entire_binding(),
            part_of(self.counters.buffer(), size_of::<ScanCounters>()),
            part_of(self.params.buffer(), size_of::<ScanParams>()),
        ];
        let groups = Groups::Count(scanned.slot_count / TILE_RAYS);
        encoder.stage(&self.take_scanned, &resources, groups);
    }

    /// Tells what is held.
    pub(super) fn hold(&self, budget: &mut Budget) {
        let texel_bytes = (size_of::<[u32; 4]>() + size_of::<f32>()) as u64;
        let texels = |target: &Target| target.size.map(u64::from).iter().product::<u64>();
        budget.hold("scan targets", texel_bytes * self.target.as_ref().map_or(0, texels));
        [&self.tests, &self.counters, &self.params].iter().for_each(|buffer| buffer.hold(budget));
    }
}

impl Target {
    fn new(context: &GpuContext, size: [u32; 2]) -> Self {
        let texture = |label, format: TextureFormat, usage: TextureUsages| {
            context.device.create_texture(&TextureDescriptor {
                label: Some(label),
                size: Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: TextureDimension::D2,
                format,
                usage: usage | TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            })
        };
        Self {
            size,
            hits: texture("scanned hits", HIT_FORMAT, TextureUsages::TEXTURE_BINDING),
            depths: texture("scanned depths", DEPTH_FORMAT, TextureUsages::empty()),
        }
    }
}

impl DeviceFrame {
    /// Finds what the rays from the camera hit; tells if that was by scan conversion.
    pub(super) fn find_primary(&mut self, context: &GpuContext, params: &FrameParams) -> bool {
        let wanted = self.primary == PrimaryVisibility::ScanConverted;
        let scan_params = wanted.then(|| scan_params(params)).flatten();
        let (Some(scan_params), Some(primitives)) = (scan_params, self.primitives.parts().next())
        else {
            self.trace(context, Traced::Primary, params);
            return false;
        };
        let b = &self.buffers;
        let (rays, hits) = (b.rays.buffer(), b.hits.buffer());
        let scanned = Scanned { rays, hits, primitives, slot_count: params.slot_count as usize };
        let mut encoder = StageEncoder::new(context, &mut self.clock);
        self.scan.run(&mut encoder, &scan_params, &scanned);
        let counts = [self.scan.counters(), b.counts.buffer()];
        self.log.add(&mut encoder.encoder, Traced::Primary, Asked::Scanned, counts);
        encoder.submit();
        true
    }
}

/// How a band is drawn whose rays start as `frame` says; `None` where it cannot be: where no
/// texture is as large, or where the camera has no width, height or depth.
pub(super) fn scan_params(frame: &FrameParams) -> Option<ScanParams> {
    if frame.width.max(frame.row_count) > MOST_TEXELS {
        return None;
    }
    let is_parallel = frame.is_parallel != 0;
    let wide = |v: [f32; 3]| Vec3::from(v).as_dvec3();
    let (ahead, origin) =
        if is_parallel { (frame.eye, frame.top_left) } else { (frame.top_left, frame.eye) };
    let film_from_world =
        DMat3::from_cols(wide(frame.right), wide(frame.down), wide(ahead)).inverse().transpose();
    let rows = [film_from_world.x_axis, film_from_world.y_axis, film_from_world.z_axis]
        .map(DVec3::as_vec3);
    if !rows.iter().all(|row| row.is_finite() && *row != Vec3::ZERO) {
        return None;
    }
    let [column, row, depth] = rows.map(|row| row.to_array());
    let [x, y] = frame.subpixel;
    Some(ScanParams {
        column,
        width: frame.width,
        row,
        row_count: frame.row_count,
        depth,
        is_parallel: frame.is_parallel,
        origin,
        // The middle of a texel is where the sample lies in its pixel.
        shift: [0.5 - x, 0.5 - y - frame.first_row as f32],
        ..ScanParams::default()
    })
}
