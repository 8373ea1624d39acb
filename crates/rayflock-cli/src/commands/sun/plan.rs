//! From arguments to a sun study that can only fail for reasons of its own.

use anyhow::{Context, Result, bail, ensure};
use glam::Affine3A;
use rayflock::import::UpAxis;
use rayflock::render::sun::{Bearings, Days, Place, Sampling, Sides, SunStep};
use rayflock::scene::Evaluator;

use super::output::OutputFile;
use super::picture::PlannedPicture;
use crate::args::{InputArguments, Per, SidesArgument, SunArguments};
use crate::failure::{Blame, Failure};
use crate::false_color::color_bar;
use crate::frames::FrameRange;
use crate::input::Input;
use crate::output::atomic;
use crate::plan::{PlannedCamera, check_frames};
use crate::size::Size;

/// Days that are looked at without `--every`.
const DEFAULT_DAY_COUNT: u32 = 31;
const SECONDS_PER_HOUR: f64 = 3600.0;

/// A sun study, thought through.
#[derive(Debug)]
pub(super) struct SunPlan {
    /// Where the scene came from.
    pub(super) input: Input,
    /// Plays the chosen clip.
    pub(super) evaluator: Evaluator,
    /// Which frames are shared out over each day.
    pub(super) frames: FrameRange,
    /// Frames a second.
    pub(super) fps: f64,
    /// Which days and hours.
    pub(super) days: Days,
    /// The steps in which the sun is up, in the order of time.
    pub(super) steps: Vec<SunStep>,
    /// Where hours are told.
    pub(super) sampling: Sampling,
    /// Which sides count.
    pub(super) sides: Sides,
    /// Whether hours are told a day.
    pub(super) is_average: bool,
    /// Where the hours go.
    pub(super) outputs: Vec<OutputFile>,
    /// The picture, if one is wanted.
    pub(super) picture: Option<PlannedPicture>,
}

impl SunPlan {
    /// Finds everything the user got wrong.
    pub(super) fn new(args: &SunArguments) -> Result<Self, Failure> {
        let outputs = args.output.iter().map(|path| OutputFile::new(path));
        let outputs = outputs.collect::<Result<_>>().blame_input()?;
        let days = days(args);
        let steps = sunlit_steps(args, &days).blame_input()?;

        // The file is taken as it lies, so that hours are told in its own axes.
        let (name, up) = (args.name.clone(), UpAxis::Y);
        let input = InputArguments { name, up, detail: None, interpolate: false };
        let (input, evaluator, fps) = Input::open_moving(&input, &args.motion).blame_input()?;
        let frames = frames(args, &input, &evaluator, fps).blame_input()?;
        let picture = picture(args, &evaluator).blame_input()?;

        Ok(Self {
            evaluator,
            frames,
            fps,
            days,
            steps,
            sampling: match args.per {
                Per::Face => Sampling::Faces,
                Per::Vertex => Sampling::Vertices,
            },
            sides: match args.sides {
                SidesArgument::Both => Sides::Both,
                SidesArgument::Front => Sides::Front,
            },
            is_average: args.average,
            outputs,
            picture,
            input,
        })
    }

    /// Finds out whether everything can be written.
    pub(super) fn check_output(&self) -> Result<()> {
        let picture = self.picture.iter().map(|picture| picture.path.as_path());
        let outputs = self.outputs.iter().map(OutputFile::path);
        outputs.chain(picture).try_for_each(atomic::check_writable)
    }

    /// The time of a frame, in seconds.
    pub(super) fn time(&self, frame: u32) -> f64 {
        f64::from(frame) / self.fps
    }

    /// Which frame is shown during a step.
    pub(super) fn frame_at(&self, step: &SunStep) -> u32 {
        self.frames.at_part(step.step_idx, self.days.steps_per_day())
    }

