//! `rayflock convert`: the geometry of frames as files of other programs.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

use anyhow::Context;
use rayflock::import::export::{FrameMesh, FrameSet, MorphSet, write_obj, write_ply};

use crate::args::ConvertArguments;
use crate::convert_plan::{ConvertPlan, MeshFormat, MeshTarget};
use crate::failure::{Blame, Failure};
use crate::interrupt::Interrupt;
use crate::output::atomic;
use crate::progress::Progress;
use crate::terminal;

/// Plans the conversion, then carries it out.
pub(super) fn run(args: &ConvertArguments) -> Result<(), Failure> {
    let mut plan = ConvertPlan::new(args)?;
    for warning in &plan.input.warnings {
        terminal::say(format_args!("warning: {warning}"));
    }
    plan.target.prepare(plan.frames).blame_output()?;
    let interrupt = Interrupt::listen().blame_output()?;
    let progress = Progress::new(&plan.input.name, plan.frames.count(), 0);
    let written = write(&mut plan, &interrupt, &progress);
    progress.finish();
    written
}

fn write(
    plan: &mut ConvertPlan,
    interrupt: &Interrupt,
    progress: &Progress,
) -> Result<(), Failure> {
    let meshes = plan.target.meshes(plan.frames.count());
    let (mut set, mut morphs) = (FrameSet::new(), MorphSet::new());
    let mut lost_before = false;
    for (done_count, frame) in plan.frames.iter().enumerate() {
        if interrupt.is_raised() {
            let count = plan.frames.count();
            return Err(Failure::Interrupted(format!(
                "stopped after {done_count} of {count} frames"
            )));
        }
        let mesh = mesh(plan, frame)?;
        if let Some(lost) = lost(&mesh, &plan.target).filter(|_| !lost_before) {
            lost_before = true;
            let name = &plan.input.name;
            progress.say(format_args!("warning: {name}: frame {frame}: {lost}"));
        }
        match (&meshes, &plan.target) {
            (Some((names, format)), _) => write_mesh(&names.path(frame), *format, &mesh)?,
            (None, MeshTarget::Morphs(_)) => {
                let context = || format!("{}: frame {frame}", plan.input.name);
                morphs.push(&mesh).with_context(context).blame_input()?;
            }
            (None, _) => set.push(&mesh),
        }
        progress.advance();
    }
    match &plan.target {
        MeshTarget::FrameSet(path) => write_file(path, |out| set.write(plan.fps, out)),
        MeshTarget::Morphs(path) => write_file(path, |out| morphs.write(plan.fps, out)),
        _ => Ok(()),
    }
}

/// The geometry of a frame.
fn mesh(plan: &mut ConvertPlan, frame: u32) -> Result<FrameMesh, Failure> {
    let time = plan.time(frame);
    let evaluated = plan.evaluator.evaluate(time);
    let context = || format!("{}: frame {frame}", plan.input.name);
    Ok(FrameMesh::new(&evaluated.with_context(context).blame_input()?.geometry))
}

/// What a target has no place for.
fn lost(mesh: &FrameMesh, target: &MeshTarget) -> Option<String> {
    let format = match target {
        MeshTarget::FrameSet(_) => return None,
        MeshTarget::Morphs(_) => ".glb".to_owned(),
        MeshTarget::Mesh(_, format) | MeshTarget::Meshes(_, format) => {
            if *format == MeshFormat::Ply && mesh.triangles.is_empty() {
                return None;
            }
            format.to_string()
        }
    };
    let count = mesh.spheres.len();
    (count > 0)
        .then(|| format!("{count} spheres are left out, for which {format} has no place; .npz has"))
}

fn write_mesh(path: &Path, format: MeshFormat, mesh: &FrameMesh) -> Result<(), Failure> {
    write_file(path, |mut out| match format {
        MeshFormat::Ply => write_ply(mesh, &mut out),
        MeshFormat::Obj => write_obj(mesh, &mut out),
    })
}

/// Has `content` write the file at `path`.
fn write_file(
    path: &Path,
    content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), Failure> {
    let write = |partial: &Path| {
        let mut out = BufWriter::new(File::create(partial)?);
        content(&mut out)?;
        out.into_inner().map_err(io::IntoInnerError::into_error)?;
        Ok(())
    };
    atomic::write_whole(path, write).blame_output()
}
