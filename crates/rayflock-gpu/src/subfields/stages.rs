//! The stages, ready to run.

use crate::GpuContext;
use crate::pipeline::{ComputeStage, compute_stage};
use crate::shaders;

/// The stages, ready to run.
#[derive(Debug)]
pub(super) struct Stages {
    pub(super) bound_scene: ComputeStage,
    pub(super) mark_directions: ComputeStage,
    pub(super) open_subfields: ComputeStage,
    pub(super) write_tiles: ComputeStage,
    pub(super) place_tiles: ComputeStage,
    pub(super) trace_rays: ComputeStage,
}

impl Stages {
    pub(super) fn new(context: &GpuContext) -> Self {
        let stage = |shader| compute_stage(context, shader, &[]);
        Self {
            bound_scene: stage(shaders::BOUND_SCENE),
            mark_directions: stage(shaders::MARK_DIRECTIONS),
            open_subfields: stage(shaders::OPEN_SUBFIELDS),
            write_tiles: stage(shaders::WRITE_TILES),
            place_tiles: stage(shaders::PLACE_TILES),
            trace_rays: stage(shaders::TRACE_RAYS),
        }
    }
}
