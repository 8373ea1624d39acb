//! Parallel subfields, written on the device: a grid of primitives for each direction.
//!
//! 1. **bound_scene** computes the box around the primitives, when a frame is committed.
//! 2. **mark_directions** tells each ray the cell of its direction; cells that occur are wanted.
//! 3. **open_subfields** gives each wanted cell that has none a subfield: a frame across its
//!    direction, and a window around the box.
//! 4. **write_tiles** counts the tiles that each primitive touches, seen along the direction;
//!    **place_tiles** gives each tile its place among the entries; **write_tiles** fills them in.
//! 5. **trace_rays** sends each ray over the tiles of its subfield.
//!
//! What has been written lasts until the next frame: batches that go the same ways find it. A batch
//! that shares a direction has a subfield along exactly that one.
//!
//! **Source.** P. Khanna, J. Mortensen, I. Yu, M. Slater, "Fast Ray Tracing of Scenes With
//! Unstructured Motion", SIGGRAPH 2004 posters, whose future work this is.
//!
//! **Departures** are told in `docs/algorithms/gpu.md`.
//!
//! **Invariants.** A primitive is in every tile in which a ray may hit it: places are enlarged by
//! `PLACE_SLACK` of the distances at work when they are written, and again when they are looked up.
//! Nothing is dropped: where there are more entries than room, buffers grow up to what WebGPU
//! guarantees; then fewer subfields are open at a time and rays are traced in rounds; then tiles are
//! larger.
//!
//! **Cost.** Directions times primitives, twice; 4 bytes an entry and 8 a tile.

mod buffers;
mod choose_grid;
mod held;
mod stages;
#[cfg(test)]
mod tests;

use glam::Vec3;
use rayflock_engine::Budget;

use self::buffers::Buffers;
use self::choose_grid::{Grid, choose_grid};
use self::held::{Held, Origin};
use self::stages::Stages;
use crate::buffer::{GrowingBuffer, part_of, range_of};
use crate::layout::{DeviceHit, DeviceRay, SubfieldCounters, SubfieldParams};
use crate::method::{Method, Question, TestCounts};
use crate::pass::{Groups, StageEncoder};
use crate::primitives::{BOUNDED_AT_ONCE, BOX_BYTES, PART_PRIMS, Part, PrimitiveStore};
use crate::slots::Run;
use crate::stage_clock::StageClock;
use crate::{GpuContext, GpuError};

/// As in `subfields/params.wgsl`.
pub(crate) const MOST_CELLS: usize = 256;
pub(crate) const PRIM_BITS: u32 = 21;
const _: () = assert!(PART_PRIMS <= 1 << PRIM_BITS, "an entry names any primitive of a part");

/// Where the box of the next part begins.
const BOX_STRIDE: usize = 256;

/// Rays of a workgroup.
const GROUP_RAYS: usize = 64;

/// What room there is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Config {
    /// How finely directions and places are told apart; by default, by the numbers of rays and
    /// primitives.
    grid: Option<Grid>,
    /// Entries that there is room for at first, and at most: 64 MiB.
    first_capacity: usize,
    largest_capacity: usize,
    /// Tiles of all open subfields: 16 MiB.
    most_tiles: usize,
}

impl Default for Config {
    fn default() -> Self {
        Self { grid: None, first_capacity: 1 << 18, largest_capacity: 1 << 24, most_tiles: 1 << 21 }
    }
}

/// Traces through subfields.
#[derive(Debug)]
pub(crate) struct Subfields {
    config: Config,
    stages: Stages,
    buffers: Buffers,
    /// The boxes around the parts of the primitives.
    boxes: GrowingBuffer,
    /// Of directions all over the hemisphere.
    set: Held,
    /// Of the direction that a batch shares.
    shared: Held,
}

/// What is traced at a time: a run of rays against one part of the primitives.
#[derive(Clone, Copy, Debug)]
struct Span<'a> {
    part: Part<'a>,
    part_idx: usize,
    ray_count: usize,
    /// The direction of all rays, of unit length, if they share one.
    shared: Option<Vec3>,
    question: Question,
}

