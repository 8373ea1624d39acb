//! The hierarchical ray engine, as published: a hierarchy of rays, built on the device, that
//! decides which tiles of the target each primitive is drawn over.
//!
//! 1. **bound_primitives** writes the sphere around each primitive, when a frame is committed.
//! 2. **bound_tiles** computes the cone around the rays of each 8 x 8 tile, one texel a tile.
//! 3. **trace_tile** draws, for each tile, all primitives: the vertex stage asks the tile's cone
//!    about the primitive's sphere and moves what it rejects outside the clip volume; the fragment
//!    stage applies the exact test; the depth test keeps the nearest.
//!
//! **Source.** L. Szecsi, "The Hierarchical Ray Engine", WSCG 2006, and chapter 6 of his thesis.
//!
//! **Departures.** A tile is a triangle cut by the scissor, since points of WebGPU are one pixel
//! in size: three vertices a tile and primitive in place of one. Cones start from a sphere, so
//! that parallel rays and rays with many origins are bounded. Their texture is read by the vertex
//! stage, and never copied to the host. The next rays are written by the caller.
//!
//! **Cost.** Three cone tests for each tile and primitive; exact tests for each texel of the tiles
//! that are drawn.

use wgpu::{
    BindingResource, BufferUsages, CommandEncoder, CommandEncoderDescriptor, ComputePipeline,
    LoadOp, Operations, RenderPassColorAttachment, RenderPassDescriptor, RenderPipeline, StoreOp,
    Texture, TextureFormat, TextureUsages, VertexBufferLayout, VertexStepMode, vertex_attr_array,
};

use crate::buffer::{GrowingBuffer, ReadBack, bind, part_of};
use crate::method::{Method, Question, TestCounts};
use crate::pipeline::{compute_stage, draw_stage, groups_of};
use crate::primitives::{Part, PrimitiveStore};
use crate::ray_textures::{
    HIT_FORMAT, RayTextures, TILE_EDGE, TILES_PER_ROW, keep_nearest, new_texture, primitive_buffer,
};
use crate::shaders;
use crate::slots::{Run, TILE_RAYS};
use crate::{GpuContext, GpuError};

const CONE_FORMAT: TextureFormat = TextureFormat::Rgba32Float;

/// Bytes of a sphere.
const SPHERE_BYTES: usize = 16;

/// Cone tests that are asked of the device at a time.
const TESTS_PER_SUBMISSION: usize = 1 << 27;

/// Draws primitives over the tiles that may hit them.
#[derive(Debug)]
pub(crate) struct Raster {
    bound_primitives: ComputePipeline,
    bound_tiles: RenderPipeline,
    trace_tile: RenderPipeline,
    textures: RayTextures,
    cone_origins: Texture,
    cone_directions: Texture,
    /// Of each part of the primitives.
    spheres: Vec<GrowingBuffer>,
    /// How many tiles were drawn: a number of two words.
    drawn_tiles: GrowingBuffer,
    read_back: ReadBack,
}

impl Raster {
    pub(crate) fn new(context: &GpuContext) -> Self {
        let sphere = vertex_attr_array![6 => Float32x4];
        let spheres = VertexBufferLayout {
            array_stride: SPHERE_BYTES as u64,
            step_mode: VertexStepMode::Instance,
            attributes: &sphere,
        };
        let buffers = [Some(primitive_buffer()), Some(spheres)];
        let depth = Some(keep_nearest());
        let cones = |label| {
            let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
            new_texture(context, label, TILES_PER_ROW, CONE_FORMAT, usage)
        };
        Self {
            bound_primitives: compute_stage(context, shaders::BOUND_PRIMITIVES, &[]),
            bound_tiles: draw_stage(
                context,
                shaders::RASTER_BOUND_TILES,
                &[],
                &[CONE_FORMAT, CONE_FORMAT],
                None,
            ),
            trace_tile: draw_stage(
                context,
                shaders::RASTER_TRACE_TILE,
                &buffers,
                &[HIT_FORMAT],
                depth,
            ),
            textures: RayTextures::new(context),
            cone_origins: cones("cone origins"),
            cone_directions: cones("cone directions"),
            spheres: Vec::new(),
            drawn_tiles: GrowingBuffer::new("drawn tiles", BufferUsages::STORAGE),
            read_back: ReadBack::new(),
        }
    }

