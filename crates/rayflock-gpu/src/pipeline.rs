//! Programs made ready to run.

use wgpu::{
    ColorTargetState, ComputePipeline, ComputePipelineDescriptor, DepthStencilState, FragmentState,
    PipelineCompilationOptions, RenderPipeline, RenderPipelineDescriptor, ShaderModule,
    ShaderModuleDescriptor, ShaderSource, TextureFormat, VertexBufferLayout, VertexState,
};

use crate::GpuContext;
use crate::shaders::Shader;

/// A program that is ready to run, and its name.
#[derive(Debug)]
pub(crate) struct Stage<Pipeline> {
    pub(crate) name: &'static str,
    pub(crate) pipeline: Pipeline,
}

pub(crate) type ComputeStage = Stage<ComputePipeline>;
pub(crate) type DrawStage = Stage<RenderPipeline>;

/// A stage that computes: the entry point has the name of the file.
pub(crate) fn compute_stage(
    context: &GpuContext,
    shader: Shader,
    constants: &[(&str, f64)],
) -> ComputeStage {
    let options = PipelineCompilationOptions { constants, ..Default::default() };
    let pipeline = context.device.create_compute_pipeline(&ComputePipelineDescriptor {
        label: Some(shader.name),
        layout: None,
        module: &module(context, shader),
        entry_point: None,
        compilation_options: options,
        cache: None,
    });
    Stage { name: shader.name, pipeline }
}

/// A stage that draws to `targets`.
pub(crate) fn draw_stage(
    context: &GpuContext,
    shader: Shader,
    constants: &[(&str, f64)],
    buffers: &[Option<VertexBufferLayout<'_>>],
    targets: &[TextureFormat],
    depth_stencil: Option<DepthStencilState>,
) -> DrawStage {
    let module = module(context, shader);
    let options = PipelineCompilationOptions { constants, ..Default::default() };
    let targets: Vec<_> =
        targets.iter().map(|&format| Some(ColorTargetState::from(format))).collect();
    let pipeline = context.device.create_render_pipeline(&RenderPipelineDescriptor {
        label: Some(shader.name),
        layout: None,
        vertex: VertexState {
            module: &module,
            entry_point: None,
            compilation_options: options.clone(),
            buffers,
        },
        primitive: Default::default(),
        depth_stencil,
        multisample: Default::default(),
        fragment: Some(FragmentState {
            module: &module,
            entry_point: None,
            compilation_options: options,
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    });
    Stage { name: shader.name, pipeline }
}

/// As many workgroups at least, in two dimensions: one holds at most 65535.
pub(crate) fn groups_of(count: usize) -> [u32; 2] {
    const ROW: usize = 32768;
    [count.min(ROW) as u32, count.div_ceil(ROW) as u32]
}

fn module(context: &GpuContext, shader: Shader) -> ShaderModule {
    context.device.create_shader_module(ShaderModuleDescriptor {
        label: Some(shader.name),
        source: ShaderSource::Wgsl(shader.source.into()),
    })
}
