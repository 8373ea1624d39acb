//! A render under way: frame by frame, each written whole before the next begins.

use std::time::Instant;

use anyhow::Context;
use rayflock::engine::{CommitStats, Fact, count_ignored};
use rayflock::geom::Geometry;
#[cfg(feature = "bench")]
use rayflock::render::View;
use rayflock::render::{Film, FrameRenderer, FrameStats};
use rayflock::scene::Evaluator;
#[cfg(feature = "bench")]
use rayflock_bench::difference::{Difference, difference};
use tracing::debug_span;

use crate::allocations;
use crate::failure::{Blame, Failure};
use crate::interrupt::Interrupt;
use crate::journal::Journal;
use crate::output::{FrameNames, picture};
use crate::plan::RenderPlan;
use crate::progress::Progress;
use crate::stats::{DeviceRecord, ErrorRecord, FrameRecord, RayRecord, StageRecords};

/// What lives from frame to frame.
#[derive(Debug)]
pub(crate) struct Session {
    plan: RenderPlan,
    evaluator: Evaluator,
    renderer: Box<dyn FrameRenderer>,
    film: Film,
}

impl Session {
    /// Nothing is rendered yet.
    pub(crate) fn new(plan: RenderPlan, renderer: Box<dyn FrameRenderer>) -> Self {
        let evaluator = plan.evaluator.clone();
        let film = Film::new(plan.size.width as usize, plan.size.height as usize);
        Self { plan, evaluator, renderer, film }
    }

    /// The plan, when the frames are done.
    pub(crate) fn into_plan(self) -> RenderPlan {
        self.plan
    }

    /// Renders the frames that the journal does not have.
    pub(crate) fn render_frames(
        &mut self,
        names: &FrameNames,
        journal: &mut Journal,
        interrupt: &Interrupt,
    ) -> Result<(), Failure> {
        let frames = self.plan.frames;
        let missing: Vec<u32> = frames.iter().filter(|&f| journal.get(f).is_none()).collect();
        let done_count = frames.count() - missing.len() as u64;
        let progress = Progress::new(&self.plan.input.name, frames.count(), done_count);
        let (mut ignored_before, mut noticed_before) = (false, false);
        for (done_count, frame) in (done_count..).zip(missing) {
            if interrupt.is_raised() {
                progress.finish();
                return Err(stopped(done_count, frames.count()));
            }
            let record = self.render_frame(frame)?;
            if record.ignored > 0 && !ignored_before {
                ignored_before = true;
                let name = &self.plan.input.name;
                let when = format!("frame {frame}");
                let text = ignored_text(name, &when, record.ignored, record.triangles);
                progress.say(format_args!("warning: {text}"));
            }
            if let Some(notice) = self.renderer.notice()
                && !noticed_before
            {
                noticed_before = true;
                progress.say(format_args!("warning: frame {frame}: {notice}"));
            }
            if let Some(ErrorRecord { mean_flip, relative_rmse }) = record.error {
                progress.say(format_args!(
                    "frame {frame}: mean FLIP {mean_flip:.4}, relative RMSE {relative_rmse:.4} \
                     against exact visibility"
                ));
            }
            if self.plan.explain {
                for choice in self.renderer.choices() {
                    progress.say(format_args!("frame {frame}: {choice}"));
                }
                for Fact { name, value } in self.renderer.facts() {
                    progress.say(format_args!("frame {frame}: {name}: {value:.1}"));
                }
            }
            let (path, format) = (names.path(frame), self.plan.target.frame_format());
            picture::write(&path, format, &self.film, self.plan.look).blame_output()?;
            journal.add(record).blame_output()?;
            progress.advance();
        }
        progress.finish();
        Ok(())
    }

    /// Renders one frame to the film.
    fn render_frame(&mut self, frame: u32) -> Result<FrameRecord, Failure> {
        let _span = debug_span!("frame", frame).entered();
        let context = || format!("{}: frame {frame}", self.plan.input.name);
        let time = self.plan.time(frame);
        let start = Instant::now();
        let evaluated = self.evaluator.evaluate(time);
        let scene_frame = evaluated.with_context(context).blame_input()?;
        let evaluate_ms = milliseconds_since(start);

        let update_start = Instant::now();
        let (committed, update_allocations) =
            allocations::counted(|| self.renderer.commit(&self.plan.input.scene, scene_frame));
        let commit = committed.with_context(context).blame_input()?;
        let update_ms = milliseconds_since(update_start);

        let view = self.plan.view(scene_frame);
        let (stats, render_allocations) = allocations::counted(|| {
            self.renderer.render(&view, &self.plan.settings, &mut self.film)
        });
        let times = Times { evaluate_ms, update_ms, total_ms: milliseconds_since(start) };
        let held = Held {
            allocations: update_allocations.zip(render_allocations).map(|(a, b)| a + b),
            memory_bytes: self.renderer.memory_usage() as u64,
            device: DeviceRecord::new(&self.renderer.budget()),
            ignored: count_ignored(&scene_frame.geometry).count() as u64,
        };
        let record = record((frame, time), &times, &commit, &stats, held);
        #[cfg(feature = "bench")]
        let record = FrameRecord { error: self.error(&view), ..record };
        Ok(record)
    }

