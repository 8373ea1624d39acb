//! From arguments to a render that can only fail for reasons of its own.
//!
//! Everything the user can get wrong is found here, before the first ray: the input, names in it,
//! frames, formats. What the machine can get wrong (folders, ffmpeg) is found next, by
//! [`RenderPlan::prepare_output`].

use std::path::PathBuf;

use anyhow::{Result, ensure};
use glam::Affine3A;
use rayflock::render::{RenderSettings, View};
use rayflock::scene::{Evaluator, Scene, SceneFrame, frame_bounds};

use crate::args::{Device, EngineSpec, Integrator, RenderArguments};
use crate::failure::{Blame, Failure};
use crate::frames::FrameRange;
use crate::input::Input;
use crate::journal::Settings;
#[cfg(feature = "bench")]
use crate::light_plan::plan_comparison;
use crate::light_plan::{caustics_text, indirect_text, plan_caustics, plan_indirect};
use crate::output::{Look, Target, atomic};
use crate::plot::PlotFile;
use crate::size::Size;

/// A render, thought through.
#[derive(Debug)]
pub(crate) struct RenderPlan {
    /// Where the scene came from.
    pub(crate) input: Input,
    /// Plays the chosen clip.
    pub(crate) evaluator: Evaluator,
    /// Where the pictures are seen from.
    pub(crate) camera: PlannedCamera,
    /// Which frames.
    pub(crate) frames: FrameRange,
    /// Frames a second.
    pub(crate) fps: f64,
    /// The size of the pictures.
    pub(crate) size: Size,
    /// What pictures are made of.
    pub(crate) integrator: Integrator,
    /// How frames are rendered.
    pub(crate) settings: RenderSettings,
    /// What they are compared with, if their error is asked for.
    #[cfg(feature = "bench")]
    pub(crate) compared: Option<RenderSettings>,
    /// How light becomes colour.
    pub(crate) look: Look,
    /// What traces the rays.
    pub(crate) engine: EngineSpec,
    /// What renders whole frames.
    pub(crate) device: Device,
    /// Where the pictures go.
    pub(crate) target: Target,
    /// Whether to take over finished frames.
    pub(crate) resume: bool,
    /// Whether to tell which engines answered, and why.
    pub(crate) explain: bool,
    /// Where the statistics go.
    pub(crate) stats: Option<PathBuf>,
    /// Where the graph goes.
    pub(crate) plot: Option<PlotFile>,
}

/// Where pictures are seen from.
#[derive(Clone, Copy, Debug)]
pub(crate) enum PlannedCamera {
    /// A camera of the scene, which may move, by its position.
    InScene(usize),
    /// One that frames everything over the whole motion.
    Framing(View),
}

impl PlannedCamera {
    /// The camera of this name; without a name the first, or one that frames the whole motion
    /// where there is none.
    pub(crate) fn new(evaluator: &Evaluator, name: Option<&str>, size: Size) -> Result<Self> {
        Self::upright(evaluator, name, size, &Affine3A::IDENTITY)
    }

    /// The same in a scene that `world_from_upright` has turned from one whose +Y points up.
    pub(crate) fn upright(
        evaluator: &Evaluator,
        name: Option<&str>,
        size: Size,
        world_from_upright: &Affine3A,
    ) -> Result<Self> {
        if let Some(idx) = evaluator.scene().camera_idx(name)? {
            return Ok(Self::InScene(idx));
        }
        let bounds = evaluator.bounds_over_clip()?.transformed(&world_from_upright.inverse());
        let (upright_from_camera, projection) = frame_bounds(&bounds, size.aspect());
        Ok(Self::Framing(View::new(*world_from_upright * upright_from_camera, projection)))
    }

    /// Where a frame of `scene` is seen from.
    pub(crate) fn view(&self, scene: &Scene, frame: &SceneFrame) -> View {
        match *self {
            Self::InScene(idx) => View::new(frame.cameras[idx], scene.cameras[idx].projection),
            Self::Framing(view) => view,
        }
    }
}

