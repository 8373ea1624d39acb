//! Options of `bench museum`.

use clap::Args;
use rayflock::import::UpAxis;

use super::{EngineArguments, OutputArguments};
use crate::args::{InputArguments, TraceArguments};
use crate::frames::FrameRange;
use crate::size::Size;

const EXAMPLES: &str = "\
How it is measured:
  Engines take turns, frame by frame and run by run; the first frame is rendered once before, for
  warming up. A frame's times are medians over the runs, with quartiles; the last rows are means
  over the frames. Update is to make the geometry the engine's current frame, coming from the frame
  before; trace is what the engine does with all rays of the picture; shade is the rest of making
  the picture, which is the same work for every engine. Total is update and trace. Films are compared
  with that of our first engine: those of ours bit by bit, those of others may differ at edges.

Examples:
  rayflock bench museum                                    the first paper's museum
  rayflock bench museum fox.glb --frames 0..9 --runs 5 --json fox.json
  rayflock bench museum builtin:cornell --engines brute,hierarchy --size 64x48

Exit codes: 0 done; 1 the output failed, or films differ; 2 arguments or input are wrong.";

/// Options of `bench museum`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct BenchMuseumArguments {
    /// A file (.gltf .glb .obj .ply .stl .aff .nff, each also .gz) or builtin:NAME.
    #[arg(value_name = "INPUT", default_value = "builtin:museum7")]
    pub(crate) input: String,

    /// Which axis points up in .obj, .ply and .stl files, which do not say: y or z.
    #[arg(long, value_name = "AXIS", default_value_t = UpAxis::Y)]
    pub(crate) up: UpAxis,

    /// Frames to measure, both ends included, counted from 0: `A..B`, or `A` for one [default:
    /// twenty spread over the whole motion].
    #[arg(long, value_name = "A..B")]
    pub(crate) frames: Option<FrameRange>,

    /// Size of the picture in pixels.
    #[arg(long, value_name = "WxH", default_value = "800x600")]
    pub(crate) size: Size,

    /// How often a ray may be mirrored or refracted.
    #[arg(long, value_name = "N", default_value_t = 3,
          value_parser = clap::value_parser!(u32).range(0..=32))]
    pub(crate) depth: u32,

    /// How often each frame is measured.
    #[arg(long, value_name = "N", default_value_t = 3,
          value_parser = clap::value_parser!(u16).range(1..=10_000))]
    pub(crate) runs: u16,

    /// Which engines.
    #[command(flatten)]
    pub(crate) engines: EngineArguments,

    /// Where the record goes.
    #[command(flatten)]
    pub(crate) output: OutputArguments,

    /// Where the profile goes.
    #[command(flatten)]
    pub(crate) trace: TraceArguments,
}

impl BenchMuseumArguments {
    /// Where the scene comes from.
    pub(crate) fn input(&self) -> InputArguments {
        let (name, up) = (self.input.clone(), self.up);
        InputArguments { name, up, detail: None, interpolate: false }
    }
}
