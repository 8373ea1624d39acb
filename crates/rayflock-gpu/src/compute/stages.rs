//! The stages, ready to run.

use super::{FIRST_NODE, FIRST_ROOT};
use crate::GpuContext;
use crate::pipeline::{ComputeStage, compute_stage};
use crate::shaders;

/// How the work on a tile is shared out among invocations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// One a ray, for processors: `compute/narrow.wgsl`.
    Narrow,
    /// Some a ray, for cards: `compute/wide.wgsl`.
    Wide,
}

impl Form {
    /// All of them.
    #[cfg(test)]
    pub(crate) const ALL: [Self; 2] = [Self::Narrow, Self::Wide];

    /// What suits a device.
    pub(crate) fn of(context: &GpuContext) -> Self {
        if context.adapter().is_software() { Self::Narrow } else { Self::Wide }
    }
}

/// The stages, ready to run.
#[derive(Debug)]
pub(super) struct Stages {
    pub(super) bound_blocks: ComputeStage,
    pub(super) bound_tiles: ComputeStage,
    pub(super) bound_nodes: ComputeStage,
    pub(super) bound_roots: ComputeStage,
    pub(super) seed_pairs: ComputeStage,
    /// For the pairs of roots, of nodes and of tiles.
    pub(super) plan_dispatch: [ComputeStage; 3],
    pub(super) refine_roots: ComputeStage,
    pub(super) refine_nodes: ComputeStage,
    pub(super) plan_lists: ComputeStage,
    pub(super) fill_lists: ComputeStage,
    pub(super) trace_tile: ComputeStage,
}

impl Stages {
    pub(super) fn new(context: &GpuContext, form: Form) -> Self {
        let stage = |shader, constants: &[(&str, f64)]| compute_stage(context, shader, constants);
        let bound = |first_child: usize, first_parent: usize| {
            let constants =
                [("FIRST_CHILD", first_child as f64), ("FIRST_PARENT", first_parent as f64)];
            stage(shaders::BOUND_NODES, &constants)
        };
        let plan = |level| stage(shaders::PLAN_DISPATCH, &[("LEVEL", level)]);
        let refine = |is_last| stage(shaders::REFINE, &[("IS_LAST", is_last)]);
        Self {
            bound_blocks: stage(shaders::BOUND_BLOCKS, &[]),
            bound_tiles: stage(shaders::BOUND_TILES, &[]),
            bound_nodes: bound(0, FIRST_NODE),
            bound_roots: bound(FIRST_NODE, FIRST_ROOT),
            seed_pairs: stage(shaders::SEED_PAIRS, &[]),
            plan_dispatch: [plan(0.0), plan(1.0), plan(2.0)],
            refine_roots: refine(0.0),
            refine_nodes: refine(1.0),
            plan_lists: stage(shaders::PLAN_LISTS, &[]),
            fill_lists: stage(shaders::FILL_LISTS, &[]),
            trace_tile: stage(shaders::TRACE_TILE[form as usize], &[]),
        }
    }
}