impl Subfields {
    pub(crate) fn new(context: &GpuContext, config: Config) -> Self {
        Self {
            config,
            stages: Stages::new(context),
            buffers: Buffers::new(),
            boxes: GrowingBuffer::storage("boxes"),
            set: Held::new(&config),
            shared: Held::new(&config),
        }
    }

    fn held(&self, span: &Span<'_>) -> &Held {
        if span.shared.is_some() { &self.shared } else { &self.set }
    }

    fn held_mut(&mut self, span: &Span<'_>) -> &mut Held {
        if span.shared.is_some() { &mut self.shared } else { &mut self.set }
    }

    /// Traces a span; again, where there was not enough room.
    fn trace_span(
        &mut self,
        context: &GpuContext,
        clock: &mut StageClock,
        span: &Span<'_>,
        hits: &mut [DeviceHit],
    ) -> Result<TestCounts, GpuError> {
        loop {
            if let Some(counts) = self.trace_rounds(context, clock, span, hits)? {
                return Ok(counts);
            }
        }
    }

    /// Traces a span in as many rounds as its directions need; `None` where a round had not enough
    /// room. Hits found by then are right, and do no harm to those still to be found.
    fn trace_rounds(
        &mut self,
        context: &GpuContext,
        clock: &mut StageClock,
        span: &Span<'_>,
        hits: &mut [DeviceHit],
    ) -> Result<Option<TestCounts>, GpuError> {
        // All rounds tell directions apart alike.
        let origin = self.origin_of(span);
        let mut counts = TestCounts::default();
        let mut is_first = true;
        loop {
            let encoder = self.encode_round(context, clock, span, origin, is_first).encoder;
            let counters = self.held(span).counter_buffer().clone();
            let found = self.buffers.read(context, encoder, &counters, hits)?;
            let Some(pairs) = self.held_mut(span).end_round(&found, span.part.count) else {
                return Ok(None);
            };
            counts = counts + tests_of(&found, pairs);
            if found.left_count == 0 {
                return Ok(Some(counts));
            }
            self.held_mut(span).forget();
            is_first = false;
        }
    }

    fn encode_round<'a>(
        &mut self,
        context: &'a GpuContext,
        clock: &'a mut StageClock,
        span: &Span<'_>,
        origin: Origin,
        is_first: bool,
    ) -> StageEncoder<'a> {
        let params = params_of(span, origin, self.held(span));
        self.buffers.send_params(context, &params);
        let mut encoder = StageEncoder::new(context, clock);
        self.held_mut(span).begin_round(context, &mut encoder.encoder, origin, is_first);
        if is_first {
            self.encode_marks(span, &mut encoder);
        }
        self.encode_subfields(span, &mut encoder);
        self.encode_trace(span, &mut encoder);
        encoder
    }

    fn origin_of(&self, span: &Span<'_>) -> Origin {
        let &Span { part_idx, shared, .. } = span;
        let chosen = || choose_grid(span.ray_count, span.part.count, shared.is_some());
        let grid = self.config.grid.unwrap_or_else(chosen);
        self.held(span).allowed(Origin { part_idx, shared, grid })
    }

    fn encode_marks(&self, span: &Span<'_>, encoder: &mut StageEncoder<'_>) {
        let (buffers, held) = (&self.buffers, self.held(span));
        let resources = [buffers.rays(), held.cells(), buffers.params()];
        let groups = Groups::Count(span.ray_count.div_ceil(GROUP_RAYS));
        encoder.stage(&self.stages.mark_directions, &resources, groups);
    }

    /// Opens the subfields that are wanted, and writes them.
    fn encode_subfields(&self, span: &Span<'_>, encoder: &mut StageEncoder<'_>) {
        let (stages, b, held) = (&self.stages, &self.buffers, self.held(span));
        let scene = range_of(self.boxes.buffer(), span.part_idx * BOX_STRIDE, BOX_BYTES);
        let resources = [
            held.cells(),
            scene,
            held.subfields(),
            held.counters(),
            b.writers(),
            b.placers(),
            b.params(),
        ];
        encoder.stage(&stages.open_subfields, &resources, Groups::Count(1));
        let writing = [
            part_of(span.part.buffer, span.part.bytes()),
            held.subfields(),
            held.tiles(),
            held.entries(),
            held.counters(),
            b.params(),
        ];
        let placing = [held.tiles(), held.counters(), b.params()];
        encoder.stage(&stages.write_tiles, &writing, Groups::Planned(b.writer_buffer()));
        encoder.stage(&stages.place_tiles, &placing, Groups::Planned(b.placer_buffer()));
        encoder.stage(&stages.write_tiles, &writing, Groups::Planned(b.writer_buffer()));
    }

    fn encode_trace(&self, span: &Span<'_>, encoder: &mut StageEncoder<'_>) {
        let (buffers, held) = (&self.buffers, self.held(span));
        let resources = [
            buffers.rays(),
            buffers.hits(),
            part_of(span.part.buffer, span.part.bytes()),
            held.cells(),
            held.subfields(),
            held.tiles(),
            held.entries(),
            held.counters(),
            buffers.params(),
        ];
        let groups = Groups::Count(span.ray_count.div_ceil(GROUP_RAYS));
        encoder.stage(&self.stages.trace_rays, &resources, groups);
    }
}

