//! The study under way: frame by frame, and the steps of the sun in each.

use std::mem;
use std::time::Instant;

use anyhow::Context;
use glam::Vec3;
use rayflock::engine::RayEngine;
use rayflock::geom::Geometry;
use rayflock::render::sun::{SunMeter, SunStep, WorldMesh};
use rayflock::scene::Evaluator;

use super::hours::SunHours;
use super::picture::{self, PlannedPicture};
use super::plan::SunPlan;
use crate::failure::{Blame, Failure};
use crate::interrupt::Interrupt;
use crate::progress::Progress;
use crate::session::ignored_warning;
use crate::terminal;

/// What lives from step to step.
#[derive(Debug)]
pub(super) struct Study<'a> {
    plan: &'a SunPlan,
    evaluator: Evaluator,
    meter: SunMeter,
    /// The frame that the meter holds.
    frame: u32,
    /// The scene in its first frame.
    mesh: WorldMesh,
    /// Where the samples are in the first frame.
    positions: Vec<Vec3>,
    effort: Effort,
}

/// What the study took.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Effort {
    /// Rays to the sun.
    pub(super) ray_count: u64,
    /// Time for them and for the frames, in seconds.
    pub(super) seconds: f64,
    /// Samples without a normal, which are never lit.
    pub(super) blind_count: usize,
}

impl<'a> Study<'a> {
    /// Takes in the first frame.
    pub(super) fn new(plan: &'a SunPlan, engine: Box<dyn RayEngine>) -> Result<Self, Failure> {
        let start = Instant::now();
        let mut evaluator = plan.evaluator.clone();
        let mut meter = SunMeter::new(engine, plan.sampling, plan.sides);
        let frame = plan.frames.first;
        let (mesh, geometry) = commit(plan, frame, &mut evaluator, &mut meter)?;
        let when = format!("frame {frame}");
        if let Some(text) = ignored_warning(&plan.input.name, &when, &geometry) {
            terminal::say(format_args!("warning: {text}"));
        }
        let samples = meter.samples();
        let positions = samples.iter().map(|sample| sample.position).collect();
        let effort = Effort {
            ray_count: 0,
            seconds: start.elapsed().as_secs_f64(),
            blind_count: samples.iter().filter(|sample| !sample.has_normal()).count(),
        };
        Ok(Self { plan, evaluator, meter, frame, mesh, positions, effort })
    }

    /// Adds up all steps, frame by frame, so that each frame is taken in once.
    pub(super) fn measure(&mut self, interrupt: &Interrupt) -> Result<(), Failure> {
        let start = Instant::now();
        let plan = self.plan;
        let mut steps: Vec<(u32, &SunStep)> =
            plan.steps.iter().map(|step| (plan.frame_at(step), step)).collect();
        steps.sort_by_key(|(frame, _)| *frame);

        let progress = Progress::of_steps(&plan.input.name, steps.len() as u64);
        for (done_count, (frame, step)) in steps.iter().enumerate() {
            if interrupt.is_raised() {
                progress.finish();
                return Err(Failure::Interrupted(format!(
                    "stopped after {done_count} of {} steps; nothing was written",
                    steps.len()
                )));
            }
            self.show(*frame)?;
            self.effort.ray_count += self.meter.add(step.to_sun, step.seconds).rays;
            progress.advance();
        }
        progress.finish();
        if let Some(notice) = self.meter.notice() {
            terminal::say(format_args!("warning: {notice}"));
        }
        self.effort.seconds += start.elapsed().as_secs_f64();
        Ok(())
    }

