//! A tree of cones over the rays, and pairs of cones and chunks refined by compaction: today's form
//! of the hierarchical ray engine.
//!
//! 1. When a frame is committed, primitives are brought into an order ([`bucket_order`]);
//!    **bound_chunks** and **bound_blocks** write the spheres around each chunk of 16 consecutive
//!    ones and each block of 16 chunks.
//! 2. **bound_tiles** and **bound_nodes** compute the cones of tiles of 64 rays, of 16 tiles, and of
//!    16 of those, bottom up.
//! 3. **seed_pairs** asks the roots about all blocks; **refine** asks the children of each pair, two
//!    times. What touches is appended, and the next stage is dispatched by its count.
//! 4. **plan_lists** and **fill_lists** bring the blocks of each tile together.
//! 5. **trace_tile** goes through their chunks from near to far, one workgroup a tile; rays that
//!    share few of them go on alone. On cards four invocations have a ray in common.
//!
//! **Source.** L. Szecsi, "The Hierarchical Ray Engine", WSCG 2006; D. Roger, U. Assarsson, N.
//! Holzschuch, "Whitted Ray-Tracing for Dynamic Scenes using a Ray-Space Hierarchy on the GPU",
//! EGSR 2007.
//!
//! **Departures** from the latter: pairs name blocks, not triangles, until the tile is reached, so
//! that lists are short, and tiles whose cones bound nothing need none; sixteen children a node;
//! three levels, whatever the number of rays, and single rays below them.
//!
//! **Invariants.** No pair is dropped: where there are more than a buffer holds, it grows, up to
//! what WebGPU guarantees, and then the rays are split.
//!
//! **Cost.** Roots times blocks, and what is left of them; 20 bytes of pairs and lists each.

mod bucket_order;
mod buffers;
mod span;
mod stages;
#[cfg(test)]
mod tests;

use rayflock_engine::Budget;
use wgpu::{Buffer, CommandEncoder};

use self::bucket_order::BucketOrder;
pub(crate) use self::bucket_order::{CELLS_EACH, PLACERS};
use self::buffers::Buffers;
use self::span::{Span, rays_of};
pub(crate) use self::span::{pairs_needed, tests_of};
pub(crate) use self::stages::Form;
use self::stages::Stages;
use crate::buffer::{GrowingBuffer, part_of};
use crate::layout::{Counters, DeviceHit, Params};
use crate::method::{Method, Question, TestCounts};
use crate::pass::{Groups, StageEncoder};
use crate::primitives::PrimitiveStore;
use crate::slots::{RUN_SLOTS, Run, TILE_RAYS};
use crate::stage_clock::StageClock;
use crate::{GpuContext, GpuError};

/// As in `compute/params.wgsl`.
pub(crate) const CHUNK_PRIMS: usize = 16;
pub(crate) const BLOCK_CHUNKS: usize = 16;
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
    order: BucketOrder,
    /// The spheres around the blocks of each part of the primitives.
    blocks: Vec<GrowingBuffer>,
    pair_capacity: usize,
    largest_capacity: usize,
}

/// Rays that are on the device, and where what they hit goes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wave<'a> {
    pub(crate) rays: &'a Buffer,
    /// Of as many slots as there are rays.
    pub(crate) hits: &'a Buffer,
    pub(crate) tile_count: usize,
    pub(crate) question: Question,
}

/// What there was not enough of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Room {
    /// Now there is.
    Grown,
    /// Buffers may not be larger.
    Exhausted,
}

impl Compute {
    pub(crate) fn new(context: &GpuContext) -> Self {
        Self::with_capacity(context, Form::of(context), [FIRST_CAPACITY, LARGEST_CAPACITY])
    }

    /// With room for so many pairs at first, and at most.
    pub(crate) fn with_capacity(
        context: &GpuContext,
        form: Form,
        [pair_capacity, largest_capacity]: [usize; 2],
    ) -> Self {
        Self {
            stages: Stages::new(context, form),
            buffers: Buffers::new(),
            order: BucketOrder::new(context),
            blocks: Vec::new(),
            pair_capacity,
            largest_capacity,
        }
    }

    /// Pairs that buffers have room for.
    #[cfg(test)]
    pub(crate) const fn pair_capacity(&self) -> usize {
        self.pair_capacity
    }

