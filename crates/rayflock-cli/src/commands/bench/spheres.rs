//! `rayflock bench spheres`: what spheres in place of geometry save in indirect light.

use anyhow::Context;
use rayflock_bench::spheres::{self, SpheresBench};
use rayflock_bench::{EngineSpec, table};

use super::moving_input::MovingInput;
use super::{engines, output};
use crate::args::BenchSpheresArguments;
use crate::failure::{Blame, Failure};
use crate::progress::Progress;
use crate::terminal;

/// Frames measured when none are asked for.
const DEFAULT_FRAME_COUNT: u64 = 3;

/// Measures what the user asked for.
pub(super) fn run(args: &BenchSpheresArguments) -> Result<(), Failure> {
    let frames = (args.frames, DEFAULT_FRAME_COUNT);
    let mut input = MovingInput::open(&args.input, args.size, frames).blame_input()?;
    let mut bench = define(args, &input);
    if bench.engines.iter().any(EngineSpec::needs_embree) {
        bench.library = engines::library(&args.engines)?;
    }
    output::check(&args.output)?;

    let round_count = 1 + (bench.frames.len() * bench.run_count) as u64;
    let progress = Progress::new(&bench.name, round_count, 0);
    let (evaluator, view) = input.play();
    let measured = spheres::measure(&bench, evaluator, &view, &mut || progress.advance());
    progress.finish();
    let record = measured.with_context(|| bench.name.clone()).blame_input()?;

    output::write(&args.output, &record)?;
    terminal::answer(&table::format(&record)).blame_output()
}

/// What is to be measured, without the library that some engines need.
fn define(args: &BenchSpheresArguments, input: &MovingInput) -> SpheresBench {
    SpheresBench {
        name: input.name.clone(),
        engines: args.engines.engines.clone(),
        library: None,
        sphere_counts: args.spheres.iter().map(|&count| count as usize).collect(),
        lookout_points: args.lookouts.iter().map(|&points| points as usize).collect(),
        light_count: args.vpls,
        frames: input.frames.clone(),
        frame_rate: input.frame_rate,
        size: [args.size.width as usize, args.size.height as usize],
        depth: args.depth,
        run_count: usize::from(args.runs),
    }
}
