//! What the stages hand to each other.

use rayflock_engine::Budget;
use wgpu::{BindingResource, Buffer, BufferUsages, CommandEncoder};

use super::{FAN_OUT, FIRST_ROOT};
use crate::buffer::{DISPATCH_BYTES, GrowingBuffer, ReadBack, part_of};
use crate::layout::{Cone, Counters, DeviceHit, Pair, Params, TileRange};
use crate::slots::{RUN_SLOTS, TILE_RAYS};
use crate::{GpuContext, GpuError};

/// Tiles of a run, and the cones of all levels.
const TILES: usize = RUN_SLOTS / TILE_RAYS;
const CONES: usize = FIRST_ROOT + TILES / (FAN_OUT * FAN_OUT);

/// What the stages hand to each other.
#[derive(Debug)]
pub(super) struct Buffers {
    pub(super) rays: GrowingBuffer,
    pub(super) hits: GrowingBuffer,
    params: GrowingBuffer,
    cones: GrowingBuffer,
    /// Those of roots and tiles, and those of nodes.
    pairs: [GrowingBuffer; 2],
    counters: GrowingBuffer,
    /// Workgroups for the pairs of each level.
    dispatch: [GrowingBuffer; 3],
    ranges: GrowingBuffer,
    list: GrowingBuffer,
    pair_capacity: usize,
    read_back: ReadBack,
}

impl Buffers {
    pub(super) const fn new() -> Self {
        Self {
            rays: GrowingBuffer::storage("rays"),
            hits: GrowingBuffer::storage("hits"),
            params: GrowingBuffer::new("params", BufferUsages::UNIFORM),
            cones: GrowingBuffer::storage("cones"),
            pairs: [
                GrowingBuffer::storage("pairs of roots and tiles"),
                GrowingBuffer::storage("pairs of nodes"),
            ],
            counters: GrowingBuffer::storage("counters"),
            dispatch: [
                GrowingBuffer::dispatch(),
                GrowingBuffer::dispatch(),
                GrowingBuffer::dispatch(),
            ],
            ranges: GrowingBuffer::storage("ranges"),
            list: GrowingBuffer::storage("list"),
            pair_capacity: 0,
            read_back: ReadBack::new(),
        }
    }

    /// Makes room for what these parameters need, and sends them.
    pub(super) fn reserve(&mut self, context: &GpuContext, params: &Params) {
        self.params.write(context, std::slice::from_ref(params));
        self.cones.reserve(context, CONES * size_of::<Cone>());
        self.counters.reserve(context, size_of::<Counters>());
        self.ranges.reserve(context, TILES * size_of::<TileRange>());
        self.pair_capacity = params.pair_capacity as usize;
        for pairs in &mut self.pairs {
            pairs.reserve(context, self.pair_capacity * size_of::<Pair>());
        }
        self.list.reserve(context, self.pair_capacity * size_of::<u32>());
        for dispatch in &mut self.dispatch {
            dispatch.reserve(context, DISPATCH_BYTES);
        }
    }

    /// Begins to count anew.
    pub(super) fn clear(&self, encoder: &mut CommandEncoder) {
        encoder.clear_buffer(self.counters.buffer(), 0, None);
        encoder.clear_buffer(self.ranges.buffer(), 0, None);
    }

    /// Runs what is encoded, and reads the counters and the first hits.
    pub(super) fn read(
        &mut self,
        context: &GpuContext,
        encoder: CommandEncoder,
        hits: &mut [DeviceHit],
    ) -> Result<Counters, GpuError> {
        let sources = [self.counters.buffer(), self.hits.buffer()];
        self.read_back.run_for_hits(context, encoder, sources, hits)
    }

    pub(super) fn params(&self) -> BindingResource<'_> {
        part_of(self.params.buffer(), size_of::<Params>())
    }

    pub(super) fn cones(&self) -> BindingResource<'_> {
        part_of(self.cones.buffer(), CONES * size_of::<Cone>())
    }

    pub(super) fn counters(&self) -> BindingResource<'_> {
        part_of(self.counters.buffer(), size_of::<Counters>())
    }

    pub(super) fn ranges(&self) -> BindingResource<'_> {
        part_of(self.ranges.buffer(), TILES * size_of::<TileRange>())
    }

    pub(super) fn list(&self) -> BindingResource<'_> {
        part_of(self.list.buffer(), self.pair_capacity * size_of::<u32>())
    }

    /// The pairs of roots and of tiles; the pairs of nodes.
    pub(super) fn pairs(&self) -> [BindingResource<'_>; 2] {
        let bytes = self.pair_capacity * size_of::<Pair>();
        self.pairs.each_ref().map(|pairs| part_of(pairs.buffer(), bytes))
    }

    /// Workgroups for the pairs of a level: 0 of roots, 1 of nodes, 2 of tiles.
    pub(super) fn dispatch(&self, level: usize) -> BindingResource<'_> {
        part_of(self.dispatch[level].buffer(), DISPATCH_BYTES)
    }

    pub(super) fn dispatch_buffer(&self, level: usize) -> &Buffer {
        self.dispatch[level].buffer()
    }

    pub(super) fn counter_buffer(&self) -> &Buffer {
        self.counters.buffer()
    }

    #[cfg(test)]
    pub(super) fn cone_buffer(&self) -> &Buffer {
        self.cones.buffer()
    }

    #[cfg(test)]
    pub(super) fn range_buffer(&self) -> &Buffer {
        self.ranges.buffer()
    }

    #[cfg(test)]
    pub(super) fn list_buffer(&self) -> &Buffer {
        self.list.buffer()
    }

    /// Tells what is held.
    pub(super) fn hold(&self, budget: &mut Budget) {
        let [even, odd] = &self.pairs;
        let all = [
            &self.rays,
            &self.hits,
            &self.params,
            &self.cones,
            even,
            odd,
            &self.counters,
            &self.ranges,
            &self.list,
        ];
        all.into_iter().chain(&self.dispatch).for_each(|buffer| buffer.hold(budget));
        self.read_back.hold(budget);
    }
}
