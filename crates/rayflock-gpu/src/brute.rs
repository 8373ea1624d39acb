//! The ray engine: every primitive is drawn over all rays.
//!
//! Rays lie in textures. Each primitive is one instance of a triangle that covers the target; the
//! fragment stage applies the exact test to the ray of its texel and writes the distance as depth;
//! the depth test keeps the nearest, and of equally near ones the first, which has the lowest
//! rank. It is what the other engines of this crate are measured by.
//!
//! **Source.** N. Carr, J. Hall, J. Hart, "The Ray Engine", Graphics Hardware 2002.
//!
//! **Departures.** All primitives are instances of one draw. Distances are brought to depths by
//! their bits, without the two lowest: among hits that agree in all others, the lowest rank is
//! kept. Masks lie in a texture of their own.
//!
//! **Cost.** Texels times primitives; draws are cut so that the device is not busy for seconds.

use rayflock_engine::Budget;
use wgpu::{BindingResource, CommandEncoderDescriptor};

use crate::buffer::{ReadBack, bind};
use crate::method::{Method, Question, TestCounts};
use crate::pipeline::{DrawStage, draw_stage};
use crate::primitives::PrimitiveStore;
use crate::ray_textures::{EDGE, HIT_FORMAT, RayTextures, keep_nearest, primitive_buffer, rows};
use crate::shaders;
use crate::slots::Run;
use crate::stage_clock::StageClock;
use crate::{GpuContext, GpuError};

/// Tests that are asked of the device at a time: tenths of a second on a card.
const TESTS_PER_SUBMISSION: usize = 1 << 30;

/// Draws every primitive over all rays.
#[derive(Debug)]
pub(crate) struct Brute {
    cross: DrawStage,
    textures: RayTextures,
    read_back: ReadBack,
}

impl Brute {
    pub(crate) fn new(context: &GpuContext) -> Self {
        let buffers = [Some(primitive_buffer())];
        let depth = Some(keep_nearest());
        let cross = draw_stage(context, shaders::BRUTE_CROSS, &[], &buffers, &[HIT_FORMAT], depth);
        Self { cross, textures: RayTextures::new(context), read_back: ReadBack::new() }
    }

    /// Draws all primitives; returns how many there are.
    fn draw(
        &self,
        context: &GpuContext,
        clock: &mut StageClock,
        primitives: &PrimitiveStore,
        height: usize,
    ) -> usize {
        let views = self.textures.views();
        let layout = self.cross.pipeline.get_bind_group_layout(0);
        let rays = bind(context, &layout, &views.each_ref().map(BindingResource::TextureView));
        let step = (TESTS_PER_SUBMISSION / (height * EDGE)).max(1);
        let mut drawn_count = 0;
        for part in primitives.parts() {
            for first in (0..part.count).step_by(step) {
                let mut encoder =
                    context.device.create_command_encoder(&CommandEncoderDescriptor::default());
                let timed = clock.render_pass(self.cross.name);
                let mut pass = self.textures.begin(&mut encoder, timed, drawn_count == 0);
                pass.set_scissor_rect(0, 0, EDGE as u32, height as u32);
                pass.set_pipeline(&self.cross.pipeline);
                pass.set_bind_group(0, &rays, &[]);
                pass.set_vertex_buffer(0, part.buffer.slice(..));
                let end = part.count.min(first + step);
                pass.draw(0..3, first as u32..end as u32);
                drop(pass);
                context.queue.submit([encoder.finish()]);
                drawn_count += end - first;
            }
        }
        drawn_count
    }
}

impl Method for Brute {
    fn prepare(&mut self, _: &GpuContext, _: &mut StageClock, _: &PrimitiveStore) {}

    fn trace(
        &mut self,
        context: &GpuContext,
        clock: &mut StageClock,
        primitives: &PrimitiveStore,
        run: &mut Run,
        _: Question,
    ) -> Result<TestCounts, GpuError> {
        self.textures.send(context, &run.rays);
        let height = rows(run.rays.len());
        let drawn_count = self.draw(context, clock, primitives, height);
        if drawn_count > 0 {
            self.textures.read(context, &mut self.read_back, &mut run.hits)?;
        }
        let tests = |count: usize| (height * EDGE * count) as u64;
        let sphere_count = primitives.sphere_count();
        Ok(TestCounts {
            triangles: tests(drawn_count - sphere_count),
            spheres: tests(sphere_count),
            ..TestCounts::default()
        })
    }

    fn hold(&self, budget: &mut Budget) {
        self.textures.hold(budget);
        self.read_back.hold(budget);
    }
}
