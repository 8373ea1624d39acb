//! The hierarchical ray engine, as published: a hierarchy of rays, built on the device, that
//! decides which tiles of the target each primitive is drawn over.
//!
//! 1. **bound_primitives** writes the sphere around each primitive, when a frame is committed.
//! 2. **bound_tiles** computes the cones around the rays of tiles of 8 x 8, 4 x 4 and 2 x 2 texels, a
//!    pass a size, one texel a tile.
//! 3. **choose_tiles**, on the host, takes small tiles where the cones of larger ones are wide.
//! 4. **trace_tile** draws, for each tile, all primitives: the vertex stage asks the tile's cone
//!    about the primitive's sphere and moves what it rejects outside the clip volume; the fragment
//!    stage applies the exact test; the depth test keeps the nearest.
//!
//! **Source.** L. Szecsi, "The Hierarchical Ray Engine", WSCG 2006, and chapter 6 of his thesis.
//!
//! **Departures.** A tile is a triangle cut by the scissor, since points of WebGPU are one pixel
//! in size: three vertices a tile and primitive in place of one. Cones start from a sphere, so
//! that parallel rays and rays with many origins are bounded. The vertex stage reads them from
//! their texture; the host, to which the paper copies them, only chooses by them how large tiles
//! are, which the paper leaves the same throughout. The next rays are written by the caller.
//!
//! **Cost.** Three cone tests for each tile and primitive; exact tests for each texel of the tiles
//! that are drawn; a wait for the cones.

mod choose_tiles;
mod level;

use rayflock_engine::Budget;
use wgpu::{BufferUsages, CommandEncoderDescriptor};

use self::choose_tiles::{Chosen, choose_tiles};
use self::level::{EDGES, Level, SPHERE_BYTES, count_buffer};
use crate::buffer::{GrowingBuffer, ReadBack, part_of};
use crate::method::{Method, Question, TestCounts};
use crate::pass::{Groups, StageEncoder};
use crate::pipeline::{ComputeStage, compute_stage};
use crate::primitives::{Part, PrimitiveStore};
use crate::ray_textures::RayTextures;
use crate::shaders;
use crate::slots::{Run, TILE_RAYS};
use crate::stage_clock::StageClock;
use crate::{GpuContext, GpuError};

/// Cone tests that are asked of the device at a time.
const TESTS_PER_SUBMISSION: usize = 1 << 27;

/// Draws primitives over the tiles that may hit them.
#[derive(Debug)]
pub(crate) struct Raster {
    bound_primitives: ComputeStage,
    levels: [Level; EDGES.len()],
    textures: RayTextures,
    /// Of each part of the primitives.
    spheres: Vec<GrowingBuffer>,
    /// How many texels were drawn: a number of two words.
    drawn: GrowingBuffer,
    read_back: ReadBack,
}

impl Raster {
    pub(crate) fn new(context: &GpuContext) -> Self {
        Self {
            bound_primitives: compute_stage(context, shaders::BOUND_PRIMITIVES, &[]),
            levels: EDGES.map(|edge| Level::new(context, edge)),
            textures: RayTextures::new(context),
            spheres: Vec::new(),
            drawn: count_buffer(),
            read_back: ReadBack::new(),
        }
    }

    /// Computes the cones of the tiles of all sizes, and chooses among them.
    fn choose_tiles(
        &mut self,
        context: &GpuContext,
        clock: &mut StageClock,
        tile_count: usize,
    ) -> Result<Chosen, GpuError> {
        let bytes = self.levels.each_ref().map(Level::direction_bytes);
        let target = self.read_back.target(context, bytes.iter().sum());
        let mut encoder =
            context.device.create_command_encoder(&CommandEncoderDescriptor::default());
        let mut offset = 0;
        for (level, bytes) in self.levels.iter().zip(bytes) {
            level.bound_tiles(context, clock, &self.textures, &mut encoder);
            level.copy_directions(&mut encoder, &target, offset);
            offset += bytes;
        }
        let mut sines = [const { Vec::new() }; EDGES.len()];
        self.read_back.run(context, encoder, offset, |mut all| {
            for (sines, bytes) in sines.iter_mut().zip(bytes) {
                let of_level;
                (of_level, all) = all.split_at(bytes);
                let halves: &[[f32; 4]] = bytemuck::cast_slice(of_level);
                *sines = halves.iter().map(|half| half[3]).collect();
            }
        })?;
        Ok(choose_tiles(&sines, tile_count))
    }