    /// Computes the cones of all tiles.
    fn bound_tiles(&self, context: &GpuContext, encoder: &mut CommandEncoder) {
        let layout = self.bound_tiles.get_bind_group_layout(0);
        let views = self.textures.views();
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
            label: Some("bound_tiles"),
            color_attachments: &[attachment(&origins), attachment(&directions)],
            ..Default::default()
        });
        pass.set_pipeline(&self.bound_tiles);
        pass.set_bind_group(0, &rays, &[]);
        pass.draw(0..3, 0..1);
    }

    /// Draws one part of the primitives over all tiles.
    fn draw_part(
        &self,
        context: &GpuContext,
        (part, spheres): (Part<'_>, &GrowingBuffer),
        tile_count: usize,
        mut is_first: bool,
    ) {
        let layout = self.trace_tile.get_bind_group_layout(0);
        let [origins, directions, masks] = self.textures.views();
        let [cone_origins, cone_directions] = [&self.cone_origins, &self.cone_directions]
            .map(|texture| texture.create_view(&Default::default()));
        let views = [&origins, &directions, &masks, &cone_origins, &cone_directions];
        let mut resources: Vec<_> = views.map(BindingResource::TextureView).into();
        resources.push(part_of(self.drawn_tiles.buffer(), 8));
        let tiles = bind(context, &layout, &resources);
        let step = (TESTS_PER_SUBMISSION / part.count).max(1);
        for first_tile in (0..tile_count).step_by(step) {
            let mut encoder =
                context.device.create_command_encoder(&CommandEncoderDescriptor::default());
            let mut pass = self.textures.begin(&mut encoder, is_first);
            pass.set_pipeline(&self.trace_tile);
            pass.set_bind_group(0, &tiles, &[]);
            pass.set_vertex_buffer(0, part.buffer.slice(..));
            pass.set_vertex_buffer(1, spheres.buffer().slice(..));
            for tile in first_tile..tile_count.min(first_tile + step) {
                let (x, y) = (tile % TILES_PER_ROW, tile / TILES_PER_ROW);
                let [x, y, edge] = [x * TILE_EDGE, y * TILE_EDGE, TILE_EDGE].map(|n| n as u32);
                pass.set_scissor_rect(x, y, edge, edge);
                let vertex = 3 * tile as u32;
                pass.draw(vertex..vertex + 3, 0..part.count as u32);
            }
            drop(pass);
            context.queue.submit([encoder.finish()]);
            is_first = false;
        }
    }

    /// How many tiles were drawn.
    fn read_drawn_tiles(&mut self, context: &GpuContext) -> Result<u64, GpuError> {
        let mut encoder =
            context.device.create_command_encoder(&CommandEncoderDescriptor::default());
        let target = self.read_back.target(context, 8);
        encoder.copy_buffer_to_buffer(self.drawn_tiles.buffer(), 0, &target, 0, Some(8));
        let mut drawn = 0;
        self.read_back.run(context, encoder, 8, |bytes| {
            drawn = bytemuck::pod_read_unaligned(bytes);
        })?;
        Ok(drawn)
    }
}

