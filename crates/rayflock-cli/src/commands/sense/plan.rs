//! From arguments to sweeps that can only fail for reasons of their own.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use glam::Vec3;
use rayflock::render::sensor::{
    DropOut, Pattern, Pose, PoseKey, PosePath, RangeNoise, Sensor, SensorSettings, Surroundings,
};
use rayflock::scene::{Evaluator, Projection};

use super::output::OutputFile;
use super::pattern::pattern_options;
use super::picture::PlannedPicture;
use crate::args::{Numbers, PoseOptions, SenseArguments, SensorOptions};
use crate::failure::{Blame, Failure};
use crate::frames::FrameRange;
use crate::input::Input;
use crate::output::atomic;
use crate::plan::PlannedCamera;
use crate::size::Size;

/// Sweeps, thought through.
#[derive(Debug)]
pub(super) struct SensePlan {
    /// Where the scene came from.
    pub(super) input: Input,
    /// Plays the chosen clip.
    pub(super) evaluator: Evaluator,
    /// What sweeps.
    pub(super) sensor: Sensor,
    /// The sensor by its name or file, as given.
    pub(super) sensor_name: String,
    /// Which sweeps.
    pub(super) sweeps: FrameRange,
    /// Where the points go.
    pub(super) outputs: Vec<OutputFile>,
    /// The picture of each sweep, if any are wanted.
    pub(super) picture: Option<PlannedPicture>,
}

impl SensePlan {
    /// Finds everything the user got wrong.
    pub(super) fn new(args: &SenseArguments) -> Result<Self, Failure> {
        let sweeps = args.sweeps;
        let outputs = args.output.iter().map(|path| OutputFile::new(path, sweeps));
        let outputs = outputs.collect::<Result<_>>().blame_input()?;
        let (preset, options) = sensor_options(args).blame_input()?;

        let (input, evaluator, _) = Input::open_moving(&args.input, &args.motion).blame_input()?;
        let sensor = sensor(args, &preset, &options, &evaluator).blame_input()?;
        check_sweeps(args, &sensor.pattern, &input, &evaluator).blame_input()?;
        let picture = picture(args, &sensor.pattern).blame_input()?;
        let sensor_name = args.sensor.clone();
        Ok(Self { input, evaluator, sensor, sensor_name, sweeps, outputs, picture })
    }

    /// Finds out whether everything can be written.
    pub(super) fn check_output(&self) -> Result<()> {
        let pictures = self.picture.iter().map(|picture| &picture.names);
        let names = self.outputs.iter().map(OutputFile::names).chain(pictures);
        names
            .into_iter()
            .try_for_each(|names| atomic::check_writable(&names.path(self.sweeps.first)))
    }

    /// When a sweep begins, in seconds.
    pub(super) fn start(&self, sweep: u32) -> f64 {
        start(sweep, &self.sensor.pattern)
    }
}

fn start(sweep: u32, pattern: &Pattern) -> f64 {
    f64::from(sweep) / pattern.rate()
}

/// The name of the preset, and the options of the command line and of the file that it names.
fn sensor_options(args: &SenseArguments) -> Result<(String, SensorOptions)> {
    let (path, mut options) = (Path::new(&args.sensor), args.options.clone());
    if path.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("toml")) {
        return Ok((args.sensor.clone(), options));
    }
    let text = fs::read_to_string(path).with_context(|| format!("cannot read {}", args.sensor))?;
    let file: SensorOptions =
        toml::from_str(&text).with_context(|| format!("cannot read {}", args.sensor))?;
    let Some(preset) = file.sensor.clone() else {
        let presets = Pattern::preset_names().join(", ");
        bail!("{}: found no key sensor, expected one of {presets}", args.sensor)
    };
    ensure!(
        file.at.is_none() || file.pose.is_empty(),
        "{}: found at and [[pose]], expected one of them",
        args.sensor
    );
    options = options.or(file);
    Ok((preset, options))
}

