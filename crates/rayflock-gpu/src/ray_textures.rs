//! Rays in textures and the target that keeps their nearest hits, for the engines that draw.
//!
//! ```text
//!   tile k of 8 x 8 texels at (k % 64, k / 64); slot s is in the tile s / 64, whose texels follow
//!   a Morton curve, so that tiles of 4 x 4 and of 2 x 2 texels are consecutive slots too
//! ```
//!
//! **Cost.** On the device 56 bytes a texel for 512 x 512 texels; on the host 36 bytes a texel for
//! the most rows that were sent at a time.

use rayflock_engine::Budget;
use wgpu::{
    Color, CommandEncoder, CommandEncoderDescriptor, CompareFunction, DepthStencilState, Extent3d,
    LoadOp, Operations, RenderPass, RenderPassColorAttachment, RenderPassDepthStencilAttachment,
    RenderPassDescriptor, RenderPassTimestampWrites, StoreOp, TexelCopyBufferInfo,
    TexelCopyBufferLayout, TexelCopyTextureInfo, Texture, TextureDescriptor, TextureDimension,
    TextureFormat, TextureUsages, TextureView, VertexAttribute, VertexBufferLayout, VertexStepMode,
    vertex_attr_array,
};

use crate::buffer::ReadBack;
use crate::layout::{DeviceHit, DevicePrimitive, DeviceRay, NO_RANK};
use crate::slots::{RUN_SLOTS, TILE_RAYS, place_in_tile};
use crate::{GpuContext, GpuError};

/// Texels along the side of a tile, and tiles along that of a texture.
const TILE_EDGE: usize = 8;
pub(crate) const TILES_PER_ROW: usize = 64;

/// Texels along the side of a texture, as in `shared/tiles.wgsl`.
pub(crate) const EDGE: usize = TILE_EDGE * TILES_PER_ROW;
const _: () = assert!(EDGE * EDGE == RUN_SLOTS && TILE_EDGE * TILE_EDGE == TILE_RAYS);

/// What is written for each ray: bits of `t`, `u` and `v`, and the rank.
pub(crate) const HIT_FORMAT: TextureFormat = TextureFormat::Rgba32Uint;
const RAY_FORMAT: TextureFormat = TextureFormat::Rgba32Float;
const MASK_FORMAT: TextureFormat = TextureFormat::R32Uint;
pub(crate) const DEPTH_FORMAT: TextureFormat = TextureFormat::Depth32Float;

/// The primitive of an instance, as vertex attributes.
pub(crate) const PRIMITIVE_ATTRIBUTES: [VertexAttribute; 6] = vertex_attr_array![
    0 => Float32x3, 1 => Uint32, 2 => Float32x3, 3 => Uint32, 4 => Float32x3, 5 => Uint32
];

/// A primitive an instance.
pub(crate) const fn primitive_buffer() -> VertexBufferLayout<'static> {
    VertexBufferLayout {
        array_stride: size_of::<DevicePrimitive>() as u64,
        step_mode: VertexStepMode::Instance,
        attributes: &PRIMITIVE_ATTRIBUTES,
    }
}

/// The nearest is kept; of equally near ones that which was drawn first, so the lowest rank.
pub(crate) fn keep_nearest() -> DepthStencilState {
    DepthStencilState {
        format: DEPTH_FORMAT,
        depth_write_enabled: Some(true),
        depth_compare: Some(CompareFunction::Less),
        stencil: Default::default(),
        bias: Default::default(),
    }
}

/// Rays in textures and the target of their hits.
#[derive(Debug)]
pub(crate) struct RayTextures {
    origins: Texture,
    directions: Texture,
    masks: Texture,
    hits: Texture,
    depths: Texture,
    /// Origins, directions and masks of the texels, as they are sent.
    staged: Staged,
}

