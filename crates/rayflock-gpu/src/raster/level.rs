//! Tiles of one size: their cones, and the stages that compute and draw them.

use wgpu::{
    BindGroup, BindingResource, Buffer, CommandEncoder, Extent3d, LoadOp, Operations, RenderPass,
    RenderPassColorAttachment, RenderPassDescriptor, StoreOp, TexelCopyBufferInfo,
    TexelCopyBufferLayout, Texture, TextureFormat, TextureUsages, VertexBufferLayout,
    VertexStepMode, vertex_attr_array,
};

use crate::GpuContext;
use crate::buffer::{GrowingBuffer, bind, part_of};
use crate::pipeline::{DrawStage, draw_stage};
use crate::ray_textures::{
    EDGE, HIT_FORMAT, RayTextures, keep_nearest, new_texture, primitive_buffer, whole,
};
use crate::shaders;
use crate::stage_clock::StageClock;

/// Texels along the side of a tile, level by level.
pub(super) const EDGES: [usize; 3] = [8, 4, 2];

/// Bytes of a sphere, and of half a cone.
pub(super) const SPHERE_BYTES: usize = 16;
const HALF_CONE_BYTES: usize = 16;

const CONE_FORMAT: TextureFormat = TextureFormat::Rgba32Float;

/// Tiles of one size.
#[derive(Debug)]
pub(super) struct Level {
    edge: usize,
    bound_tiles: DrawStage,
    pub(super) trace_tile: DrawStage,
    cone_origins: Texture,
    cone_directions: Texture,
}

impl Level {
    pub(super) fn new(context: &GpuContext, edge: usize) -> Self {
        let sphere = vertex_attr_array![6 => Float32x4];
        let spheres = VertexBufferLayout {
            array_stride: SPHERE_BYTES as u64,
            step_mode: VertexStepMode::Instance,
            attributes: &sphere,
        };
        let cones = |label, copied| {
            let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING | copied;
            new_texture(context, label, EDGE / edge, CONE_FORMAT, usage)
        };
        let constants = [("TILE_EDGE", edge as f64)];
        Self {
            edge,
            bound_tiles: draw_stage(
                context,
                shaders::RASTER_BOUND_TILES,
                &constants,
                &[],
                &[CONE_FORMAT; 2],
                None,
            ),
            trace_tile: draw_stage(
                context,
                shaders::RASTER_TRACE_TILE,
                &constants,
                &[Some(primitive_buffer()), Some(spheres)],
                &[HIT_FORMAT],
                Some(keep_nearest()),
            ),
            cone_origins: cones("cone origins", TextureUsages::empty()),
            cone_directions: cones("cone directions", TextureUsages::COPY_SRC),
        }
    }

    /// Tiles along the side of the target.
    const fn tiles_per_row(&self) -> usize {
        EDGE / self.edge
    }

    /// Bytes of all half cones: axes and sines.
    pub(super) const fn direction_bytes(&self) -> usize {
        self.tiles_per_row() * self.tiles_per_row() * HALF_CONE_BYTES
    }

    /// Computes the cones of all tiles.
    pub(super) fn bound_tiles(
        &self,
        context: &GpuContext,
        clock: &mut StageClock,
        textures: &RayTextures,
        encoder: &mut CommandEncoder,
    ) {
        let layout = self.bound_tiles.pipeline.get_bind_group_layout(0);
        let views = textures.views();
        let rays = bind(context, &layout, &views.each_ref().map(BindingResource::TextureView));
        let [origins, directions] = [&self.cone_origins, &self.cone_directions]
            .map(|texture| texture.create_view(&Default::default()));
        let attachment = |view| {
            Some(RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: Operations { load: LoadOp::Clear(Default::default()), store: StoreOp::Store },
            })
        };
        let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
            label: Some(self.bound_tiles.name),
            color_attachments: &[attachment(&origins), attachment(&directions)],
            timestamp_writes: clock.render_pass(self.bound_tiles.name),
            ..Default::default()
        });
        pass.set_pipeline(&self.bound_tiles.pipeline);
        pass.set_bind_group(0, &rays, &[]);
        pass.draw(0..3, 0..1);
    }

    /// Copies axes and sines of all cones to a buffer.
    pub(super) fn copy_directions(
        &self,
        encoder: &mut CommandEncoder,
        target: &Buffer,
        offset: usize,
    ) {
        let side = self.tiles_per_row();
        let layout = TexelCopyBufferLayout {
            offset: offset as u64,
            bytes_per_row: Some((side * HALF_CONE_BYTES) as u32),
            rows_per_image: None,
        };
        let size = Extent3d { width: side as u32, height: side as u32, depth_or_array_layers: 1 };
        encoder.copy_texture_to_buffer(
            whole(&self.cone_directions),
            TexelCopyBufferInfo { buffer: target, layout },
            size,
        );
    }

    /// What tiles of this level are drawn with.
    pub(super) fn bind_rays(
        &self,
        context: &GpuContext,
        textures: &RayTextures,
        drawn: &GrowingBuffer,
    ) -> BindGroup {
        let layout = self.trace_tile.pipeline.get_bind_group_layout(0);
        let [origins, directions, masks] = textures.views();
        let [cone_origins, cone_directions] = [&self.cone_origins, &self.cone_directions]
            .map(|texture| texture.create_view(&Default::default()));
        let views = [&origins, &directions, &masks, &cone_origins, &cone_directions];
        let mut resources: Vec<_> = views.map(BindingResource::TextureView).into();
        resources.push(part_of(drawn.buffer(), size_of::<u64>()));
        bind(context, &layout, &resources)
    }

    /// Draws so many primitives over a tile.
    pub(super) fn draw_tile(&self, pass: &mut RenderPass<'_>, [x, y]: [u32; 2], count: usize) {
        let edge = self.edge as u32;
        pass.set_scissor_rect(x * edge, y * edge, edge, edge);
        let vertex = 3 * (y * self.tiles_per_row() as u32 + x);
        pass.draw(vertex..vertex + 3, 0..count as u32);
    }
}

/// Where the counts of drawn texels lie.
pub(super) const fn count_buffer() -> GrowingBuffer {
    GrowingBuffer::storage("drawn texels")
}
