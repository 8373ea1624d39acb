//! An order of primitives in which neighbours lie close to each other: a counting sort by cells.
//!
//! 1. **bound_scene** computes the box around what rays may see.
//! 2. **count_cells** gives each primitive a cell, and a place among those of the same cell.
//! 3. **sum_cells** and **place_cells** add up counts: the places of the first primitives of cells.
//! 4. **order_primitives** copies primitives to their places.
//! 5. **bound_chunks** writes the spheres around chunks of 16, as they came and in the new order;
//!    **size_chunks** compares both, and **take_order** goes back to the first where that is better.
//!
//! So chunks are small even where triangles have flown apart, or a mesh came in no order; a mesh in
//! a good one, patch by patch, keeps it.
//!
//! **Source.** A. Lagae and P. Dutre, "Compact, Fast and Robust Grids for Ray Tracing", EGSR 2008,
//! for cells by counting; M. McCool et al. and T. Ulrich, loose octrees, Game Programming Gems, 2000,
//! for levels by size.
//!
//! **Invariants.** Each primitive is there once, and keeps its rank.
//!
//! **Cost.** Linear; 56 bytes a primitive, 4 a cell, and spheres around chunks.

use rayflock_engine::Budget;
#[cfg(test)]
use wgpu::Buffer;
use wgpu::{BindingResource, BufferUsages};

use super::{CHUNK_PRIMS, SPHERE_BYTES};
use crate::GpuContext;
use crate::buffer::{GrowingBuffer, part_of};
use crate::layout::CellParams;
use crate::pass::{Groups, StageEncoder};
use crate::pipeline::{ComputeStage, compute_stage};
use crate::primitives::{BOUNDED_AT_ONCE, BOX_BYTES, Part, PrimitiveStore};
use crate::shaders;

/// As in `compute/cells.wgsl`.
pub(crate) const CELLS_EACH: usize = 4;
pub(crate) const PLACERS: usize = 256;

/// Invocations of a workgroup of the other stages.
const GROUP: usize = 64;

/// Bytes of the two sums that are compared.
const SIZES_BYTES: usize = 8;

/// The finest level that there ever is.
const FINEST: u32 = 6;

/// Brings primitives into an order.
#[derive(Debug)]
pub(super) struct BucketOrder {
    bound_scene: ComputeStage,
    count_cells: ComputeStage,
    sum_cells: ComputeStage,
    place_cells: ComputeStage,
    order_primitives: ComputeStage,
    bound_chunks: ComputeStage,
    size_chunks: ComputeStage,
    take_order: ComputeStage,
    params: GrowingBuffer,
    bounds: GrowingBuffer,
    /// How many primitives a cell has, then where they begin.
    cells: GrowingBuffer,
    group_sums: GrowingBuffer,
    places: GrowingBuffer,
    /// As primitives came.
    first_chunks: GrowingBuffer,
    sizes: GrowingBuffer,
    /// Of each part of the primitives.
    ordered: Vec<Ordered>,
}

/// Primitives in their order, and the spheres around their chunks.
#[derive(Debug)]
struct Ordered {
    primitives: GrowingBuffer,
    chunks: GrowingBuffer,
}

impl Ordered {
    const fn new() -> Self {
        let primitives = GrowingBuffer::storage("ordered primitives");
        Self { primitives, chunks: GrowingBuffer::storage("chunks") }
    }
}

impl BucketOrder {
    pub(super) fn new(context: &GpuContext) -> Self {
        let stage = |shader| compute_stage(context, shader, &[]);
        Self {
            bound_scene: stage(shaders::BOUND_SCENE),
            count_cells: stage(shaders::COUNT_CELLS),
            sum_cells: stage(shaders::SUM_CELLS),
            place_cells: stage(shaders::PLACE_CELLS),
            order_primitives: stage(shaders::ORDER_PRIMITIVES),
            bound_chunks: stage(shaders::BOUND_CHUNKS),
            size_chunks: stage(shaders::SIZE_CHUNKS),
            take_order: stage(shaders::TAKE_ORDER),
            params: GrowingBuffer::new("params", BufferUsages::UNIFORM),
            bounds: GrowingBuffer::storage("bounds"),
            cells: GrowingBuffer::storage("cells"),
            group_sums: GrowingBuffer::storage("cells"),
            places: GrowingBuffer::storage("places"),
            first_chunks: GrowingBuffer::storage("chunks"),
            sizes: GrowingBuffer::storage("chunks"),
            ordered: Vec::new(),
        }
    }

    /// Orders all parts.
    pub(super) fn order(&mut self, encoder: &mut StageEncoder<'_>, primitives: &PrimitiveStore) {
        let context = encoder.context;
        let most = primitives.parts().map(|part| part.count).max().unwrap_or(0);
        let params = cell_params(most);
        self.params.write(context, &[params]);
        self.bounds.reserve(context, BOX_BYTES);
        self.cells.reserve(context, cell_bytes(&params));
        self.group_sums.reserve(context, group_count(&params) * size_of::<u32>());
        self.places.reserve(context, most * size_of::<[u32; 2]>());
        self.first_chunks.reserve(context, chunk_bytes(most));
        self.sizes.reserve(context, SIZES_BYTES);
        self.ordered.resize_with(primitives.parts().count(), Ordered::new);
        for (part, ordered) in primitives.parts().zip(&mut self.ordered) {
            ordered.primitives.reserve(context, part.bytes());
            ordered.chunks.reserve(context, chunk_bytes(part.count));
        }
        for (part_idx, part) in primitives.parts().enumerate() {
            self.sort(encoder, part_idx, part, &params);
            self.choose(encoder, part_idx, part);
        }
    }

