//! The sweeps under way, step by step.

use std::time::Instant;

use anyhow::Context;
use rayflock::engine::RayEngine;
use rayflock::geom::Geometry;
use rayflock::render::sensor::{Scanner, SensorError, Sweep};
use rayflock::scene::Evaluator;

use super::plan::SensePlan;
use super::scan::Scan;
use crate::failure::{Blame, Failure};
use crate::interrupt::Interrupt;
use crate::progress::Progress;
use crate::session::ignored_warning;
use crate::terminal;

/// What lives from step to step.
#[derive(Debug)]
pub(super) struct Work<'a> {
    plan: &'a SensePlan,
    evaluator: Evaluator,
    scanner: Scanner,
    sweep: Sweep,
    effort: Effort,
}

/// What was found, and what it took.
#[derive(Clone, Copy, Debug)]
pub(super) struct Effort {
    /// Beams of a sweep.
    pub(super) beam_count: usize,
    /// Time steps of a sweep.
    pub(super) step_count: usize,
    /// Returns of all sweeps.
    pub(super) point_count: u64,
    /// The least and the most range.
    pub(super) range: Option<(f32, f32)>,
    /// The sum of all ranges.
    pub(super) range_sum: f64,
    /// Rays traced, those behind glass included.
    pub(super) ray_count: u64,
    /// Time for the sweeps, in seconds, files not included.
    pub(super) seconds: f64,
}

impl<'a> Work<'a> {
    /// About to sweep.
    pub(super) fn new(
        plan: &'a SensePlan,
        engine: Box<dyn RayEngine>,
    ) -> Result<Self, SensorError> {
        let scanner = Scanner::new(engine, plan.sensor.clone())?;
        let effort = Effort {
            beam_count: scanner.beam_count(),
            step_count: scanner.step_count(),
            point_count: 0,
            range: None,
            range_sum: 0.0,
            ray_count: 0,
            seconds: 0.0,
        };
        let evaluator = plan.evaluator.clone();
        Ok(Self { plan, evaluator, scanner, sweep: Sweep::default(), effort })
    }

    /// Sweeps, and writes the files of each sweep.
    pub(super) fn sweep_all(&mut self, interrupt: &Interrupt) -> Result<(), Failure> {
        let plan = self.plan;
        let step_count = plan.sweeps.count() * self.scanner.step_count() as u64;
        let progress = Progress::of_steps(&plan.input.name, step_count);
        let mut done = Ok(());
        for (done_count, sweep) in (0..).zip(plan.sweeps.iter()) {
            done = self.sweep(sweep, done_count, interrupt, &progress);
            if done.is_err() {
                break;
            }
        }
        progress.finish();
        if let Some(notice) = self.scanner.notice() {
            terminal::say(format_args!("warning: {notice}"));
        }
        done
    }

    /// What was found, and what it took.
    pub(super) const fn effort(&self) -> &Effort {
        &self.effort
    }

    fn sweep(
        &mut self,
        sweep: u32,
        done_count: u64,
        interrupt: &Interrupt,
        progress: &Progress,
    ) -> Result<(), Failure> {
        let start = Instant::now();
        self.scanner.begin(self.plan.start(sweep), &mut self.sweep);
        for step_idx in 0..self.scanner.step_count() {
            if interrupt.is_raised() {
                let count = self.plan.sweeps.count();
                return Err(Failure::Interrupted(format!(
                    "stopped after {done_count} of {count} sweeps"
                )));
            }
            let geometry = self.step(sweep, step_idx)?;
            if step_idx == 0 && done_count == 0 {
                let when = format!("sweep {sweep}");
                if let Some(text) = ignored_warning(&self.plan.input.name, &when, &geometry) {
                    progress.say(format_args!("warning: {text}"));
                }
            }
            progress.advance();
        }
        self.effort.seconds += start.elapsed().as_secs_f64();
        self.count();
        self.write(sweep)
    }

    /// Traces one step; returns the geometry that it saw.
    fn step(&mut self, sweep: u32, step_idx: usize) -> Result<Geometry, Failure> {
        let plan = self.plan;
        let time = self.scanner.step_time(step_idx);
        let context = || format!("{}: sweep {sweep}, at {time} s", plan.input.name);
        let frame = self.evaluator.evaluate(time).with_context(context).blame_input()?;
        let scene = &plan.input.scene;
        let traced = self.scanner.trace_step(step_idx, scene, frame, &mut self.sweep);
        let stats = traced.with_context(context).blame_input()?;
        self.effort.ray_count += stats.trace.rays;
        Ok(frame.geometry.clone())
    }

    /// Adds the sweep to what was found.
    fn count(&mut self) {
        let effort = &mut self.effort;
        effort.point_count += self.sweep.len() as u64;
        for &range in &self.sweep.range {
            let (least, most) = effort.range.unwrap_or((range, range));
            effort.range = Some((least.min(range), most.max(range)));
            effort.range_sum += f64::from(range);
        }
    }

    fn write(&self, sweep: u32) -> Result<(), Failure> {
        let scan = Scan { sweep: &self.sweep, pattern: &self.plan.sensor.pattern };
        for output in &self.plan.outputs {
            output.write(sweep, &scan).blame_output()?;
        }
        match &self.plan.picture {
            Some(picture) => picture.write(sweep, &scan).blame_output(),
            None => Ok(()),
        }
    }
}
