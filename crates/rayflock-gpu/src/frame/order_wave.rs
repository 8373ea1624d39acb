//! Waves of rays that a wave before has left, in an order in which neighbours start and go alike: a
//! counting sort by keys.
//!
//! 1. **count_rays** gives each ray a key, and a place among those of the same key.
//! 2. **sum_cells** and **place_cells** add up counts, as for primitives.
//! 3. **order_wave** copies rays and their paths to their places.
//!
//! So tiles of the wave are narrow, and those of its shadow rays as well.
//!
//! **Source.** N. Reis, V. Costa, J. Pereira, "Coherent Ray-Space Hierarchy via Ray Hashing and
//! Sorting", GRAPP 2017. What comes from the host is sorted there ([`crate::sort_rays`]).
//!
//! **Cost.** Linear, four passes a bounce; 8 bytes a slot.

use rayflock_engine::Budget;
use wgpu::{BindingResource, BufferUsages};

use super::buffers::FrameBuffers;
use crate::GpuContext;
use crate::buffer::{GrowingBuffer, part_of};
use crate::compute::{CELLS_EACH, PLACERS};
use crate::layout::CellParams;
use crate::pass::{Groups, StageEncoder};
use crate::pipeline::{ComputeStage, compute_stage};
use crate::shaders;
use crate::slots::TILE_RAYS;

/// Keys, that of rays which are not traced included; see `frame/count_rays.wgsl`.
pub(crate) const KEY_BITS: u32 = 3;
const KEYS: usize = (1 << (5 * KEY_BITS)) + 1;
const KEY_BYTES: usize = KEYS * size_of::<u32>();

/// Workgroups that place keys.
const PLACE_GROUPS: usize = KEYS.div_ceil(CELLS_EACH * PLACERS);

/// Brings waves into an order.
#[derive(Debug)]
pub(super) struct WaveOrder {
    count_rays: ComputeStage,
    sum_cells: ComputeStage,
    place_cells: ComputeStage,
    order_wave: ComputeStage,
    params: GrowingBuffer,
    /// How many rays have a key, then where they begin.
    keys: GrowingBuffer,
    group_sums: GrowingBuffer,
    places: GrowingBuffer,
}

impl WaveOrder {
    pub(super) fn new(context: &GpuContext) -> Self {
        let stage = |shader| compute_stage(context, shader, &[]);
        Self {
            count_rays: stage(shaders::COUNT_RAYS),
            sum_cells: stage(shaders::SUM_CELLS),
            place_cells: stage(shaders::PLACE_CELLS),
            order_wave: stage(shaders::ORDER_WAVE),
            params: GrowingBuffer::new("params", BufferUsages::UNIFORM),
            keys: GrowingBuffer::storage("ray keys"),
            group_sums: GrowingBuffer::storage("ray keys"),
            places: GrowingBuffer::storage("ray keys"),
        }
    }

    /// Makes the rays that were left in `buffers` a wave of so many slots, a multiple of 64, in a
    /// scene between `bounds`.
    pub(super) fn order(
        &mut self,
        encoder: &mut StageEncoder<'_>,
        buffers: &FrameBuffers,
        slot_count: usize,
        bounds: BindingResource<'_>,
    ) {
        let context = encoder.context;
        let params = CellParams { cell_count: KEYS as u32, ..CellParams::default() };
        self.params.write(context, &[params]);
        let params = part_of(self.params.buffer(), size_of::<CellParams>());
        encoder.encoder.clear_buffer(self.keys.reserve(context, KEY_BYTES), 0, None);
        let keys = part_of(self.keys.buffer(), KEY_BYTES);
        let group_sums = self.group_sums.reserve(context, PLACE_GROUPS * size_of::<u32>());
        let group_sums = group_sums.as_entire_binding();
        let places = self.places.reserve(context, slot_count * size_of::<[u32; 2]>());
        let places = places.as_entire_binding();
        let [rays, paths, hits] =
            [&buffers.rays, &buffers.paths, &buffers.hits].map(|b| b.buffer().as_entire_binding());
        let of_slots = Groups::Count(slot_count / TILE_RAYS);
        let resources = [
            rays.clone(),
            bounds,
            buffers.counts(),
            keys.clone(),
            places.clone(),
            buffers.params(),
        ];
        encoder.stage(&self.count_rays, &resources, of_slots);
        let resources = [keys.clone(), group_sums, params];
        encoder.stage(&self.sum_cells, &resources, Groups::Count(PLACE_GROUPS));
        encoder.stage(&self.place_cells, &resources, Groups::Count(PLACE_GROUPS));
        let resources = [rays, paths, hits, buffers.counts(), places, keys, buffers.params()];
        encoder.stage(&self.order_wave, &resources, of_slots);
    }

    /// Tells what is held.
    pub(super) fn hold(&self, budget: &mut Budget) {
        let all = [&self.params, &self.keys, &self.group_sums, &self.places];
        all.iter().for_each(|buffer| buffer.hold(budget));
    }
}

#[cfg(test)]
mod tests;
