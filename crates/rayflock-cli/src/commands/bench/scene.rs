//! `rayflock bench scene`: rays of each kind over the frames of an animation.

use anyhow::Context;
use rayflock_bench::contest::Effort;
use rayflock_bench::scene::{self, SceneBench};

use super::moving_input::MovingInput;
use super::watcher::Watcher;
use super::{engines, output};
use crate::args::BenchSceneArguments;
use crate::failure::{Blame, Failure};
use crate::terminal;

/// Frames measured when none are asked for.
const DEFAULT_FRAME_COUNT: u64 = 5;

/// Measures what the user asked for.
pub(super) fn run(args: &BenchSceneArguments) -> Result<(), Failure> {
    let frames = (args.frames, DEFAULT_FRAME_COUNT);
    let mut input = MovingInput::open(&args.input, args.size, frames).blame_input()?;
    let library = engines::library(&args.engines)?;
    output::check(&args.output)?;

    let effort = Effort::of_runs(usize::from(args.runs)).settled();
    let bench = SceneBench {
        name: input.name.clone(),
        frames: input.frames.clone(),
        frame_rate: input.frame_rate,
        size: [args.size.width as usize, args.size.height as usize],
        kinds: args.kind.clone(),
        setup: engines::setup(&args.engines, library, effort),
    };
    let mut watcher = Watcher::new(&bench.name, bench.kinds.len())?;
    let (evaluator, view) = input.play();
    let measured = scene::measure(&bench, evaluator, &view, &mut watcher);
    let stopped = watcher.finish();
    let record = measured.with_context(|| bench.name.clone()).blame_input()?;

    output::write(&args.output, &record)?;
    terminal::answer(&scene::format(&record)).blame_output()?;
    stopped
}