    /// Draws one part of the primitives over the chosen tiles.
    fn draw_part(
        &self,
        context: &GpuContext,
        clock: &mut StageClock,
        (part, spheres): (Part<'_>, &GrowingBuffer),
        chosen: &Chosen,
        mut is_first: bool,
    ) {
        let step = (TESTS_PER_SUBMISSION / part.count).max(1);
        for (level, tiles) in self.levels.iter().zip(chosen) {
            let rays = level.bind_rays(context, &self.textures, &self.drawn);
            for tiles in tiles.chunks(step) {
                let mut encoder =
                    context.device.create_command_encoder(&CommandEncoderDescriptor::default());
                let timed = clock.render_pass(level.trace_tile.name);
                let mut pass = self.textures.begin(&mut encoder, timed, is_first);
                pass.set_pipeline(&level.trace_tile.pipeline);
                pass.set_bind_group(0, &rays, &[]);
                pass.set_vertex_buffer(0, part.buffer.slice(..));
                pass.set_vertex_buffer(1, spheres.buffer().slice(..));
                for &tile in tiles {
                    level.draw_tile(&mut pass, tile, part.count);
                }
                drop(pass);
                context.queue.submit([encoder.finish()]);
                is_first = false;
            }
        }
    }
}

impl Method for Raster {
    fn prepare(
        &mut self,
        context: &GpuContext,
        clock: &mut StageClock,
        primitives: &PrimitiveStore,
    ) {
        let usage = BufferUsages::STORAGE | BufferUsages::VERTEX;
        let part_count = primitives.parts().count();
        self.spheres.resize_with(part_count, || GrowingBuffer::new("spheres", usage));
        let mut encoder = StageEncoder::new(context, clock);
        for (part, spheres) in primitives.parts().zip(&mut self.spheres) {
            let bytes = part.count * SPHERE_BYTES;
            let spheres = spheres.reserve(context, bytes);
            let resources = [part_of(part.buffer, part.bytes()), part_of(spheres, bytes)];
            let groups = Groups::Count(part.count.div_ceil(64));
            encoder.stage(&self.bound_primitives, &resources, groups);
        }
        encoder.submit();
    }

    fn trace(
        &mut self,
        context: &GpuContext,
        clock: &mut StageClock,
        primitives: &PrimitiveStore,
        run: &mut Run,
        _: Question,
    ) -> Result<TestCounts, GpuError> {
        let prim_count: usize = primitives.parts().map(|part| part.count).sum();
        if prim_count == 0 {
            return Ok(TestCounts::default());
        }
        self.textures.send(context, &run.rays);
        self.drawn.write(context, &[0_u64]);
        let chosen = self.choose_tiles(context, clock, run.rays.len() / TILE_RAYS)?;
        let tile_count: usize = chosen.iter().map(Vec::len).sum();
        if tile_count == 0 {
            return Ok(TestCounts::default());
        }
        for (idx, pair) in primitives.parts().zip(&self.spheres).enumerate() {
            self.draw_part(context, clock, pair, &chosen, idx == 0);
        }
        self.textures.read(context, &mut self.read_back, &mut run.hits)?;
        let encoder = context.device.create_command_encoder(&Default::default());
        let drawn = self.read_back.run_for_number(context, encoder, self.drawn.buffer())?;
        Ok(TestCounts {
            cones: (3 * tile_count * prim_count) as u64,
            // Of spheres too: the fragment stage counts texels, whatever is drawn.
            triangles: drawn,
            ..TestCounts::default()
        })
    }

    fn hold(&self, budget: &mut Budget) {
        self.textures.hold(budget);
        let cones: usize = self.levels.iter().map(|level| 2 * level.direction_bytes()).sum();
        budget.hold("cones", cones as u64);
        self.spheres.iter().for_each(|spheres| spheres.hold(budget));
        self.drawn.hold(budget);
        self.read_back.hold(budget);
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
            raster.prepare(context, &mut StageClock::new(context), &primitives);
            let found: Vec<DeviceSphere> = read(context, raster.spheres[0].buffer(), 150);
            for (prim, sphere) in primitives.host().iter().zip(&found) {
                let expected = twins::bound_primitives(prim);
                assert!(near(sphere, &expected), "{prim:?}: {sphere:?}, not {expected:?}");
            }
        }
    }
}
