//! Options of `bench scene`.

use clap::Args;
use rayflock_bench::work::RayKind;

use super::{EngineArguments, OutputArguments};
use crate::args::{InputArguments, TraceArguments};
use crate::frames::FrameRange;
use crate::size::Size;

const EXAMPLES: &str = "\
What is measured:
  In each frame the engine takes in the geometry (commit), coming from the frame before, and traces
  the rays of one kind, as many as the picture has pixels. Engines take turns, run by run; times are
  medians over the runs and means over the frames. Answers are compared with Embree's watertight
  ones, where Embree is there, and rays that differ are judged by an independent oracle.

Kinds of rays:
  primary                from the camera
  pointshadow dirshadow  between what it sees and the first point light, or the sun
  mirror diffuse         from what it sees, mirrored, or by the cosine
  orthographic suns lidar ao    see `rayflock help bench map`

Examples:
  rayflock bench scene fox.glb
  rayflock bench scene builtin:museum7 --frames 100..119 --kind primary,pointshadow
  rayflock bench scene builtin:crowd --engines brute,hierarchy --size 320x240 --runs 5 --json c.json

Exit codes: 0 done; 1 the output failed; 2 arguments or input are wrong; 130 stopped by Ctrl-C.";

/// Options of `bench scene`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct BenchSceneArguments {
    /// Where the scene comes from.
    #[command(flatten)]
    pub(crate) input: InputArguments,

    /// Frames to measure, both ends included, counted from 0: `A..B`, or `A` for one [default:
    /// five spread over the whole motion].
    #[arg(long, value_name = "A..B")]
    pub(crate) frames: Option<FrameRange>,

    /// Kinds of rays, separated by commas.
    #[arg(
        long,
        value_name = "KINDS",
        value_delimiter = ',',
        default_value = "primary,pointshadow,dirshadow,mirror,diffuse"
    )]
    pub(crate) kind: Vec<RayKind>,

    /// Size of the picture in pixels, with a ray each.
    #[arg(long, value_name = "WxH", default_value = "640x360")]
    pub(crate) size: Size,

    /// How often each frame is measured.
    #[arg(long, value_name = "N", default_value_t = 5,
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
