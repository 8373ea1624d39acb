//! `rayflock bench scene`: what the frames of an animation cost with each engine.

use anyhow::{Context, Result, anyhow};
use rayflock::render::RenderSettings;
use rayflock::scene::Evaluator;
use rayflock_bench::scene::{self, SceneBench};
use rayflock_bench::table;

use super::write_json;
use crate::args::BenchSceneArguments;
use crate::failure::{Blame, Failure};
use crate::frames::FrameRange;
use crate::input::Input;
use crate::output::atomic;
use crate::plan::{self, PlannedCamera};
use crate::progress::Progress;
use crate::terminal;

/// Frames measured when none are asked for.
const DEFAULT_FRAME_COUNT: u64 = 5;

/// Measures what the user asked for.
pub(super) fn run(args: &BenchSceneArguments) -> Result<(), Failure> {
    let input = Input::open(&args.input).blame_input()?;
    let mut evaluator = Evaluator::new(input.scene.clone(), None).blame_input()?;
    let camera = PlannedCamera::new(&evaluator, None, args.size).blame_input()?;
    let bench = define(args, &input, &evaluator).blame_input()?;
    for warning in &input.warnings {
        terminal::say(format_args!("warning: {warning}"));
    }
    args.json.as_deref().map(atomic::check_writable).transpose().blame_output()?;

    let round_count = 1 + (bench.frames.len() * bench.run_count) as u64;
    let progress = Progress::new(&input.name, round_count, 0);
    let view = |frame: &_| camera.view(&input.scene, frame);
    let measured = scene::measure(&bench, &mut evaluator, &view, &mut || progress.advance());
    progress.finish();
    let record = measured.with_context(|| input.name.clone()).blame_input()?;

    if let Some(path) = &args.json {
        write_json(path, &record).blame_output()?;
    }
    terminal::answer(&table::format(&record)).blame_output()?;
    if record.same_films() {
        return Ok(());
    }
    Err(anyhow!("{}: the engines' films differ, but must be the same in every bit", input.name))
        .blame_output()
}

fn define(args: &BenchSceneArguments, input: &Input, evaluator: &Evaluator) -> Result<SceneBench> {
    let frame_rate = input.scene.default_frame_rate();
    let whole = FrameRange::first_frames(input.whole_motion(evaluator.clip(), frame_rate));
    let frames = match args.frames {
        Some(asked) => {
            plan::check_frames(asked, whole, input)?;
            asked.iter().collect()
        }
        None => whole.spread(DEFAULT_FRAME_COUNT),
    };
    Ok(SceneBench {
        name: input.name.clone(),
        engines: args.engines.clone(),
        frames,
        frame_rate,
        size: [args.size.width as usize, args.size.height as usize],
        run_count: usize::from(args.runs),
        settings: RenderSettings::default(),
    })
}