#[derive(Debug, Default)]
struct Staged {
    origins: Vec<[f32; 4]>,
    directions: Vec<[f32; 4]>,
    masks: Vec<u32>,
}

impl Staged {
    /// Bytes held.
    fn memory_usage(&self) -> usize {
        let rays = self.origins.capacity() + self.directions.capacity();
        rays * size_of::<[f32; 4]>() + self.masks.capacity() * size_of::<u32>()
    }
}

impl RayTextures {
    pub(crate) fn new(context: &GpuContext) -> Self {
        let read = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
        let drawn = TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
        let texture = |label, format, usage| new_texture(context, label, EDGE, format, usage);
        Self {
            origins: texture("origins", RAY_FORMAT, read),
            directions: texture("directions", RAY_FORMAT, read),
            masks: texture("masks", MASK_FORMAT, read),
            hits: texture("hits", HIT_FORMAT, drawn),
            depths: texture("depths", DEPTH_FORMAT, TextureUsages::RENDER_ATTACHMENT),
            staged: Staged::default(),
        }
    }

    /// Origins, directions and masks.
    pub(crate) fn views(&self) -> [TextureView; 3] {
        [&self.origins, &self.directions, &self.masks]
            .map(|texture| texture.create_view(&Default::default()))
    }

    /// Brings rays to the textures.
    pub(crate) fn send(&mut self, context: &GpuContext, rays: &[DeviceRay]) {
        let texel_count = rows(rays.len()) * EDGE;
        let idle = DeviceRay::IDLE;
        let staged = &mut self.staged;
        staged.origins.clear();
        staged.directions.clear();
        staged.masks.clear();
        staged.origins.resize(texel_count, xyzw(idle.origin, idle.t_min));
        staged.directions.resize(texel_count, xyzw(idle.direction, idle.t_max));
        staged.masks.resize(texel_count, idle.mask);
        for (slot, ray) in rays.iter().enumerate() {
            let texel = texel_of(slot);
            staged.origins[texel] = xyzw(ray.origin, ray.t_min);
            staged.directions[texel] = xyzw(ray.direction, ray.t_max);
            staged.masks[texel] = ray.mask;
        }
        let size = used(rays.len());
        write(context, &self.origins, bytemuck::cast_slice(&staged.origins), size);
        write(context, &self.directions, bytemuck::cast_slice(&staged.directions), size);
        write(context, &self.masks, bytemuck::cast_slice(&staged.masks), size);
    }

    /// Begins to draw hits, after those that are there unless it is the `first` time.
    pub(crate) fn begin<'a>(
        &self,
        encoder: &'a mut CommandEncoder,
        timestamp_writes: Option<RenderPassTimestampWrites<'_>>,
        first: bool,
    ) -> RenderPass<'a> {
        let none = f64::from(NO_RANK);
        let clear = Color { r: 0.0, g: 0.0, b: 0.0, a: none };
        let view = |texture: &Texture| texture.create_view(&Default::default());
        encoder.begin_render_pass(&RenderPassDescriptor {
            label: Some("hits"),
            color_attachments: &[Some(RenderPassColorAttachment {
                view: &view(&self.hits),
                depth_slice: None,
                resolve_target: None,
                ops: Operations { load: load_or(first, clear), store: StoreOp::Store },
            })],
            depth_stencil_attachment: Some(RenderPassDepthStencilAttachment {
                view: &view(&self.depths),
                depth_ops: Some(Operations { load: load_or(first, 1.0), store: StoreOp::Store }),
                stencil_ops: None,
            }),
            timestamp_writes,
            ..Default::default()
        })
    }

    /// Runs what is encoded, and reads the hits back.
    ///
    /// # Errors
    /// [`GpuError::Lost`] when the device fails.
    pub(crate) fn read(
        &self,
        context: &GpuContext,
        read_back: &mut ReadBack,
        hits: &mut [DeviceHit],
    ) -> Result<(), GpuError> {
        let row_bytes = EDGE * size_of::<DeviceHit>();
        let bytes = rows(hits.len()) * row_bytes;
        let target = read_back.target(context, bytes);
        let mut encoder =
            context.device.create_command_encoder(&CommandEncoderDescriptor::default());
        encoder.copy_texture_to_buffer(
            whole(&self.hits),
            TexelCopyBufferInfo { buffer: &target, layout: layout(row_bytes) },
            used(hits.len()),
        );
        read_back.run(context, encoder, bytes, |bytes| {
            let texels: &[[u32; 4]] = bytemuck::cast_slice(bytes);
            for (slot, hit) in hits.iter_mut().enumerate() {
                let [t, u, v, rank] = texels[texel_of(slot)];
                if rank != NO_RANK {
                    let [t, u, v] = [t, u, v].map(f32::from_bits);
                    *hit = DeviceHit { t, u, v, rank };
                }
            }
        })
    }

    /// Tells what is held, on either side.
    pub(crate) fn hold(&self, budget: &mut Budget) {
        let texels = (EDGE * EDGE) as u64;
        budget.hold("ray textures", texels * (2 * 16 + 4));
        budget.hold("hit textures", texels * (16 + 4));
        budget.hold("staged rays", self.staged.memory_usage() as u64);
    }
}