fn sensor(
    args: &SenseArguments,
    preset: &str,
    options: &SensorOptions,
    evaluator: &Evaluator,
) -> Result<Sensor> {
    let path = path(args, options, evaluator)?;
    let camera = match path {
        PosePath::Camera(idx) => evaluator.scene().cameras.get(idx).map(|camera| camera.projection),
        PosePath::Fixed(_) | PosePath::Keyed(_) => None,
    };
    let beams = pattern_options(options);
    let surroundings = Surroundings {
        vertical_fov: match camera {
            Some(Projection::Perspective { vertical_fov }) => Some(vertical_fov),
            Some(Projection::Orthographic { .. }) | None => None,
        },
        diagonal: match beams.wants_diagonal(preset) {
            true => evaluator.bounds_over_clip()?.size().length(),
            false => 0.0,
        },
    };
    let pattern = beams.pattern(preset, &surroundings)?;
    Ok(Sensor { pattern, path, settings: settings(options) })
}

/// Where the sensor is.
fn path(args: &SenseArguments, options: &SensorOptions, evaluator: &Evaluator) -> Result<PosePath> {
    let is_on_camera = args.camera.is_some();
    if let Some(at) = options.at.filter(|_| !is_on_camera) {
        return Ok(PosePath::Fixed(pose(at, options.look_at)));
    }
    if !options.pose.is_empty() && !is_on_camera {
        let key = |key: &PoseOptions| PoseKey { time: key.time, pose: pose(key.at, key.look_at) };
        return Ok(PosePath::Keyed(options.pose.iter().map(key).collect()));
    }
    ensure!(
        options.look_at.is_none() || is_on_camera,
        "--look-at says where a sensor looks that --at places, but there is no --at"
    );
    // Any aspect will do: a sensor need not see everything.
    let aspect = Size { width: 1, height: 1 };
    Ok(match PlannedCamera::new(evaluator, args.camera.as_deref(), aspect)? {
        PlannedCamera::InScene(idx) => PosePath::Camera(idx),
        PlannedCamera::Framing(view) => {
            PosePath::Fixed(Pose::from_transform(&view.world_from_camera))
        }
    })
}

fn pose(Numbers(at): Numbers<3>, look_at: Option<Numbers<3>>) -> Pose {
    let point = |numbers: [f64; 3]| Vec3::from(numbers.map(|number| number as f32));
    match look_at {
        Some(Numbers(target)) => Pose::looking_at(point(at), point(target)),
        None => Pose::at(point(at)),
    }
}

fn settings(options: &SensorOptions) -> SensorSettings {
    let default = SensorSettings::default();
    SensorSettings {
        min_range: options.min_range.unwrap_or(default.min_range),
        max_range: options.max_range.unwrap_or(default.max_range),
        noise: RangeNoise {
            constant: options.noise.unwrap_or(default.noise.constant),
            proportional: options.noise_per_range.unwrap_or(default.noise.proportional),
        },
        drop_out: DropOut {
            constant: options.drop_out.unwrap_or(default.drop_out.constant),
            grazing: options.drop_out_grazing.unwrap_or(default.drop_out.grazing),
            far: options.drop_out_far.unwrap_or(default.drop_out.far),
        },
        min_intensity: options.min_intensity.unwrap_or(default.min_intensity),
        returns: options.returns.unwrap_or(default.returns),
        dust: options.dust.unwrap_or(default.dust),
        panes: options.panes.unwrap_or(default.panes),
        seed: options.seed.unwrap_or(default.seed),
        time_steps: options.time_steps,
    }
}

/// Only finite sources have a last moment: everything else repeats or stays.
fn check_sweeps(
    args: &SenseArguments,
    pattern: &Pattern,
    input: &Input,
    evaluator: &Evaluator,
) -> Result<()> {
    let (_, end) = evaluator.time_range();
    let begins = start(args.sweeps.last, pattern);
    ensure!(
        input.scene.frame_count.is_none() || begins <= end,
        "{}: --sweeps asks for {}, of which the last begins at {begins} s, but the scene ends at \
         {end} s",
        input.name,
        args.sweeps
    );
    Ok(())
}

fn picture(args: &SenseArguments, pattern: &Pattern) -> Result<Option<PlannedPicture>> {
    let planned = |path: &PathBuf| {
        PlannedPicture::new(path, args.sweeps, args.show, args.picture_size, pattern)
    };
    args.picture.as_ref().map(planned).transpose()
}
