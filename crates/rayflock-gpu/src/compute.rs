//! A tree of cones over the rays, and pairs of cones and chunks refined by compaction: today's form
//! of the hierarchical ray engine.
//!
//! 1. **bound_chunks** writes the sphere around each chunk of 16 consecutive primitives, when a
//!    frame is committed.
//! 2. **bound_tiles** and **bound_nodes** compute the cones of tiles of 64 rays, of 16 tiles, and of
//!    16 of those, bottom up.
//! 3. **seed_pairs** asks the roots about all chunks; **refine** asks the children of each pair, two
//!    times. What touches is appended, and the next stage is dispatched by its count.
//! 4. **plan_lists** and **fill_lists** bring the chunks of each tile together.
//! 5. **trace_tile** goes through them from near to far, one workgroup a tile.
//!
//! **Source.** L. Szecsi, "The Hierarchical Ray Engine", WSCG 2006; D. Roger, U. Assarsson, N.
//! Holzschuch, "Whitted Ray-Tracing for Dynamic Scenes using a Ray-Space Hierarchy on the GPU",
//! EGSR 2007.
//!
//! **Departures** from the latter: pairs name chunks, not triangles, until the tile is reached, so
//! that lists are short; sixteen children a node; three levels, whatever the number of rays.
//!
//! **Invariants.** No pair is dropped: where there are more than a buffer holds, it grows, up to
//! what WebGPU guarantees, and then the rays are split.
//!
//! **Cost.** Roots times chunks, and what is left of them; 20 bytes of pairs and lists each.

mod buffers;
mod stages;
#[cfg(test)]
mod tests;

use std::ops::Range;

use wgpu::{CommandEncoder, ComputePass, ComputePipeline};

use self::buffers::Buffers;
use self::stages::Stages;
use crate::buffer::{GrowingBuffer, bind, part_of, range_of};
use crate::layout::{Counters, DeviceHit, DeviceRay, Params};
use crate::method::{Method, Question, TestCounts};
use crate::pipeline::groups_of;
use crate::primitives::{Part, PrimitiveStore};
use crate::slots::{RUN_SLOTS, Run, TILE_RAYS};
use crate::{GpuContext, GpuError};

/// As in `compute/params.wgsl`.
pub(crate) const CHUNK_PRIMS: usize = 16;
pub(crate) const FAN_OUT: usize = 16;

/// Where the cones of nodes and of roots begin, as in `compute/params.wgsl`.
pub(crate) const FIRST_NODE: usize = RUN_SLOTS / TILE_RAYS;
pub(crate) const FIRST_ROOT: usize = FIRST_NODE + FIRST_NODE / FAN_OUT;

/// Pairs that a buffer has room for at first, and at most: 64 MiB.
const FIRST_CAPACITY: usize = 1 << 18;
const LARGEST_CAPACITY: usize = 1 << 23;

/// Bytes of a sphere.
const SPHERE_BYTES: usize = 16;

/// Traces by a tree of cones.
#[derive(Debug)]
pub(crate) struct Compute {
    stages: Stages,
    buffers: Buffers,
    /// The spheres around the chunks of each part of the primitives.
    chunks: Vec<GrowingBuffer>,
    pair_capacity: usize,
    largest_capacity: usize,
}

/// What is traced at a time: some tiles against one part of the primitives.
#[derive(Clone, Debug)]
struct Span<'a> {
    part: Part<'a>,
    part_idx: usize,
    tiles: Range<usize>,
    question: Question,
}

impl Span<'_> {
    fn chunk_count(&self) -> usize {
        self.part.count.div_ceil(CHUNK_PRIMS)
    }

    fn node_count(&self) -> usize {
        self.tiles.len().div_ceil(FAN_OUT)
    }

    fn root_count(&self) -> usize {
        self.node_count().div_ceil(FAN_OUT)
    }

    /// Both halves.
    fn halves(&self) -> [Self; 2] {
        let middle = self.tiles.start + self.tiles.len() / 2;
        let with = |tiles| Self { tiles, ..self.clone() };
        [with(self.tiles.start..middle), with(middle..self.tiles.end)]
    }

    fn counts(&self, found: &Counters) -> TestCounts {
        let children = FAN_OUT * (found.root_pairs + found.node_pairs) as usize;
        let asked = self.root_count() * self.chunk_count() + children;
        TestCounts {
            cones: asked as u64 + CHUNK_PRIMS as u64 * u64::from(found.chunk_tests),
            triangles: TILE_RAYS as u64 * u64::from(found.triangle_tests),
            spheres: TILE_RAYS as u64 * u64::from(found.sphere_tests),
            pairs: [found.root_pairs, found.node_pairs, found.tile_pairs]
                .map(u64::from)
                .iter()
                .sum(),
        }
    }
}