impl Method for Raster {
    fn prepare(&mut self, context: &GpuContext, primitives: &PrimitiveStore) {
        let usage = BufferUsages::STORAGE | BufferUsages::VERTEX;
        let part_count = primitives.parts().count();
        self.spheres.resize_with(part_count, || GrowingBuffer::new("spheres", usage));
        for (part, spheres) in primitives.parts().zip(&mut self.spheres) {
            let bytes = part.count * SPHERE_BYTES;
            let spheres = spheres.reserve(context, bytes);
            let layout = self.bound_primitives.get_bind_group_layout(0);
            let resources = [part_of(part.buffer, part.bytes()), part_of(spheres, bytes)];
            let bound = bind(context, &layout, &resources);
            let mut encoder =
                context.device.create_command_encoder(&CommandEncoderDescriptor::default());
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&self.bound_primitives);
            pass.set_bind_group(0, &bound, &[]);
            let [x, y] = groups_of(part.count.div_ceil(64));
            pass.dispatch_workgroups(x, y, 1);
            drop(pass);
            context.queue.submit([encoder.finish()]);
        }
    }

    fn trace(
        &mut self,
        context: &GpuContext,
        primitives: &PrimitiveStore,
        run: &mut Run,
        _: Question,
    ) -> Result<TestCounts, GpuError> {
        let prim_count: usize = primitives.parts().map(|part| part.count).sum();
        if prim_count == 0 {
            return Ok(TestCounts::default());
        }
        self.textures.send(context, &run.rays);
        self.drawn_tiles.write(context, &[0_u32; 2]);
        let mut encoder =
            context.device.create_command_encoder(&CommandEncoderDescriptor::default());
        self.bound_tiles(context, &mut encoder);
        context.queue.submit([encoder.finish()]);
        let tile_count = run.rays.len() / TILE_RAYS;
        for (idx, pair) in primitives.parts().zip(&self.spheres).enumerate() {
            self.draw_part(context, pair, tile_count, idx == 0);
        }
        self.textures.read(context, &mut self.read_back, &mut run.hits)?;
        let drawn = self.read_drawn_tiles(context)?;
        Ok(TestCounts {
            cones: (3 * tile_count * prim_count) as u64,
            // Of spheres too: the fragment stage counts tiles, whatever is drawn.
            triangles: drawn * TILE_RAYS as u64,
            spheres: 0,
            pairs: drawn,
        })
    }

    fn memory_usage(&self) -> usize {
        let cones = 2 * 16 * TILES_PER_ROW * TILES_PER_ROW;
        let spheres: u64 = self.spheres.iter().map(GrowingBuffer::size).sum();
        let others = spheres + self.drawn_tiles.size() + self.read_back.size();
        self.textures.memory_usage() + cones + others as usize
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use rayflock_geom::{FrameChanges, Geometry, GeometryObject, ObjectId};
    use rayflock_testkit::Rng;
    use rayflock_testkit::scenes::{SoupKind, spheres, triangle_soup};

    use super::*;
    use crate::testing::{contexts, near, read};
    use crate::twins::{self, DeviceSphere};

    /// Triangles and spheres, some of which are ignored.
    #[test]
    fn spheres_around_primitives_agree_with_their_twin() {
        let mut rng = Rng::new(53);
        let soup = triangle_soup(&mut rng, SoupKind::Plain, 100, Vec3::ZERO, 1.0);
        let mesh = soup.with_spheres(spheres(&mut rng, 50, Vec3::ZERO, 1.0));
        let geometry = Geometry::new(vec![GeometryObject::new(ObjectId(0), mesh)]).unwrap();
        for context in contexts() {
            let mut primitives = PrimitiveStore::default();
            primitives.commit(context, &geometry, &FrameChanges::all(), "gpu:raster").unwrap();
            let mut raster = Raster::new(context);
            raster.prepare(context, &primitives);
            let found: Vec<DeviceSphere> = read(context, raster.spheres[0].buffer(), 150);
            for (prim, sphere) in primitives.host().iter().zip(&found) {
                let expected = twins::bound_primitives(prim);
                assert!(near(sphere, &expected), "{prim:?}: {sphere:?}, not {expected:?}");
            }
        }
    }
}