    /// How far the film is from one that is rendered with exact visibility, if that is asked for.
    #[cfg(feature = "bench")]
    fn error(&mut self, view: &View) -> Option<ErrorRecord> {
        let settings = self.plan.compared.as_ref()?;
        let mut exact = Film::new(self.film.width(), self.film.height());
        self.renderer.render(view, settings, &mut exact);
        let Difference { mean_flip, relative_rmse } = difference(&self.film, &exact);
        Some(ErrorRecord { mean_flip, relative_rmse })
    }
}

fn stopped(done_count: u64, frame_count: u64) -> Failure {
    Failure::Interrupted(format!(
        "stopped after {done_count} of {frame_count} frames; the same command with --resume goes on"
    ))
}

struct Times {
    evaluate_ms: f64,
    update_ms: f64,
    total_ms: f64,
}

/// What a frame took from the heap and of a device, and what of it did not count.
struct Held {
    allocations: Option<u64>,
    memory_bytes: u64,
    device: Option<DeviceRecord>,
    ignored: u64,
}

fn record(
    (frame, time): (u32, f64),
    times: &Times,
    commit: &CommitStats,
    stats: &FrameStats,
    held: Held,
) -> FrameRecord {
    let rays = RayRecord {
        primary: stats.rays.primary,
        shadow: stats.rays.shadow,
        mirror: stats.rays.mirror,
        refraction: stats.rays.refraction,
        indirect: stats.rays.indirect,
    };
    FrameRecord {
        frame,
        time,
        triangles: commit.prim_count as u64,
        evaluate_ms: times.evaluate_ms,
        update_ms: times.update_ms,
        trace_ms: milliseconds(stats.trace_seconds),
        shade_ms: milliseconds(stats.shade_seconds),
        shoot_ms: milliseconds(stats.indirect.shoot_seconds),
        gather_ms: milliseconds(stats.indirect.gather_seconds),
        fit_ms: milliseconds(stats.indirect.fit_seconds),
        spheres: stats.indirect.spheres,
        scanned: stats.scanned,
        photons: stats.caustics.photons,
        caustics_ms: milliseconds(stats.caustics.shoot_seconds + stats.caustics.gather_seconds),
        total_ms: times.total_ms,
        vpls: stats.indirect.lights,
        clamped: stats.indirect.clamped_share(),
        error: None,
        rays,
        stages: StageRecords::new(&stats.stages),
        cone_tests: stats.trace.cone_tests,
        box_tests: stats.trace.box_tests,
        triangle_tests: stats.trace.triangle_tests,
        sphere_tests: stats.trace.sphere_tests,
        tiles: stats.trace.tiles,
        pairs: stats.trace.pairs,
        bytes: stats.trace.bytes,
        allocations: held.allocations,
        ignored: held.ignored,
        memory_bytes: held.memory_bytes,
        device: held.device,
    }
}

/// A warning of the primitives that do not count in the frame that `when` tells, if there are any.
pub(crate) fn ignored_warning(input: &str, when: &str, geometry: &Geometry) -> Option<String> {
    let ignored = count_ignored(geometry).count() as u64;
    (ignored > 0).then(|| ignored_text(input, when, ignored, geometry.prim_count() as u64))
}

/// That `ignored` of `count` primitives do not count in the frame that `when` tells.
fn ignored_text(input: &str, when: &str, ignored: u64, count: u64) -> String {
    format!(
        "{input}: {when}: {ignored} of {count} primitives are ignored, because they have no \
         area or a coordinate that is not finite"
    )
}

fn milliseconds_since(start: Instant) -> f64 {
    milliseconds(start.elapsed().as_secs_f64())
}

/// To the microsecond: further digits are noise.
fn milliseconds(seconds: f64) -> f64 {
    (seconds * 1e6).round() / 1e3
}
