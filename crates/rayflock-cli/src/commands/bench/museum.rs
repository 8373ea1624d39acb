//! `rayflock bench museum`: what the pictures of an animation cost with each engine.

use anyhow::{Context, anyhow};
use rayflock::render::RenderSettings;
use rayflock_bench::museum::{self, MuseumBench};
use rayflock_bench::{EngineSpec, table};

use super::moving_input::MovingInput;
use super::{engines, output};
use crate::args::BenchMuseumArguments;
use crate::failure::{Blame, Failure};
use crate::progress::Progress;
use crate::terminal;

/// Frames measured when none are asked for.
const DEFAULT_FRAME_COUNT: u64 = 20;

/// Measures what the user asked for.
pub(super) fn run(args: &BenchMuseumArguments) -> Result<(), Failure> {
    let frames = (args.frames, DEFAULT_FRAME_COUNT);
    let mut input = MovingInput::open(&args.input(), args.size, frames).blame_input()?;
    let mut bench = define(args, &input);
    if bench.engines.iter().any(EngineSpec::needs_embree) {
        bench.library = engines::library(&args.engines)?;
    }
    output::check(&args.output)?;

    let round_count = 1 + (bench.frames.len() * bench.run_count) as u64;
    let progress = Progress::new(&bench.name, round_count, 0);
    let (evaluator, view) = input.play();
    let measured = museum::measure(&bench, evaluator, &view, &mut || progress.advance());
    progress.finish();
    let record = measured.with_context(|| bench.name.clone()).blame_input()?;

    output::write(&args.output, &record)?;
    terminal::answer(&table::format(&record)).blame_output()?;
    if record.same_films() {
        return Ok(());
    }
    Err(anyhow!("{}: the engines' films differ, but must be the same in every bit", bench.name))
        .blame_output()
}

/// What is to be measured, without the library that some engines need.
fn define(args: &BenchMuseumArguments, input: &MovingInput) -> MuseumBench {
    MuseumBench {
        name: input.name.clone(),
        engines: args.engines.engines.clone(),
        library: None,
        frames: input.frames.clone(),
        frame_rate: input.frame_rate,
        size: [args.size.width as usize, args.size.height as usize],
        run_count: usize::from(args.runs),
        settings: RenderSettings { depth: args.depth, ..RenderSettings::default() },
    }
}
