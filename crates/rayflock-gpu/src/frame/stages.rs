//! The stages, ready to run.

use crate::GpuContext;
use crate::pipeline::{ComputeStage, compute_stage};
use crate::shaders;

/// The stages of a picture, but for those that trace.
#[derive(Debug)]
pub(super) struct FrameStages {
    pub(super) camera_rays: ComputeStage,
    pub(super) shade_surface: ComputeStage,
    pub(super) add_emitted: ComputeStage,
    pub(super) shadow_rays: ComputeStage,
    pub(super) add_lit: ComputeStage,
    pub(super) gather_lights: ComputeStage,
}

impl FrameStages {
    pub(super) fn new(context: &GpuContext) -> Self {
        let stage = |shader| compute_stage(context, shader, &[]);
        Self {
            camera_rays: stage(shaders::CAMERA_RAYS),
            shade_surface: stage(shaders::SHADE_SURFACE),
            add_emitted: stage(shaders::ADD_EMITTED),
            shadow_rays: stage(shaders::SHADOW_RAYS),
            add_lit: stage(shaders::ADD_LIT),
            gather_lights: stage(shaders::GATHER_LIGHTS),
        }
    }
}