impl RenderPlan {
    /// Finds everything the user got wrong.
    pub(crate) fn new(args: &RenderArguments) -> Result<Self, Failure> {
        let target = Target::from_path(&args.output, args.bits).blame_input()?;
        let plot = args.plot.as_deref().map(PlotFile::new).transpose().blame_input()?;
        check_edges(&target, args.size).blame_input()?;
        check_explained(args).blame_input()?;
        let indirect = plan_indirect(&args.light).blame_input()?;
        let caustics = plan_caustics(&args.light).blame_input()?;
        let integrator = args.light.integrator;
        let (depth, samples) = integrator.default_depth_and_samples();
        let settings = RenderSettings {
            samples_per_pixel: args.spp.unwrap_or(samples),
            depth: args.depth.unwrap_or(depth),
            indirect,
            caustics,
            shown: args.light.view,
            ..RenderSettings::default()
        };
        #[cfg(feature = "bench")]
        let compared = plan_comparison(&args.light, &settings).blame_input()?;

        let (input, evaluator, fps) =
            Input::open_moving(&args.input, &args.motion).blame_input()?;
        let camera =
            PlannedCamera::new(&evaluator, args.camera.as_deref(), args.size).blame_input()?;
        let frames = plan_frames(args.frames, &target, &input, &evaluator, fps).blame_input()?;

        Ok(Self {
            evaluator,
            camera,
            frames,
            fps,
            size: args.size,
            integrator,
            settings,
            #[cfg(feature = "bench")]
            compared,
            look: Look { exposure: args.exposure, tone_map: args.tone_map },
            engine: args.engine.engine,
            device: args.device,
            target,
            resume: args.resume,
            explain: args.explain,
            stats: args.stats.clone(),
            plot,
            input,
        })
    }

    /// Finds out whether everything can be written.
    pub(crate) fn prepare_output(&self) -> Result<()> {
        self.target.prepare(self.frames.count())?;
        let beside =
            self.stats.as_deref().into_iter().chain(self.plot.as_ref().map(PlotFile::path));
        beside.into_iter().try_for_each(atomic::check_writable)
    }

    /// The time of a frame, in seconds.
    pub(crate) fn time(&self, frame: u32) -> f64 {
        f64::from(frame) / self.fps
    }

    /// Where a frame is seen from.
    pub(crate) fn view(&self, frame: &SceneFrame) -> View {
        self.camera.view(&self.input.scene, frame)
    }

    /// What decides how a frame looks and what it costs, by the name of its option. Threads are
    /// left out: they change neither pictures nor counts.
    pub(crate) fn journal_settings(&self) -> Settings {
        let camera = match self.camera {
            PlannedCamera::InScene(idx) => format!("{idx}: {}", self.input.scene.cameras[idx].name),
            PlannedCamera::Framing(_) => "framing".to_owned(),
        };
        let clip = self.evaluator.clip().map_or_else(String::new, |clip| clip.name.clone());
        let pairs = [
            ("version", env!("CARGO_PKG_VERSION").to_owned()),
            ("INPUT", self.input.name.clone()),
            ("INPUT's content", self.input.revision.clone()),
            ("--engine", self.engine.to_string()),
            ("--device", self.device.to_string()),
            ("--fps", self.fps.to_string()),
            ("--size", self.size.to_string()),
            ("--spp", self.settings.samples_per_pixel.to_string()),
            ("--depth", self.settings.depth.to_string()),
            ("--integrator", self.integrator.name().to_owned()),
            ("--indirect", indirect_text(&self.settings.indirect)),
            ("--caustics", caustics_text(self.settings.caustics.as_ref())),
            ("--view", self.settings.shown.to_string()),
            ("--camera", camera),
            ("--clip", clip),
            ("--exposure", self.look.exposure.to_string()),
            ("--tone-map", self.look.tone_map.to_string()),
            ("format", self.target.frame_format().name().to_owned()),
        ];
        pairs.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

fn check_edges(target: &Target, size: Size) -> Result<()> {
    if let Target::Film(path, container) = target {
        let (longest, limit) = (size.width.max(size.height), container.max_edge());
        let path = path.display();
        ensure!(longest <= limit, "{path}: the size is {size}; the format ends at {limit} pixels");
    }
    Ok(())
}

fn check_explained(args: &RenderArguments) -> Result<()> {
    let engine = args.engine.engine;
    ensure!(
        engine.explains() || !args.explain,
        "--explain tells what the engine auto chose, or what subfields holds, but --engine is {engine}"
    );
    Ok(())
}

/// The frames asked for; by default frame 0 for a single picture and the whole motion otherwise.
fn plan_frames(
    asked: Option<FrameRange>,
    target: &Target,
    input: &Input,
    evaluator: &Evaluator,
    fps: f64,
) -> Result<FrameRange> {
    let whole = FrameRange::first_frames(input.whole_motion(evaluator.clip(), fps));
    let default = match target {
        Target::Picture(..) => FrameRange::first_frames(1),
        Target::Sequence(..) | Target::Film(..) => whole,
    };
    let frames = asked.unwrap_or(default);
    check_frames(frames, whole, input)?;
    Ok(frames)
}

/// Only finite sources have a last frame: everything else repeats or stays.
pub(crate) fn check_frames(asked: FrameRange, whole: FrameRange, input: &Input) -> Result<()> {
    ensure!(
        input.scene.frame_count.is_none() || asked.last <= whole.last,
        "{}: --frames asks for {asked}, but there are the frames {whole}",
        input.name
    );
    Ok(())
}
