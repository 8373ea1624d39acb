//! `rayflock render`: plan, frames, the film they make, statistics.

use std::fs;

use anyhow::{Context, Result};
use rayflock::geom::simd::SimdLevel;
use rayflock::render::FrameRenderer;
use tracing::debug_span;

#[cfg(feature = "gpu")]
use crate::args::Integrator;
use crate::args::{Device, RenderArguments};
use crate::failure::{Blame, Failure};
use crate::interrupt::Interrupt;
use crate::journal::Journal;
use crate::output::film::{self, Reel};
use crate::output::{FrameNames, Target};
use crate::plan::RenderPlan;
use crate::session::Session;
use crate::stats::Stats;
use crate::terminal;

/// Plans the render, then carries it out.
pub(super) fn run(args: &RenderArguments) -> Result<(), Failure> {
    let plan = RenderPlan::new(args)?;
    let renderer = create_renderer(args)?;
    for warning in &plan.input.warnings {
        terminal::say(format_args!("warning: {warning}"));
    }
    plan.prepare_output().blame_output()?;

    let interrupt = Interrupt::listen().blame_output()?;
    let names = plan.target.frame_names(plan.frames.count());
    let mut journal = Journal::open(&names, &plan.journal_settings(), plan.resume)?;
    let mut session = Session::new(plan, renderer);
    session.render_frames(&names, &mut journal, &interrupt)?;

    let plan = session.into_plan();
    assemble(&plan, &names, &interrupt)?;
    report(&plan, &journal).blame_output()
}

/// What renders the frames.
fn create_renderer(args: &RenderArguments) -> Result<Box<dyn FrameRenderer>, Failure> {
    let integrator = args.light.integrator;
    match args.device {
        Device::Cpu => {}
        #[cfg(feature = "gpu")]
        Device::Gpu(adapter) if integrator == Integrator::Whitted => {
            let renderer = rayflock::gpu::GpuRenderer::open(adapter);
            return Ok(Box::new(renderer.context("--device gpu").blame_input()?));
        }
        #[cfg(feature = "gpu")]
        Device::Gpu(_) => terminal::say(format_args!(
            "warning: the graphics device cannot trace paths; the renderer on the CPU does"
        )),
    }
    Ok(integrator.renderer(args.engine.create().blame_input()?))
}

/// Makes a film of the frames, and removes them once it is there.
fn assemble(plan: &RenderPlan, names: &FrameNames, interrupt: &Interrupt) -> Result<(), Failure> {
    let Target::Film(path, container) = &plan.target else { return Ok(()) };
    let _span = debug_span!("write_film").entered();
    let frames = plan.frames.iter().map(|frame| names.path(frame)).collect();
    let reel = Reel { frames, size: plan.size, fps: plan.fps, interrupt };
    match film::write(path, *container, &reel) {
        Err(_) if interrupt.is_raised() => Err(Failure::Interrupted(
            "stopped before the film was put together; the same command with --resume goes on"
                .to_owned(),
        )),
        written => written.blame_output(),
    }?;
    let folder = names.folder();
    fs::remove_dir_all(&folder)
        .with_context(|| format!("cannot remove the frames in {}", folder.display()))
        .blame_output()
}

/// Writes what the user wants to know about the render.
fn report(plan: &RenderPlan, journal: &Journal) -> Result<()> {
    let frames: Vec<_> = plan.frames.iter().filter_map(|f| journal.get(f).cloned()).collect();
    let stats = Stats {
        version: env!("CARGO_PKG_VERSION"),
        input: plan.input.name.clone(),
        engine: plan.engine.to_string(),
        device: plan.device.to_string(),
        threads: rayon::current_num_threads(),
        simd: SimdLevel::best().name(),
        size: plan.size,
        samples_per_pixel: plan.settings.samples_per_pixel,
        depth: plan.settings.depth,
        triangles: frames.iter().map(|record| record.triangles).max().unwrap_or(0),
        frames,
    };
    if let Some(path) = &plan.stats {
        stats.write(path)?;
    }
    if let Some(plot) = &plan.plot {
        plot.write(&stats)?;
    }
    Ok(())
}
