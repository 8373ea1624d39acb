//! `rayflock bench scene`: rays of each kind over the frames of an animation.

use anyhow::{Context, Result};
use rayflock::scene::Evaluator;
use rayflock_bench::contest::Effort;
use rayflock_bench::scene::{self, SceneBench};

use super::watcher::Watcher;
use super::{engines, output};
use crate::args::BenchSceneArguments;
use crate::failure::{Blame, Failure};
use crate::frames::FrameRange;
use crate::input::Input;
use crate::plan::{self, PlannedCamera};
use crate::terminal;

/// Frames measured when none are asked for.
const DEFAULT_FRAME_COUNT: u64 = 5;

/// Measures what the user asked for.
pub(super) fn run(args: &BenchSceneArguments) -> Result<(), Failure> {
    let input = Input::open(&args.input).blame_input()?;
    let mut evaluator = Evaluator::new(input.scene.clone(), None).blame_input()?;
    let camera = PlannedCamera::new(&evaluator, None, args.size).blame_input()?;
    let frames = frames(args, &input, &evaluator).blame_input()?;
    for warning in &input.warnings {
        terminal::say(format_args!("warning: {warning}"));
    }
    let library = engines::library(&args.engines)?;
    output::check(&args.output)?;

    let effort = Effort::of_runs(usize::from(args.runs)).settled();
    let bench = SceneBench {
        name: input.name.clone(),
        frames,
        frame_rate: input.scene.default_frame_rate(),
        size: [args.size.width as usize, args.size.height as usize],
        kinds: args.kind.clone(),
        setup: engines::setup(&args.engines, library, effort),
    };
    let mut watcher = Watcher::new(&input.name, bench.kinds.len())?;
    let view = |frame: &_| camera.view(&input.scene, frame);
    let measured = scene::measure(&bench, &mut evaluator, &view, &mut watcher);
    let stopped = watcher.finish();
    let record = measured.with_context(|| input.name.clone()).blame_input()?;

    output::write(&args.output, &record)?;
    terminal::answer(&scene::format(&record)).blame_output()?;
    stopped
}

/// The frames asked for, or some of the whole motion.
fn frames(args: &BenchSceneArguments, input: &Input, evaluator: &Evaluator) -> Result<Vec<u32>> {
    let frame_rate = input.scene.default_frame_rate();
    let whole = FrameRange::first_frames(input.whole_motion(evaluator.clip(), frame_rate));
    let Some(asked) = args.frames else { return Ok(whole.spread(DEFAULT_FRAME_COUNT)) };
    plan::check_frames(asked, whole, input)?;
    Ok(asked.iter().collect())
}