/// A square texture.
pub(crate) fn new_texture(
    context: &GpuContext,
    label: &str,
    edge: usize,
    format: TextureFormat,
    usage: TextureUsages,
) -> Texture {
    context.device.create_texture(&TextureDescriptor {
        label: Some(label),
        size: Extent3d { width: edge as u32, height: edge as u32, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

/// Rows of texels that so many slots take.
pub(crate) const fn rows(slot_count: usize) -> usize {
    slot_count.div_ceil(TILE_RAYS).div_ceil(TILES_PER_ROW) * TILE_EDGE
}

/// Where a slot is, row by row.
const fn texel_of(slot: usize) -> usize {
    let (tile, place) = (slot / TILE_RAYS, slot % TILE_RAYS);
    let [column, row] = place_in_tile(place);
    let x = tile % TILES_PER_ROW * TILE_EDGE + column;
    let y = tile / TILES_PER_ROW * TILE_EDGE + row;
    y * EDGE + x
}

const fn xyzw([x, y, z]: [f32; 3], w: f32) -> [f32; 4] {
    [x, y, z, w]
}

fn load_or<T>(first: bool, clear: T) -> LoadOp<T> {
    if first { LoadOp::Clear(clear) } else { LoadOp::Load }
}

fn used(slot_count: usize) -> Extent3d {
    Extent3d { width: EDGE as u32, height: rows(slot_count) as u32, depth_or_array_layers: 1 }
}

fn layout(row_bytes: usize) -> TexelCopyBufferLayout {
    TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row_bytes as u32), rows_per_image: None }
}

/// All of a texture, to be copied.
pub(crate) fn whole(texture: &Texture) -> TexelCopyTextureInfo<'_> {
    TexelCopyTextureInfo {
        texture,
        mip_level: 0,
        origin: Default::default(),
        aspect: Default::default(),
    }
}

fn write(context: &GpuContext, texture: &Texture, bytes: &[u8], size: Extent3d) {
    let row_bytes = bytes.len() / size.height as usize;
    context.queue.write_texture(whole(texture), bytes, layout(row_bytes), size);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_slot_has_a_texel_of_its_own() {
        let mut taken = vec![false; RUN_SLOTS];
        for slot in 0..RUN_SLOTS {
            assert!(!std::mem::replace(&mut taken[texel_of(slot)], true));
        }
        assert_eq!((texel_of(65), texel_of(66), texel_of(64 * 64)), (9, 8 + EDGE, 8 * EDGE));
        assert_eq!((rows(64), rows(64 * 64), rows(64 * 64 + 64)), (8, 8, 16));
    }
}
