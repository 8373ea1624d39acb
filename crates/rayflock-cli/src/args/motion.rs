//! The options `--fps` and `--clip`, for every command that shows a scene in motion.

use clap::Args;

use super::parse_fps;

/// How a scene moves.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct MotionArguments {
    /// Frames a second; sequences go by as fast [default: what the scene states, else 24].
    #[arg(long, value_name = "RATE", value_parser = parse_fps)]
    pub(crate) fps: Option<f64>,

    /// The clip, by name [default: the first].
    #[arg(long, value_name = "NAME")]
    pub(crate) clip: Option<String>,
}