    /// Traces a span; as halves, where it makes more pairs than buffers can hold.
    fn trace_span(
        &mut self,
        context: &GpuContext,
        clock: &mut StageClock,
        span: &Span<'_>,
        hits: &mut [DeviceHit],
    ) -> Result<TestCounts, GpuError> {
        loop {
            let found = self.run_span(context, clock, span, hits)?;
            let needed = pairs_needed(&found);
            if needed <= self.pair_capacity {
                return Ok(tests_of(span.asked(), &found));
            }
            // A single tile makes no more pairs than there are blocks.
            let largest = self.largest_capacity.max(span.block_count());
            if needed > largest && span.tiles.len() > 1 {
                let [first, second] = span.halves();
                let counts = self.trace_span(context, clock, &first, hits)?;
                return Ok(counts + self.trace_span(context, clock, &second, hits)?);
            }
            self.pair_capacity = needed.next_power_of_two();
        }
    }

    /// Runs all stages for a span once. Hits that it finds are right, but some are missing where
    /// the counters tell of more pairs than there was room for.
    fn run_span(
        &mut self,
        context: &GpuContext,
        clock: &mut StageClock,
        span: &Span<'_>,
        hits: &mut [DeviceHit],
    ) -> Result<Counters, GpuError> {
        let encoder = self.encode_span(context, clock, span).encoder;
        self.buffers.read(context, encoder, hits)
    }

    /// Traces a wave without waiting for it; `log` gets the counters, and how many cone tests the
    /// first level takes, for each part of the primitives.
    pub(crate) fn trace_wave(
        &mut self,
        context: &GpuContext,
        clock: &mut StageClock,
        primitives: &PrimitiveStore,
        wave: &Wave<'_>,
        log: &mut dyn FnMut(&mut CommandEncoder, &Buffer, usize),
    ) {
        for (part_idx, part) in primitives.parts().enumerate() {
            let tiles = 0..wave.tile_count;
            let (rays, hits) = (wave.rays.clone(), wave.hits.clone());
            let span = Span { part, part_idx, rays, hits, tiles, question: wave.question };
            let mut encoder = self.encode_span(context, clock, &span);
            log(&mut encoder.encoder, self.buffers.counter_buffer(), span.asked());
            encoder.submit();
        }
    }

