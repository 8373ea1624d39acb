//! Stages on their way to the device.

use wgpu::{BindingResource, Buffer, CommandEncoder};

use crate::GpuContext;
use crate::buffer::bind;
use crate::pipeline::{ComputeStage, groups_of};
use crate::stage_clock::StageClock;

/// Takes stages that compute, one pass each, so that each is timed.
pub(crate) struct StageEncoder<'a> {
    pub(crate) context: &'a GpuContext,
    pub(crate) clock: &'a mut StageClock,
    pub(crate) encoder: CommandEncoder,
}

/// How many workgroups a stage takes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Groups<'a> {
    /// So many at least, in two dimensions.
    Count(usize),
    /// As many as an earlier stage has written.
    Planned(&'a Buffer),
}

impl<'a> StageEncoder<'a> {
    pub(crate) fn new(context: &'a GpuContext, clock: &'a mut StageClock) -> Self {
        let encoder = context.device.create_command_encoder(&Default::default());
        Self { context, clock, encoder }
    }

    /// Adds a stage.
    pub(crate) fn stage(
        &mut self,
        stage: &ComputeStage,
        resources: &[BindingResource<'_>],
        groups: Groups<'_>,
    ) {
        let group = bind(self.context, &stage.pipeline.get_bind_group_layout(0), resources);
        let mut pass = self.clock.compute_pass(&mut self.encoder, stage.name);
        pass.set_pipeline(&stage.pipeline);
        pass.set_bind_group(0, &group, &[]);
        match groups {
            Groups::Count(count) => {
                let [x, y] = groups_of(count);
                pass.dispatch_workgroups(x, y, 1);
            }
            Groups::Planned(counts) => pass.dispatch_workgroups_indirect(counts, 0),
        }
    }

    /// Hands everything to the device.
    pub(crate) fn submit(self) {
        self.context.queue.submit([self.encoder.finish()]);
    }
}
