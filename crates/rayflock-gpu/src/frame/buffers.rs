//! What the stages of a picture hand to each other.

use rayflock_engine::Budget;
use wgpu::{BindingResource, BufferUsages};

use super::gather_lights::SUM_BYTES;
use crate::GpuContext;
use crate::buffer::{GrowingBuffer, ReadBack, part_of};
use crate::layout::{DeviceHit, DeviceLight, DeviceRay, FrameParams, PATH_BYTES, POINT_BYTES};

/// Rays of the next wave, mirrored and all, and shadow rays of this one: as in `frame/frame.wgsl`.
pub(crate) type WaveCounts = [u32; 4];
pub(crate) const MIRRORED: usize = 0;
pub(crate) const FOLLOWED: usize = 1;
pub(crate) const SHADOW: usize = 2;

/// Buffers of a wave, of its shadow rays and of the film.
#[derive(Debug)]
pub(super) struct FrameBuffers {
    /// Two halves each: those of the wave, and those that it leaves for the next one.
    pub(super) rays: GrowingBuffer,
    pub(super) paths: GrowingBuffer,
    pub(super) hits: GrowingBuffer,
    pub(super) points: GrowingBuffer,
    pub(super) shadow_rays: GrowingBuffer,
    pub(super) shadow_hits: GrowingBuffer,
    pub(super) counts: GrowingBuffer,
    pub(super) film: GrowingBuffer,
    pub(super) params: GrowingBuffer,
    pub(super) light: GrowingBuffer,
    pub(super) read_back: ReadBack,
}

impl FrameBuffers {
    pub(super) const fn new() -> Self {
        Self {
            rays: GrowingBuffer::storage("rays"),
            paths: GrowingBuffer::storage("paths"),
            hits: GrowingBuffer::storage("hits"),
            points: GrowingBuffer::storage("points"),
            shadow_rays: GrowingBuffer::storage("shadow rays"),
            shadow_hits: GrowingBuffer::storage("shadow hits"),
            counts: GrowingBuffer::storage("counts"),
            film: GrowingBuffer::storage("film"),
            params: GrowingBuffer::new("frame params", BufferUsages::UNIFORM),
            light: GrowingBuffer::new("light", BufferUsages::UNIFORM),
            read_back: ReadBack::new(),
        }
    }

    /// Makes room for waves of so many slots and a band of so many pixels.
    pub(super) fn reserve(&mut self, context: &GpuContext, slot_count: usize, pixel_count: usize) {
        let of_slots = |buffer: &mut GrowingBuffer, bytes: usize| {
            buffer.reserve(context, slot_count * bytes);
        };
        of_slots(&mut self.rays, 2 * size_of::<DeviceRay>());
        of_slots(&mut self.paths, 2 * PATH_BYTES);
        of_slots(&mut self.hits, size_of::<DeviceHit>());
        of_slots(&mut self.points, POINT_BYTES);
        of_slots(&mut self.shadow_rays, size_of::<DeviceRay>());
        of_slots(&mut self.shadow_hits, size_of::<DeviceHit>());
        self.counts.reserve(context, size_of::<WaveCounts>());
        self.film.reserve(context, pixel_count * size_of::<[f32; 3]>() + SUM_BYTES);
    }

    pub(super) fn counts(&self) -> BindingResource<'_> {
        part_of(self.counts.buffer(), size_of::<WaveCounts>())
    }

    pub(super) fn params(&self) -> BindingResource<'_> {
        part_of(self.params.buffer(), size_of::<FrameParams>())
    }

    pub(super) fn light(&self) -> BindingResource<'_> {
        part_of(self.light.buffer(), size_of::<DeviceLight>())
    }

    /// Tells what is held.
    pub(super) fn hold(&self, budget: &mut Budget) {
        let buffers = [
            &self.rays,
            &self.paths,
            &self.hits,
            &self.points,
            &self.shadow_rays,
            &self.shadow_hits,
            &self.counts,
            &self.film,
            &self.params,
            &self.light,
        ];
        buffers.iter().for_each(|buffer| buffer.hold(budget));
        self.read_back.hold(budget);
    }
}
