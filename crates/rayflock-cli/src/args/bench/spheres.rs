//! Options of `bench spheres`.

use clap::Args;

use super::{EngineArguments, OutputArguments};
use crate::args::{InputArguments, TraceArguments};
use crate::frames::FrameRange;
use crate::size::Size;

const EXAMPLES: &str = "\
How it is measured:
  The same virtual lights are gathered at the same points by each engine, with a shadow ray for each
  pair, past each number of spheres, and with a shadow ray for so many neighbours; all take turns,
  frame by frame and run by run. A frame's times are medians over the runs, means over the frames.
  Fit is to bring spheres to where the geometry is, coming from the frame before; gather is
  visibility and shading; everything else is the same for all and left out. Pictures are compared
  with those of the first engine: mean FLIP from 0 to 1 (below 0.05 is hard to see), and relative
  root mean squared error.

Examples:
  rayflock bench spheres builtin:cornell
  rayflock bench spheres builtin:crowd --spheres 128,512,2048 --html crowd.html
  rayflock bench spheres builtin:crowd --lookouts 16,32,64
  rayflock bench spheres fox.glb --engines auto --vpls 256 --size 160x120

Exit codes: 0 done; 1 the output failed; 2 arguments or input are wrong.";

/// Options of `bench spheres`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct BenchSpheresArguments {
    /// Where the scene comes from.
    #[command(flatten)]
    pub(crate) input: InputArguments,

    /// Numbers of spheres, separated by commas.
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',', default_value = "64,128,256,512,1024",
          value_parser = clap::value_parser!(u32).range(1..=1_048_576))]
    pub(crate) spheres: Vec<u32>,

    /// How many neighbours share a shadow ray, numbers separated by commas: 1, 4, 16, 32, 64
    /// [default: none is measured].
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',',
          value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(crate) lookouts: Vec<u32>,

    /// About how many virtual lights there are.
    #[arg(long, value_name = "N", default_value_t = 512,
          value_parser = clap::value_parser!(u32).range(1..=1_048_576))]
    pub(crate) vpls: u32,

    /// Frames to measure, both ends included, counted from 0: `A..B`, or `A` for one [default:
    /// three spread over the whole motion].
    #[arg(long, value_name = "A..B")]
    pub(crate) frames: Option<FrameRange>,

    /// Size of the picture in pixels.
    #[arg(long, value_name = "WxH", default_value = "320x240")]
    pub(crate) size: Size,

    /// How often a ray may be mirrored or refracted.
    #[arg(long, value_name = "N", default_value_t = 3,
          value_parser = clap::value_parser!(u32).range(0..=32))]
    pub(crate) depth: u32,

    /// How often each frame is measured.
    #[arg(long, value_name = "N", default_value_t = 3,
          value_parser = clap::value_parser!(u16).range(1..=10_000))]
    pub(crate) runs: u16,

    /// Which engines see exactly.
    #[command(flatten)]
    pub(crate) engines: EngineArguments,

    /// Where the record goes.
    #[command(flatten)]
    pub(crate) output: OutputArguments,

    /// Where the profile goes.
    #[command(flatten)]
    pub(crate) trace: TraceArguments,
}
