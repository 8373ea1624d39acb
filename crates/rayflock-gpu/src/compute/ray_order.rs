//! An order of rays in which neighbours start and go alike, for rays that were born on the device:
//! a counting sort by keys.
//!
//! 1. **count_rays** gives each ray a key, and a place among those of the same key.
//! 2. **sum_cells** and **place_cells** add up counts, as for primitives.
//! 3. **order_rays** copies rays to their places. Hits go where a ray's slot says, so nobody else
//!    has to know of the order.
//!
//! **Source.** N. Reis, V. Costa, J. Pereira, "Coherent Ray-Space Hierarchy via Ray Hashing and
//! Sorting", GRAPP 2017. What comes from the host is sorted there ([`crate::sort_rays`]).
//!
//! **Cost.** Linear; 56 bytes a ray.

use rayflock_engine::Budget;
use wgpu::{BindingResource, Buffer, BufferUsages};

use super::bucket_order::{CELLS_EACH, PLACERS};
use crate::GpuContext;
use crate::buffer::{GrowingBuffer, part_of};
use crate::layout::{CellParams, DeviceRay};
use crate::pass::{Groups, StageEncoder};
use crate::pipeline::{ComputeStage, compute_stage};
use crate::shaders;

/// Keys, that of rays which are not traced included; see `compute/count_rays.wgsl`.
pub(crate) const KEY_BITS: u32 = 3;
const KEYS: usize = (1 << (5 * KEY_BITS)) + 1;
const KEY_BYTES: usize = KEYS * size_of::<u32>();

/// Workgroups that place keys.
const PLACE_GROUPS: usize = KEYS.div_ceil(CELLS_EACH * PLACERS);

/// Invocations of a workgroup of the other stages.
const GROUP: usize = 64;

/// Brings rays into an order.
#[derive(Debug)]
pub(super) struct RayOrder {
    count_rays: ComputeStage,
    sum_cells: ComputeStage,
    place_cells: ComputeStage,
    order_rays: ComputeStage,
    params: GrowingBuffer,
    keys: GrowingBuffer,
    group_sums: GrowingBuffer,
    places: GrowingBuffer,
    ordered: GrowingBuffer,
}

impl RayOrder {
    pub(super) fn new(context: &GpuContext) -> Self {
        let stage = |shader| compute_stage(context, shader, &[]);
        Self {
            count_rays: stage(shaders::COUNT_RAYS),
            sum_cells: stage(shaders::SUM_CELLS),
            place_cells: stage(shaders::PLACE_CELLS),
            order_rays: stage(shaders::ORDER_RAYS),
            params: GrowingBuffer::new("params", BufferUsages::UNIFORM),
            keys: GrowingBuffer::storage("ray keys"),
            group_sums: GrowingBuffer::storage("ray keys"),
            places: GrowingBuffer::storage("ray keys"),
            ordered: GrowingBuffer::storage("ordered rays"),
        }
    }

    /// Makes room for so many rays.
    pub(super) fn reserve(&mut self, context: &GpuContext, ray_count: usize) {
        let params = CellParams { cell_count: KEYS as u32, ..CellParams::default() };
        self.params.write(context, &[params]);
        self.keys.reserve(context, KEY_BYTES);
        self.group_sums.reserve(context, PLACE_GROUPS * size_of::<u32>());
        self.places.reserve(context, ray_count * size_of::<[u32; 2]>());
        self.ordered.reserve(context, ray_count * size_of::<DeviceRay>());
    }

    /// Orders so many `rays`, for which there is room, in a scene between `bounds`.
    pub(super) fn order(
        &self,
        encoder: &mut StageEncoder<'_>,
        (rays, ray_count): (BindingResource<'_>, usize),
        bounds: BindingResource<'_>,
    ) {
        let keys = part_of(self.keys.buffer(), KEY_BYTES);
        let places = self.places.buffer().as_entire_binding();
        let group_sums = self.group_sums.buffer().as_entire_binding();
        let params = part_of(self.params.buffer(), size_of::<CellParams>());
        encoder.encoder.clear_buffer(self.keys.buffer(), 0, None);
        let of_rays = Groups::Count(ray_count.div_ceil(GROUP));
        let resources = [rays.clone(), bounds, keys.clone(), places.clone()];
        encoder.stage(&self.count_rays, &resources, of_rays);
        let resources = [keys.clone(), group_sums, params];
        encoder.stage(&self.sum_cells, &resources, Groups::Count(PLACE_GROUPS));
        encoder.stage(&self.place_cells, &resources, Groups::Count(PLACE_GROUPS));
        let ordered = part_of(self.ordered.buffer(), ray_count * size_of::<DeviceRay>());
        encoder.stage(&self.order_rays, &[rays, places, keys, ordered], of_rays);
    }

    /// The rays in their order.
    pub(super) fn ordered(&self) -> &Buffer {
        self.ordered.buffer()
    }

    /// Tells what is held.
    pub(super) fn hold(&self, budget: &mut Budget) {
        let all = [&self.params, &self.keys, &self.group_sums, &self.places, &self.ordered];
        all.iter().for_each(|buffer| buffer.hold(budget));
    }
}

#[cfg(test)]
mod tests;