fn params_of(span: &Span<'_>, origin: Origin, held: &Held) -> SubfieldParams {
    let grid = origin.grid;
    SubfieldParams {
        shared_direction: span.shared.unwrap_or(Vec3::Z).to_array(),
        is_shared: u32::from(span.shared.is_some()),
        direction_edge: grid.direction_edge as u32,
        tile_edge: grid.tile_edge as u32,
        subfield_capacity: held.subfield_capacity(grid) as u32,
        entry_capacity: held.entry_capacity() as u32,
        prim_count: span.part.count as u32,
        question: span.question as u32,
        ..SubfieldParams::default()
    }
}

/// The tests of a round that wrote so many entries.
fn tests_of(found: &SubfieldCounters, pairs: u64) -> TestCounts {
    let wide = |low: u32, high: u32| u64::from(high) << 32 | u64::from(low);
    TestCounts {
        cones: 0,
        triangles: wide(found.triangle_tests, found.triangle_tests_high),
        spheres: wide(found.sphere_tests, found.sphere_tests_high),
        pairs,
    }
}

/// The direction of all rays that are traced, as a unit vector, if they have one.
fn shared_direction(rays: &[DeviceRay]) -> Option<Vec3> {
    let mut directions = rays.iter().filter(|ray| ray.is_active()).map(|ray| ray.direction);
    let first = directions.next()?;
    let is_same = directions.all(|direction| direction == first);
    let unit = || Vec3::from(first).as_dvec3().normalize().as_vec3();
    is_same.then(unit)
}

impl Method for Subfields {
    fn prepare(
        &mut self,
        context: &GpuContext,
        clock: &mut StageClock,
        primitives: &PrimitiveStore,
    ) {
        self.set.begin_frame();
        self.shared.begin_frame();
        let boxes = self.boxes.reserve(context, primitives.parts().count() * BOX_STRIDE);
        let mut encoder = StageEncoder::new(context, clock);
        encoder.encoder.clear_buffer(boxes, 0, None);
        for (part_idx, part) in primitives.parts().enumerate() {
            let scene = range_of(boxes, part_idx * BOX_STRIDE, BOX_BYTES);
            let resources = [part_of(part.buffer, part.bytes()), scene];
            let groups = Groups::Count(part.count.div_ceil(BOUNDED_AT_ONCE));
            encoder.stage(&self.stages.bound_scene, &resources, groups);
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
        self.buffers.send(context, run);
        let (ray_count, shared) = (run.rays.len(), shared_direction(&run.rays));
        let mut counts = TestCounts::default();
        for (part_idx, part) in primitives.parts().enumerate() {
            let span = Span { part, part_idx, ray_count, shared, question };
            counts = counts + self.trace_span(context, clock, &span, &mut run.hits)?;
        }
        Ok(counts)
    }

    fn hold(&self, budget: &mut Budget) {
        self.buffers.hold(budget);
        self.boxes.hold(budget);
        self.set.hold(budget);
        self.shared.hold(budget);
    }
}
