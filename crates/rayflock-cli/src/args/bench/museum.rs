//! Options of `bench scene`.

use std::path::PathBuf;

use clap::Args;
use rayflock::engine::EngineKind;

use crate::args::{InputArguments, thread_count};
use crate::frames::FrameRange;
use crate::size::Size;

const SCENE_EXAMPLES: &str = "\
How it is measured:
  Engines take turns, frame by frame and run by run; the first frame is rendered once before, for
  warming up. A frame's times are medians over the runs, with quartiles; the last rows are means
  over the frames. Update is to make the geometry the engine's current frame, coming from the frame
  before; trace is what the engine does with all rays of the picture. Shading is not measured.
  Ratios are to the first engine. The films are compared bit by bit.

Examples:
  rayflock bench scene builtin:museum7 --size 800x600      brute against hierarchy, 5 frames
  rayflock bench scene fox.glb --frames 0..9 --runs 5 --json fox.json
  rayflock bench scene builtin:crowd --engines hierarchy   one engine: times and counts

Exit codes: 0 done; 1 the output failed, or films differ; 2 arguments or input are wrong.";

/// Options of `bench scene`.
#[derive(Debug, Args)]
#[command(after_help = SCENE_EXAMPLES)]
pub(crate) struct BenchSceneArguments {
    /// Where the scene comes from.
    #[command(flatten)]
    pub(crate) input: InputArguments,

    /// The engines, separated by commas; the first is what the others are compared with.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_value = "brute,hierarchy")]
    pub(crate) engines: Vec<EngineKind>,

    /// Frames to measure, both ends included, counted from 0: `A..B`, or `A` for one [default:
    /// five spread over the whole motion].
    #[arg(long, value_name = "A..B")]
    pub(crate) frames: Option<FrameRange>,

    /// Size of the picture in pixels.
    #[arg(long, value_name = "WxH", default_value = "640x360")]
    pub(crate) size: Size,

    /// How often each frame is measured.
    #[arg(long, value_name = "N", default_value_t = 3,
          value_parser = clap::value_parser!(u16).range(1..=10_000))]
    pub(crate) runs: u16,

    /// Threads to work with [default: one a core].
    #[arg(long, value_name = "N", value_parser = thread_count())]
    pub(crate) threads: Option<u16>,

    /// Write everything measured to a JSON file.
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,
}