    /// Hands out what was found; after that, there is only the picture to be drawn.
    pub(super) fn finish(&mut self) -> SunHours<'a> {
        let hours_per_second = self.plan.hours_per_second();
        SunHours {
            mesh: mem::take(&mut self.mesh),
            sampling: self.plan.sampling,
            positions: mem::take(&mut self.positions),
            hours: self.meter.seconds().iter().map(|seconds| seconds * hours_per_second).collect(),
            steps: &self.plan.steps,
            hours_per_second,
            is_average: self.plan.is_average,
        }
    }

    /// What it took.
    pub(super) const fn effort(&self) -> &Effort {
        &self.effort
    }

    /// Draws the first frame.
    pub(super) fn draw(
        &mut self,
        planned: &PlannedPicture,
        hours: &SunHours<'_>,
    ) -> Result<(), Failure> {
        let plan = self.plan;
        let frame = plan.frames.first;
        self.show(frame)?;
        // The evaluator has just made this frame: making it again costs nothing, and has cameras.
        let scene_frame = self.evaluator.evaluate(plan.time(frame)).blame_input()?;
        let view = planned.camera.view(&plan.input.scene, scene_frame);
        picture::write(planned, &view, &mut self.meter, hours).blame_output()
    }

    /// Takes in a frame, if the meter does not hold it.
    fn show(&mut self, frame: u32) -> Result<(), Failure> {
        if frame != self.frame {
            commit(self.plan, frame, &mut self.evaluator, &mut self.meter)?;
            self.frame = frame;
        }
        Ok(())
    }
}

/// Has `meter` take in a frame.
fn commit(
    plan: &SunPlan,
    frame: u32,
    evaluator: &mut Evaluator,
    meter: &mut SunMeter,
) -> Result<(WorldMesh, Geometry), Failure> {
    let context = || format!("{}: frame {frame}", plan.input.name);
    let scene_frame = evaluator.evaluate(plan.time(frame)).with_context(context).blame_input()?;
    let committed = meter.commit(&scene_frame.geometry, &scene_frame.changes);
    let (mesh, _) = committed.with_context(context).blame_input()?;
    Ok((mesh, scene_frame.geometry.clone()))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use clap::Parser;
    use rayflock::engine::{EngineKind, create};
    use rayflock::geom::Mesh;
    use rayflock::scene::{
        Material, MaterialIdx, MeshSequence, Scene, SceneObject, Shape, SurfaceMesh,
    };

    use super::*;
    use crate::args::{Arguments, Command};

    /// A scene with one triangle in frame 0 and two in frame 1.
    fn growing() -> Scene {
        let mesh = |triangle_count| {
            let corners = vec![Vec3::ZERO, Vec3::X, Vec3::NEG_Z];
            let mesh = Mesh::from_triangles(corners, vec![[0, 1, 2]; triangle_count]).unwrap();
            SurfaceMesh::new(mesh, MaterialIdx(0))
        };
        let sequence = MeshSequence::at_frame_rate(vec![mesh(1), mesh(2)], 24.0).unwrap();
        let shape = Shape::Animated(Arc::new(sequence));
        let object = SceneObject { name: "growing".to_owned(), node: None, mask: 1, shape };
        let materials = vec![Material::default()];
        Scene { objects: vec![object], materials, ..Scene::default() }
    }

    #[test]
    fn a_frame_with_other_faces_is_named() {
        let words = "rayflock sun builtin:museum3 --latitude 0 --longitude 0 --date 2024-03-20 \
                     --frames 0..1 --fps 24";
        let arguments = Arguments::try_parse_from(words.split_whitespace()).unwrap();
        let Command::Sun(args) = arguments.command else { panic!("{words}") };
        let mut plan = SunPlan::new(&args).unwrap();
        plan.evaluator = Evaluator::new(Arc::new(growing()), None).unwrap();

        let mut study = Study::new(&plan, create(EngineKind::Brute)).unwrap();
        let failure = study.measure(&Interrupt::default()).unwrap_err();
        let Failure::Input(error) = failure else { panic!("{failure:?}") };
        let message = format!("{error:#}");
        let expected = "builtin:museum3: frame 1: found 2 faces, expected 1 as in the first frame";
        assert!(message.starts_with(expected), "{message}");
    }
}
