//! The moving scene that a benchmark plays, and from where it is seen.

use anyhow::Result;
use rayflock::render::View;
use rayflock::scene::{Evaluator, SceneFrame};

use crate::args::InputArguments;
use crate::frames::FrameRange;
use crate::input::Input;
use crate::plan::{self, PlannedCamera};
use crate::size::Size;
use crate::terminal;

/// An input with everything that does not depend on what is measured.
#[derive(Debug)]
pub(super) struct MovingInput {
    /// What the record calls it.
    pub(super) name: String,
    /// The frames to measure, counted from 0.
    pub(super) frames: Vec<u32>,
    /// Frames a second.
    pub(super) frame_rate: f64,
    /// Plays the first clip.
    pub(super) evaluator: Evaluator,
    camera: PlannedCamera,
}

impl MovingInput {
    /// Opens the input and tells the user what is odd about it. Where no `frames` are asked for, so
    /// many are spread over the whole motion.
    pub(super) fn open(
        args: &InputArguments,
        size: Size,
        (frames, default_count): (Option<FrameRange>, u64),
    ) -> Result<Self> {
        let input = Input::open(args)?;
        let evaluator = Evaluator::new(input.scene.clone(), None)?;
        let camera = PlannedCamera::new(&evaluator, None, size)?;
        let frame_rate = input.scene.default_frame_rate();
        let whole = FrameRange::first_frames(input.whole_motion(evaluator.clip(), frame_rate));
        let frames = match frames {
            Some(asked) => {
                plan::check_frames(asked, whole, &input)?;
                asked.iter().collect()
            }
            None => whole.spread(default_count),
        };
        for warning in &input.warnings {
            terminal::say(format_args!("warning: {warning}"));
        }
        Ok(Self { name: input.name, frames, frame_rate, evaluator, camera })
    }

    /// Plays the scene, and tells where each of its frames is seen from.
    pub(super) fn play(&mut self) -> (&mut Evaluator, impl Fn(&SceneFrame) -> View + use<>) {
        let (camera, scene) = (self.camera, std::sync::Arc::clone(self.evaluator.scene()));
        let view = move |frame: &SceneFrame| camera.view(&scene, frame);
        (&mut self.evaluator, view)
    }
}
