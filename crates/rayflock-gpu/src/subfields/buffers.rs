//! What a run of rays brings to the stages, and what comes back.

use rayflock_engine::Budget;
use wgpu::{BindingResource, Buffer, BufferUsages, CommandEncoder};

use crate::buffer::{DISPATCH_BYTES, GrowingBuffer, ReadBack, part_of};
use crate::layout::{DeviceHit, DeviceRay, SubfieldCounters, SubfieldParams};
use crate::slots::Run;
use crate::{GpuContext, GpuError};

/// What a run of rays brings to the stages, and what comes back.
#[derive(Debug)]
pub(super) struct Buffers {
    rays: GrowingBuffer,
    hits: GrowingBuffer,
    params: GrowingBuffer,
    /// Workgroups for the primitives, and for the tiles, of new subfields.
    writers: GrowingBuffer,
    placers: GrowingBuffer,
    ray_count: usize,
    read_back: ReadBack,
}

impl Buffers {
    pub(super) const fn new() -> Self {
        Self {
            rays: GrowingBuffer::storage("rays"),
            hits: GrowingBuffer::storage("hits"),
            params: GrowingBuffer::new("params", BufferUsages::UNIFORM),
            writers: GrowingBuffer::dispatch(),
            placers: GrowingBuffer::dispatch(),
            ray_count: 0,
            read_back: ReadBack::new(),
        }
    }

    /// Sends a run.
    pub(super) fn send(&mut self, context: &GpuContext, run: &Run) {
        self.rays.write(context, &run.rays);
        self.hits.write(context, &run.hits);
        self.ray_count = run.rays.len();
        for dispatch in [&mut self.writers, &mut self.placers] {
            dispatch.reserve(context, DISPATCH_BYTES);
        }
    }

    /// Sends the parameters of a round.
    pub(super) fn send_params(&mut self, context: &GpuContext, params: &SubfieldParams) {
        self.params.write(context, std::slice::from_ref(params));
    }

    /// Runs what is encoded, and reads the counters and the hits.
    pub(super) fn read(
        &mut self,
        context: &GpuContext,
        encoder: CommandEncoder,
        counters: &Buffer,
        hits: &mut [DeviceHit],
    ) -> Result<SubfieldCounters, GpuError> {
        let sources = [counters, self.hits.buffer()];
        self.read_back.run_for_hits(context, encoder, sources, hits)
    }

    pub(super) fn rays(&self) -> BindingResource<'_> {
        part_of(self.rays.buffer(), self.ray_count * size_of::<DeviceRay>())
    }

    pub(super) fn hits(&self) -> BindingResource<'_> {
        part_of(self.hits.buffer(), self.ray_count * size_of::<DeviceHit>())
    }

    pub(super) fn params(&self) -> BindingResource<'_> {
        part_of(self.params.buffer(), size_of::<SubfieldParams>())
    }

    pub(super) fn writers(&self) -> BindingResource<'_> {
        part_of(self.writers.buffer(), DISPATCH_BYTES)
    }

    pub(super) fn placers(&self) -> BindingResource<'_> {
        part_of(self.placers.buffer(), DISPATCH_BYTES)
    }

    pub(super) fn writer_buffer(&self) -> &Buffer {
        self.writers.buffer()
    }

    pub(super) fn placer_buffer(&self) -> &Buffer {
        self.placers.buffer()
    }

    #[cfg(test)]
    pub(super) fn ray_buffer(&self) -> &Buffer {
        self.rays.buffer()
    }

    /// Tells what is held.
    pub(super) fn hold(&self, budget: &mut Budget) {
        let all = [&self.rays, &self.hits, &self.params, &self.writers, &self.placers];
        all.into_iter().for_each(|buffer| buffer.hold(budget));
        self.read_back.hold(budget);
    }
}