    /// The box around the primitives that rays may see, as `bound_scene` has written it.
    pub(crate) fn bounds(&self) -> wgpu::BindingResource<'_> {
        self.order.bounds()
    }

    /// Makes room for so many pairs, if there is not enough.
    pub(crate) fn make_room(&mut self, needed: usize) -> Option<Room> {
        if needed <= self.pair_capacity {
            return None;
        }
        if needed > self.largest_capacity {
            return Some(Room::Exhausted);
        }
        self.pair_capacity = needed.next_power_of_two();
        Some(Room::Grown)
    }

    fn encode_span<'a>(
        &mut self,
        context: &'a GpuContext,
        clock: &'a mut StageClock,
        span: &Span<'_>,
    ) -> StageEncoder<'a> {
        let params = Params {
            tile_count: span.tiles.len() as u32,
            block_count: span.block_count() as u32,
            pair_capacity: self.pair_capacity as u32,
            question: span.question as u32,
        };
        self.buffers.reserve(context, &params);
        let mut encoder = StageEncoder::new(context, clock);
        self.buffers.clear(&mut encoder.encoder);
        self.encode_cones(span, &mut encoder);
        self.encode_refinement(span, &mut encoder);
        self.encode_lists(&mut encoder);
        self.encode_trace(span, &mut encoder);
        encoder
    }

    fn encode_cones(&self, span: &Span<'_>, encoder: &mut StageEncoder<'_>) {
        let (stages, buffers) = (&self.stages, &self.buffers);
        let rays = rays_of(span);
        encoder.stage(
            &stages.bound_tiles,
            &[rays, buffers.cones()],
            Groups::Count(span.tiles.len()),
        );
        for (stage, count) in
            [(&stages.bound_nodes, span.node_count()), (&stages.bound_roots, span.root_count())]
        {
            encoder.stage(
                stage,
                &[buffers.cones(), buffers.params()],
                Groups::Count(count.div_ceil(64)),
            );
        }
    }

    fn encode_refinement(&self, span: &Span<'_>, encoder: &mut StageEncoder<'_>) {
        let (stages, b) = (&self.stages, &self.buffers);
        let blocks = self.blocks_of(span);
        let [even, odd] = b.pairs();
        let resources = [b.cones(), blocks.clone(), even.clone(), b.counters(), b.params()];
        encoder.stage(&stages.seed_pairs, &resources, Groups::Count(span.asked().div_ceil(64)));
        let levels = [(&stages.refine_roots, &even, &odd), (&stages.refine_nodes, &odd, &even)];
        for (level, (stage, parents, pairs)) in levels.into_iter().enumerate() {
            self.encode_plan(level, encoder);
            let (parents, pairs) = (parents.clone(), pairs.clone());
            let resources =
                [b.cones(), blocks.clone(), parents, pairs, b.counters(), b.ranges(), b.params()];
            encoder.stage(stage, &resources, Groups::Planned(b.dispatch_buffer(level)));
        }
    }

    fn encode_plan(&self, level: usize, encoder: &mut StageEncoder<'_>) {
        let b = &self.buffers;
        let resources = [b.counters(), b.dispatch(level), b.params()];
        encoder.stage(&self.stages.plan_dispatch[level], &resources, Groups::Count(1));
    }

    fn encode_lists(&self, encoder: &mut StageEncoder<'_>) {
        let (stages, b) = (&self.stages, &self.buffers);
        self.encode_plan(2, encoder);
        encoder.stage(&stages.plan_lists, &[b.ranges()], Groups::Count(1));
        let [tile_pairs, _] = b.pairs();
        let resources = [tile_pairs, b.counters(), b.ranges(), b.list(), b.params()];
        encoder.stage(&stages.fill_lists, &resources, Groups::Planned(b.dispatch_buffer(2)));
    }

    fn encode_trace(&self, span: &Span<'_>, encoder: &mut StageEncoder<'_>) {
        let b = &self.buffers;
        let resources = [
            rays_of(span),
            span.hits.as_entire_binding(),
            self.order.ordered(span.part_idx, span.part),
            self.order.chunks(span.part_idx, span.part),
            b.cones(),
            b.ranges(),
            b.list(),
            b.counters(),
            b.params(),
        ];
        encoder.stage(&self.stages.trace_tile, &resources, Groups::Count(span.tiles.len()));
    }

    fn blocks_of(&self, span: &Span<'_>) -> wgpu::BindingResource<'_> {
        part_of(self.blocks[span.part_idx].buffer(), span.block_count() * SPHERE_BYTES)
    }
}

impl Method for Compute {
    fn prepare(
        &mut self,
        context: &GpuContext,
        clock: &mut StageClock,
        primitives: &PrimitiveStore,
    ) {
        self.blocks.resize_with(primitives.parts().count(), || GrowingBuffer::storage("blocks"));
        let mut encoder = StageEncoder::new(context, clock);
        self.order.order(&mut encoder, primitives);
        for ((part_idx, part), blocks) in primitives.parts().enumerate().zip(&mut self.blocks) {
            let block_count = part.count.div_ceil(CHUNK_PRIMS * BLOCK_CHUNKS);
            let block_bytes = block_count * SPHERE_BYTES;
            let blocks = part_of(blocks.reserve(context, block_bytes), block_bytes);
            let groups = Groups::Count(block_count.div_ceil(64));
            let chunks = self.order.chunks(part_idx, part);
            encoder.stage(&self.stages.bound_blocks, &[chunks, blocks], groups);
        }
        encoder.submit();
    }

    fn trace(
        &mut self,
        context: &GpuContext,
        clock: &mut StageClock,
        primitives: &PrimitiveStore,
        run: &mut Run,
        question: Question,
    ) -> Result<TestCounts, GpuError> {
        self.buffers.rays.write(context, &run.rays);
        self.buffers.hits.write(context, &run.hits);
        let tile_count = run.rays.len() / TILE_RAYS;
        let mut counts = TestCounts::default();
        for (part_idx, part) in primitives.parts().enumerate() {
            let (rays, hits) = (self.buffers.rays.buffer(), self.buffers.hits.buffer());
            let (rays, hits, tiles) = (rays.clone(), hits.clone(), 0..tile_count);
            let span = Span { part, part_idx, rays, hits, tiles, question };
            counts = counts + self.trace_span(context, clock, &span, &mut run.hits)?;
        }
        Ok(counts)
    }

    fn hold(&self, budget: &mut Budget) {
        self.buffers.hold(budget);
        self.order.hold(budget);
        self.blocks.iter().for_each(|blocks| blocks.hold(budget));
    }
}