impl Compute {
    pub(crate) fn new(context: &GpuContext) -> Self {
        Self::with_capacity(context, FIRST_CAPACITY, LARGEST_CAPACITY)
    }

    /// With room for so many pairs at first, and at most.
    fn with_capacity(context: &GpuContext, pair_capacity: usize, largest_capacity: usize) -> Self {
        Self {
            stages: Stages::new(context),
            buffers: Buffers::new(),
            chunks: Vec::new(),
            pair_capacity,
            largest_capacity,
        }
    }

    /// Traces a span; as halves, where it makes more pairs than buffers can hold.
    fn trace_span(
        &mut self,
        context: &GpuContext,
        span: &Span<'_>,
        hits: &mut [DeviceHit],
    ) -> Result<TestCounts, GpuError> {
        loop {
            let found = self.run_span(context, span, hits)?;
            let needed = found.root_pairs.max(found.node_pairs).max(found.tile_pairs) as usize;
            if needed <= self.pair_capacity {
                return Ok(span.counts(&found));
            }
            // A single tile makes no more pairs than there are chunks.
            let largest = self.largest_capacity.max(span.chunk_count());
            if needed > largest && span.tiles.len() > 1 {
                let [first, second] = span.halves();
                let counts = self.trace_span(context, &first, hits)?;
                return Ok(counts + self.trace_span(context, &second, hits)?);
            }
            self.pair_capacity = needed.next_power_of_two();
        }
    }

    /// Runs all stages for a span once. Hits that it finds are right, but some are missing where
    /// the counters tell of more pairs than there was room for.
    fn run_span(
        &mut self,
        context: &GpuContext,
        span: &Span<'_>,
        hits: &mut [DeviceHit],
    ) -> Result<Counters, GpuError> {
        let params = Params {
            tile_count: span.tiles.len() as u32,
            chunk_count: span.chunk_count() as u32,
            pair_capacity: self.pair_capacity as u32,
            question: span.question as u32,
        };
        self.buffers.reserve(context, &params);
        let mut encoder = context.device.create_command_encoder(&Default::default());
        self.buffers.clear(&mut encoder);
        self.encode_stages(context, span, &mut encoder);
        self.buffers.read(context, encoder, hits)
    }

    fn encode_stages(&self, context: &GpuContext, span: &Span<'_>, encoder: &mut CommandEncoder) {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        let mut run = Encoder { context, pass: &mut pass };
        self.encode_cones(span, &mut run);
        self.encode_refinement(span, &mut run);
        self.encode_lists(&mut run);
        self.encode_trace(span, &mut run);
    }

    fn encode_cones(&self, span: &Span<'_>, run: &mut Encoder<'_, '_>) {
        let (stages, buffers) = (&self.stages, &self.buffers);
        let rays = self.rays_of(span);
        run.stage(&stages.bound_tiles, &[rays, buffers.cones()]);
        run.dispatch(span.tiles.len());
        for (stage, count) in
            [(&stages.bound_nodes, span.node_count()), (&stages.bound_roots, span.root_count())]
        {
            run.stage(stage, &[buffers.cones(), buffers.params()]);
            run.dispatch(count.div_ceil(64));
        }
    }

    fn encode_refinement(&self, span: &Span<'_>, run: &mut Encoder<'_, '_>) {
        let (stages, b) = (&self.stages, &self.buffers);
        let chunks = self.chunks_of(span);
        let [even, odd] = b.pairs();
        run.stage(
            &stages.seed_pairs,
            &[b.cones(), chunks.clone(), even.clone(), b.counters(), b.params()],
        );
        run.dispatch((span.root_count() * span.chunk_count()).div_ceil(64));
        let levels = [(&stages.refine_roots, &even, &odd), (&stages.refine_nodes, &odd, &even)];
        for (level, (stage, parents, pairs)) in levels.into_iter().enumerate() {
            self.encode_plan(level, run);
            let (parents, pairs) = (parents.clone(), pairs.clone());
            let resources =
                [b.cones(), chunks.clone(), parents, pairs, b.counters(), b.ranges(), b.params()];
            run.stage(stage, &resources);
            run.dispatch_planned(b.dispatch_buffer(level));
        }
    }

    fn encode_plan(&self, level: usize, run: &mut Encoder<'_, '_>) {
        let b = &self.buffers;
        run.stage(
            &self.stages.plan_dispatch[level],
            &[b.counters(), b.dispatch(level), b.params()],
        );
        run.dispatch(1);
    }