    /// The primitives of a part in their order.
    pub(super) fn ordered(&self, part_idx: usize, part: Part<'_>) -> BindingResource<'_> {
        part_of(self.ordered[part_idx].primitives.buffer(), part.bytes())
    }

    /// The spheres around the chunks of those.
    pub(super) fn chunks(&self, part_idx: usize, part: Part<'_>) -> BindingResource<'_> {
        part_of(self.ordered[part_idx].chunks.buffer(), chunk_bytes(part.count))
    }

    /// The box around the last part, as `bound_scene` has written it.
    pub(super) fn bounds(&self) -> BindingResource<'_> {
        part_of(self.bounds.buffer(), BOX_BYTES)
    }

    #[cfg(test)]
    pub(super) fn ordered_buffer(&self, part_idx: usize) -> &Buffer {
        self.ordered[part_idx].primitives.buffer()
    }

    #[cfg(test)]
    pub(super) fn chunk_buffer(&self, part_idx: usize) -> &Buffer {
        self.ordered[part_idx].chunks.buffer()
    }

    /// Tells what is held.
    pub(super) fn hold(&self, budget: &mut Budget) {
        let ordered = self.ordered.iter();
        ordered.flat_map(|o| [&o.primitives, &o.chunks]).for_each(|buffer| buffer.hold(budget));
        let all = [&self.params, &self.bounds, &self.cells, &self.group_sums, &self.places];
        all.iter().for_each(|buffer| buffer.hold(budget));
        [&self.first_chunks, &self.sizes].iter().for_each(|buffer| buffer.hold(budget));
    }

    /// Copies the primitives of a part to the places that their cells give them.
    fn sort(
        &self,
        encoder: &mut StageEncoder<'_>,
        part_idx: usize,
        part: Part<'_>,
        params: &CellParams,
    ) {
        let primitives = part_of(part.buffer, part.bytes());
        let bounds = self.bounds();
        let cells = part_of(self.cells.buffer(), cell_bytes(params));
        let group_sums = self.group_sums.buffer().as_entire_binding();
        let places = self.places.buffer().as_entire_binding();
        let cell_params = part_of(self.params.buffer(), size_of::<CellParams>());
        encoder.encoder.clear_buffer(self.bounds.buffer(), 0, None);
        encoder.encoder.clear_buffer(self.cells.buffer(), 0, None);
        let groups = Groups::Count(part.count.div_ceil(BOUNDED_AT_ONCE));
        encoder.stage(&self.bound_scene, &[primitives.clone(), bounds.clone()], groups);
        let of_prims = Groups::Count(part.count.div_ceil(GROUP));
        let of_cells = Groups::Count(group_count(params));
        let resources =
            [primitives.clone(), bounds, cells.clone(), places.clone(), cell_params.clone()];
        encoder.stage(&self.count_cells, &resources, of_prims);
        let resources = [cells.clone(), group_sums, cell_params];
        encoder.stage(&self.sum_cells, &resources, of_cells);
        encoder.stage(&self.place_cells, &resources, of_cells);
        let resources = [primitives, places, cells, self.ordered(part_idx, part)];
        encoder.stage(&self.order_primitives, &resources, of_prims);
    }

    /// Goes back to the order in which the primitives of a part came, where that is the better one.
    fn choose(&self, encoder: &mut StageEncoder<'_>, part_idx: usize, part: Part<'_>) {
        let primitives = part_of(part.buffer, part.bytes());
        let ordered = self.ordered(part_idx, part);
        let first_chunks = part_of(self.first_chunks.buffer(), chunk_bytes(part.count));
        let chunks = self.chunks(part_idx, part);
        let sizes = part_of(self.sizes.buffer(), SIZES_BYTES);
        let of_chunks = Groups::Count(part.count.div_ceil(CHUNK_PRIMS).div_ceil(GROUP));
        let resources = [primitives.clone(), first_chunks.clone()];
        encoder.stage(&self.bound_chunks, &resources, of_chunks);
        encoder.stage(&self.bound_chunks, &[ordered.clone(), chunks.clone()], of_chunks);
        let resources = [first_chunks.clone(), chunks.clone(), sizes.clone()];
        encoder.stage(&self.size_chunks, &resources, Groups::Count(2));
        let resources = [primitives, first_chunks, sizes, ordered, chunks];
        encoder.stage(&self.take_order, &resources, Groups::Count(part.count.div_ceil(GROUP)));
    }
}

/// Cells for so many primitives: of the finest level a surface meets about one for sixteen.
fn cell_params(prim_count: usize) -> CellParams {
    let finest = (prim_count.max(1).ilog2() / 2).saturating_sub(2).min(FINEST);
    // All levels, and one for what is never seen.
    let cell_count = ((1 << (3 * (finest + 1))) - 1) / 7 + 1;
    CellParams { finest, cell_count, ..CellParams::default() }
}

const fn cell_bytes(params: &CellParams) -> usize {
    params.cell_count as usize * size_of::<u32>()
}

/// Workgroups that place cells.
const fn group_count(params: &CellParams) -> usize {
    (params.cell_count as usize).div_ceil(CELLS_EACH * PLACERS)
}

/// Bytes of the spheres around the chunks of so many primitives.
const fn chunk_bytes(prim_count: usize) -> usize {
    prim_count.div_ceil(CHUNK_PRIMS) * SPHERE_BYTES
}

#[cfg(test)]
mod tests;