    /// Hours to tell for one second of sun.
    pub(super) fn hours_per_second(&self) -> f64 {
        let days = if self.is_average { self.days.day_count() } else { 1 };
        1.0 / (SECONDS_PER_HOUR * f64::from(days))
    }
}

fn days(args: &SunArguments) -> Days {
    let mut days = Days {
        first: args.date,
        last: args.until.unwrap_or(args.date),
        every: 1,
        from_minute: args.from,
        to_minute: args.to,
        step_minutes: u32::from(args.step),
        utc_offset: args.utc_offset,
    };
    let fewest = days.day_count().div_ceil(DEFAULT_DAY_COUNT).max(1);
    days.every = args.every.unwrap_or(u16::try_from(fewest).unwrap_or(u16::MAX));
    days
}

fn sunlit_steps(args: &SunArguments, days: &Days) -> Result<Vec<SunStep>> {
    let (first, last) = (days.first, days.last);
    ensure!(first <= last, "--until {last} lies before --date {first}, expected a later day");
    ensure!(
        args.from < args.to,
        "--to {} is no later than --from {}, expected a later time of the day",
        clock(args.to),
        clock(args.from)
    );
    let place = Place::from_degrees(args.latitude, args.longitude)?;
    let bearings = Bearings::new(args.up, args.north.to_radians());
    Ok(days.sunlit_steps(&place, &bearings)?)
}

/// A minute of the day as a clock shows it.
pub(super) fn clock(minute: u32) -> String {
    format!("{:02}:{:02}", minute / 60, minute % 60)
}

/// The frames asked for; by default the first alone.
fn frames(
    args: &SunArguments,
    input: &Input,
    evaluator: &Evaluator,
    fps: f64,
) -> Result<FrameRange> {
    let whole = FrameRange::first_frames(input.whole_motion(evaluator.clip(), fps));
    let frames = args.frames.unwrap_or(FrameRange::first_frames(1));
    check_frames(frames, whole, input)?;
    Ok(frames)
}

fn picture(args: &SunArguments, evaluator: &Evaluator) -> Result<Option<PlannedPicture>> {
    let Some(path) = &args.picture else { return Ok(None) };
    if path.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("png")) {
        bail!("cannot draw \"{}\": expected a .png file", path.display());
    }
    let Size { width, height } = args.size;
    let [least_width, least_height] = [2 * color_bar::WIDTH, color_bar::LEAST_HEIGHT];
    ensure!(
        width >= least_width && height >= least_height,
        "--size {} has no room for the colour bar, expected {least_width}x{least_height} at least",
        args.size
    );
    let scene_size = Size { width: width - color_bar::WIDTH, height };
    let turn: Affine3A = args.up.from_y_up();
    let name = args.camera.as_deref();
    let camera = PlannedCamera::upright(evaluator, name, scene_size, &turn)
        .with_context(|| format!("the picture {}", path.display()))?;
    Ok(Some(PlannedPicture { path: path.clone(), scene_size, camera }))
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;
    use crate::args::{Arguments, Command};

    /// The days of a command line after the place.
    fn days_of(options: &str) -> Days {
        let words = "rayflock sun x.obj --latitude 0 --longitude 0".split(' ');
        let arguments = Arguments::try_parse_from(words.chain(options.split(' '))).unwrap();
        let Command::Sun(args) = arguments.command else { panic!("{options}") };
        days(&args)
    }

    #[test]
    fn long_times_are_looked_at_on_31_days_at_most() {
        for (until, every) in [
            ("2024-01-01", 1),
            ("2024-01-31", 1),
            ("2024-02-01", 2),
            ("2024-12-31", 12),
            ("2034-01-01", 118),
        ] {
            let days = days_of(&format!("--date 2024-01-01 --until {until}"));
            assert_eq!(days.every, every, "{until}");
            assert!(days.sampled_day_count() <= 31);
        }
        assert_eq!(days_of("--date 2024-01-01 --until 2024-12-31 --every 5").every, 5);
    }
}
