//! Options of `sense`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::{
    EngineChoice, InputArguments, MotionArguments, SensorOptions, TraceArguments, thread_count,
};
use crate::frames::FrameRange;
use crate::size::Size;

const EXAMPLES: &str = "\
Sensors:
  spinning:16 :32 :64 :128   rows of beams that turn around; 1024 columns, 10 Hz
  solid-state                a raster of 600 x 100 beams over 120 x 25 degrees, row by row, 10 Hz
  rosette                    24000 beams within 70 degrees, which two turning prisms bend, 10 Hz
  depth                      a pinhole camera of 640 x 480 pixels, all at once, 30 Hz
  ortho                      512 x 512 parallel beams, all at once, 10 Hz
  FILE.toml                  any of these and options, by their long names: sensor = \"depth\",
                             size = \"320x240\", noise = 0.01; poses along a path as [[pose]] with
                             time, at and look-at. What the command line says counts more.

Time:
  Sweep s begins at s / rate seconds. Each column of a spinning sensor, or row of others, looks at
  the scene at its own time; --time-steps makes it fewer times, which is faster.

Examples:
  rayflock sense builtin:crowd --at 2,1.4,0.6 -o scan.ply --picture ranges.png
  rayflock sense street.glb --sensor spinning:128 --at 0,2,0 --noise 0.02 --max-range 120 \\
      --drop-out-grazing 0.9 --returns first+last --sweeps 0..9 -o 'scan_%03d.pcd'
  rayflock sense character.glb --sensor depth --size 320x240 --shutter rolling -o depth.npz
  rayflock sense car.glb --sensor my-lidar.toml -o points.csv

Exit codes: 0 done; 1 the output failed; 2 arguments or input are wrong; 130 stopped by Ctrl-C.";

/// Options of `sense`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct SenseArguments {
    /// Where the scene comes from.
    #[command(flatten)]
    pub(crate) input: InputArguments,

    /// The sensor: a preset or a TOML file; see Sensors below.
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "spinning:64")]
    pub(crate) sensor: String,

    /// What it is besides.
    #[command(flatten)]
    pub(crate) options: SensorOptions,

    /// A camera of the scene, by name, on which the sensor is, looking where it looks [default: the
    /// scene's first, else one that frames the whole motion].
    #[arg(long, value_name = "NAME", help_heading = "Where the sensor is")]
    pub(crate) camera: Option<String>,

    /// Sweeps, both ends included, counted from 0: `A..B`, or `A` for one.
    #[arg(long, value_name = "A..B", default_value = "0")]
    pub(crate) sweeps: FrameRange,

    /// How the scene moves.
    #[command(flatten)]
    pub(crate) motion: MotionArguments,

    /// What traces the beams.
    #[command(flatten)]
    pub(crate) engine: EngineChoice,

    /// Threads to work with; they never change a point [default: one a core].
    #[arg(long, value_name = "N", value_parser = thread_count())]
    pub(crate) threads: Option<u16>,

    /// Where the points go, by extension: .ply, .pcd, .npz or .csv. May be given several times.
    ///
    /// With one sweep it is exactly that path; with several, the number of the sweep is put before
    /// the extension, or where a pattern such as scan_%03d.ply says.
    #[arg(short, long, value_name = "PATH")]
    pub(crate) output: Vec<PathBuf>,

    /// Draw what the sensor sees in false colours, with a colour bar, to a .png file.
    #[arg(long, value_name = "FILE.png")]
    pub(crate) picture: Option<PathBuf>,

    /// What the picture shows.
    #[arg(long, value_name = "WHAT", default_value = "range")]
    pub(crate) show: Shown,

    /// Size of the picture in pixels, colour bar included [default: some pixels a beam].
    #[arg(long, value_name = "WxH")]
    pub(crate) picture_size: Option<Size>,

    /// Where the profile goes.
    #[command(flatten)]
    pub(crate) trace: TraceArguments,
}

/// What a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Shown {
    /// Distance along the beam.
    Range,
    /// Distance along the axis in which the sensor looks.
    Depth,
    /// How much light came back.
    Intensity,
}