    fn encode_lists(&self, run: &mut Encoder<'_, '_>) {
        let (stages, b) = (&self.stages, &self.buffers);
        self.encode_plan(2, run);
        run.stage(&stages.plan_lists, &[b.ranges()]);
        run.dispatch(1);
        let [tile_pairs, _] = b.pairs();
        run.stage(
            &stages.fill_lists,
            &[tile_pairs, b.counters(), b.ranges(), b.list(), b.params()],
        );
        run.dispatch_planned(b.dispatch_buffer(2));
    }

    fn encode_trace(&self, span: &Span<'_>, run: &mut Encoder<'_, '_>) {
        let b = &self.buffers;
        let resources = [
            self.rays_of(span),
            b.hits(),
            part_of(span.part.buffer, span.part.bytes()),
            self.chunks_of(span),
            b.cones(),
            b.ranges(),
            b.list(),
            b.counters(),
            b.params(),
        ];
        run.stage(&self.stages.trace_tile, &resources);
        run.dispatch(span.tiles.len());
    }

    /// The rays of a span; tiles are a multiple of what offsets must be aligned to.
    fn rays_of(&self, span: &Span<'_>) -> wgpu::BindingResource<'_> {
        let tile_bytes = TILE_RAYS * size_of::<DeviceRay>();
        let bytes = span.tiles.len() * tile_bytes;
        range_of(self.buffers.rays.buffer(), span.tiles.start * tile_bytes, bytes)
    }

    fn chunks_of(&self, span: &Span<'_>) -> wgpu::BindingResource<'_> {
        part_of(self.chunks[span.part_idx].buffer(), span.chunk_count() * SPHERE_BYTES)
    }
}

/// Stages on their way into a pass.
struct Encoder<'a, 'pass> {
    context: &'a GpuContext,
    pass: &'a mut ComputePass<'pass>,
}

impl Encoder<'_, '_> {
    /// Makes a stage the one that is dispatched next.
    fn stage(&mut self, stage: &ComputePipeline, resources: &[wgpu::BindingResource<'_>]) {
        let group = bind(self.context, &stage.get_bind_group_layout(0), resources);
        self.pass.set_pipeline(stage);
        self.pass.set_bind_group(0, &group, &[]);
    }

    fn dispatch(&mut self, group_count: usize) {
        let [x, y] = groups_of(group_count);
        self.pass.dispatch_workgroups(x, y, 1);
    }

    /// As many workgroups as an earlier stage has written.
    fn dispatch_planned(&mut self, counts: &wgpu::Buffer) {
        self.pass.dispatch_workgroups_indirect(counts, 0);
    }
}

impl Method for Compute {
    fn prepare(&mut self, context: &GpuContext, primitives: &PrimitiveStore) {
        let usage = wgpu::BufferUsages::STORAGE;
        let part_count = primitives.parts().count();
        self.chunks.resize_with(part_count, || GrowingBuffer::new("chunks", usage));
        let mut encoder = context.device.create_command_encoder(&Default::default());
        for (part, chunks) in primitives.parts().zip(&mut self.chunks) {
            let chunk_count = part.count.div_ceil(CHUNK_PRIMS);
            let bytes = chunk_count * SPHERE_BYTES;
            let chunks = chunks.reserve(context, bytes);
            let mut pass = encoder.begin_compute_pass(&Default::default());
            let mut run = Encoder { context, pass: &mut pass };
            let resources = [part_of(part.buffer, part.bytes()), part_of(chunks, bytes)];
            run.stage(&self.stages.bound_chunks, &resources);
            run.dispatch(chunk_count.div_ceil(64));
        }
        context.queue.submit([encoder.finish()]);
    }

    fn trace(
        &mut self,
        context: &GpuContext,
        primitives: &PrimitiveStore,
        run: &mut Run,
        question: Question,
    ) -> Result<TestCounts, GpuError> {
        self.buffers.rays.write(context, &run.rays);
        self.buffers.hits.write(context, &run.hits);
        let tile_count = run.rays.len() / TILE_RAYS;
        let mut counts = TestCounts::default();
        for (part_idx, part) in primitives.parts().enumerate() {
            let span = Span { part, part_idx, tiles: 0..tile_count, question };
            counts = counts + self.trace_span(context, &span, &mut run.hits)?;
        }
        Ok(counts)
    }

    fn memory_usage(&self) -> usize {
        let chunks: u64 = self.chunks.iter().map(GrowingBuffer::size).sum();
        self.buffers.memory_usage() + chunks as usize
    }
}
