//! `rayflock bench museum`: what the pictures of an animation cost with each engine.

use anyhow::{Context, Result, anyhow};
use rayflock::render::RenderSettings;
use rayflock::scene::Evaluator;
use rayflock_bench::museum::{self, MuseumBench};
use rayflock_bench::{EngineSpec, table};

use super::{engines, output};
use crate::args::BenchMuseumArguments;
use crate::failure::{Blame, Failure};
use crate::frames::FrameRange;
use crate::input::Input;
use crate::plan::{self, PlannedCamera};
use crate::progress::Progress;
use crate::terminal;

/// Frames measured when none are asked for.
const DEFAULT_FRAME_COUNT: u64 = 20;

/// Measures what the user asked for.
pub(super) fn run(args: &BenchMuseumArguments) -> Result<(), Failure> {
    let input = Input::open(&args.input()).blame_input()?;
    let mut evaluator = Evaluator::new(input.scene.clone(), None).blame_input()?;
    let camera = PlannedCamera::new(&evaluator, None, args.size).blame_input()?;
    let mut bench = define(args, &input, &evaluator).blame_input()?;
    if bench.engines.iter().any(EngineSpec::needs_embree) {
        bench.library = engines::library(&args.engines)?;
    }
    for warning in &input.warnings {
        terminal::say(format_args!("warning: {warning}"));
    }
    output::check(&args.output)?;

    let round_count = 1 + (bench.frames.len() * bench.run_count) as u64;
    let progress = Progress::new(&input.name, round_count, 0);
    let view = |frame: &_| camera.view(&input.scene, frame);
    let measured = museum::measure(&bench, &mut evaluator, &view, &mut || progress.advance());
    progress.finish();
    let record = measured.with_context(|| input.name.clone()).blame_input()?;

    output::write(&args.output, &record)?;
    terminal::answer(&table::format(&record)).blame_output()?;
    if record.same_films() {
        return Ok(());
    }
    Err(anyhow!("{}: the engines' films differ, but must be the same in every bit", input.name))
        .blame_output()
}

/// What is to be measured, without the library that some engines need.
fn define(
    args: &BenchMuseumArguments,
    input: &Input,
    evaluator: &Evaluator,
) -> Result<MuseumBench> {
    let frame_rate = input.scene.default_frame_rate();
    let whole = FrameRange::first_frames(input.whole_motion(evaluator.clip(), frame_rate));
    let frames = match args.frames {
        Some(asked) => {
            plan::check_frames(asked, whole, input)?;
            asked.iter().collect()
        }
        None => whole.spread(DEFAULT_FRAME_COUNT),
    };
    Ok(MuseumBench {
        name: input.name.clone(),
        engines: args.engines.engines.clone(),
        library: None,
        frames,
        frame_rate,
        size: [args.size.width as usize, args.size.height as usize],
        run_count: usize::from(args.runs),
        settings: RenderSettings { depth: args.depth, ..RenderSettings::default() },
    })
}
