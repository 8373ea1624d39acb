//! `rayflock bench spheres`: what spheres in place of geometry save in indirect light.

use anyhow::{Context, Result};
use rayflock::scene::Evaluator;
use rayflock_bench::spheres::{self, SpheresBench};
use rayflock_bench::{EngineSpec, table};

use super::{engines, output};
use crate::args::BenchSpheresArguments;
use crate::failure::{Blame, Failure};
use crate::frames::FrameRange;
use crate::input::Input;
use crate::plan::{self, PlannedCamera};
use crate::progress::Progress;
use crate::terminal;

/// Frames measured when none are asked for.
const DEFAULT_FRAME_COUNT: u64 = 3;

/// Measures what the user asked for.
pub(super) fn run(args: &BenchSpheresArguments) -> Result<(), Failure> {
    let input = Input::open(&args.input).blame_input()?;
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
    let measured = spheres::measure(&bench, &mut evaluator, &view, &mut || progress.advance());
    progress.finish();
    let record = measured.with_context(|| input.name.clone()).blame_input()?;

    output::write(&args.output, &record)?;
    terminal::answer(&table::format(&record)).blame_output()
}

/// What is to be measured, without the library that some engines need.
fn define(
    args: &BenchSpheresArguments,
    input: &Input,
    evaluator: &Evaluator,
) -> Result<SpheresBench> {
    let frame_rate = input.scene.default_frame_rate();
    let whole = FrameRange::first_frames(input.whole_motion(evaluator.clip(), frame_rate));
    let frames = match args.frames {
        Some(asked) => {
            plan::check_frames(asked, whole, input)?;
            asked.iter().collect()
        }
        None => whole.spread(DEFAULT_FRAME_COUNT),
    };
    Ok(SpheresBench {
        name: input.name.clone(),
        engines: args.engines.engines.clone(),
        library: None,
        sphere_counts: args.spheres.iter().map(|&count| count as usize).collect(),
        light_count: args.vpls,
        frames,
        frame_rate,
        size: [args.size.width as usize, args.size.height as usize],
        depth: args.depth,
        run_count: usize::from(args.runs),
    })
}
