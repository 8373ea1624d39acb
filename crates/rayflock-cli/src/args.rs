//! What stands on the command line, as text and numbers that are well formed one by one.
//!
//! Nothing here looks at a file or at another argument: [`RenderPlan`](crate::plan::RenderPlan)
//! does.

#[cfg(feature = "bench")]
mod bench;
mod convert;
mod device;
mod engine;
mod light;
mod motion;
mod numbers;
mod sense;
mod sensor_options;
mod sun;
mod trace;

use std::path::PathBuf;

use clap::{ArgGroup, Args, Parser, Subcommand, ValueEnum};
use rayflock::import::UpAxis;
use rayflock::render::tonemap::ToneMap;

use crate::frames::FrameRange;
use crate::size::Size;

#[cfg(feature = "bench")]
pub(crate) use bench::{
    BenchArguments, BenchCommand, BenchCompareArguments, BenchMapArguments, BenchMuseumArguments,
    BenchReportArguments, BenchScalingArguments, BenchSceneArguments, BenchSpheresArguments,
    EngineArguments, OutputArguments,
};
pub(crate) use convert::ConvertArguments;
pub(crate) use device::Device;
pub(crate) use engine::{EngineChoice, EngineSpec};
pub(crate) use light::{
    ChoiceArgument, IndirectArgument, Integrator, LightArguments, VisibilityArgument,
};
pub(crate) use motion::MotionArguments;
pub(crate) use numbers::{Elevations, Field, Measures, Numbers};
pub(crate) use sense::{SenseArguments, Shown};
pub(crate) use sensor_options::{PoseOptions, SensorOptions};
pub(crate) use sun::{Per, SidesArgument, SunArguments};
pub(crate) use trace::TraceArguments;

const EXAMPLES: &str = "\
Examples:
  rayflock demo                                        a moving picture, nothing to download
  rayflock info fox.glb                                what is in a file, and what moves how
  rayflock render fox.glb -o fox.gif                   one loop of its first clip
  rayflock render fox.glb --clip Run --fps 30 -o run.mp4
  rayflock render builtin:museum5 --frames 0..59 --size 800x600 -o museum/
  rayflock render builtin:cornell --spp 16 -o cornell.png
  rayflock sun house.glb --latitude 52.5 --longitude 13.4 --date 2024-06-21 --picture sun.png
  rayflock sense builtin:crowd --at 2,1.4,0.6 -o scan.ply    a LiDAR among people who walk
  rayflock render scan/ --frames 0..9 -o scan.gif          a folder of meshes, one a frame
  rayflock convert fox.glb -o fox.npz                  triangles of each frame for NumPy

`rayflock help render` tells all about pictures, films and frames.";

const RENDER_EXAMPLES: &str = "\
Frames:
  Frame f shows the time f / fps. A clip is one loop long and then repeats; an .aff file has the
  frames of its `a` line and no more. Without --frames, a film, a folder or a pattern gets the
  whole motion once, and a single picture gets frame 0.

Examples:
  rayflock render fox.glb -o fox.gif                       a film of the first clip
  rayflock render fox.glb -o fox.png                       frame 0, at exactly this path
  rayflock render fox.glb --frames 0..9 -o fox.png         fox_0000.png ... fox_0009.png
  rayflock render fox.glb -o out/                          out/frame_0000.png ...
  rayflock render fox.glb -o 'out/%03d.exr'                out/000.exr ..., linear, 32 bits
  rayflock render fox.glb -o out/ --resume                 goes on where it was stopped
  rayflock render builtin:museum7 --stats s.json --plot s.svg -o museum.mp4
  rayflock render builtin:museum7 --frames 0..9 --trace t.json -o out/   what takes the time
  rayflock render builtin:cornell --indirect vpl --vpls 400 -o cornell.png   light that colours
  rayflock render builtin:cornell --integrator path --spp 256 -o paths.png   all light, slowly

Exit codes: 0 done; 1 the output failed; 2 arguments or input are wrong; 130 stopped by Ctrl-C.";

/// Ray tracing for scenes that never hold still: triangles that all move, appear or vanish every
/// frame are traced with no structure built over them.
#[derive(Debug, Parser)]
#[command(name = "rayflock", version, after_help = EXAMPLES, max_term_width = 100)]
pub(crate) struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render a built-in scene to an animated GIF in the working folder.
    Demo(DemoArguments),
    /// Render an animated scene to pictures or a film.
    Render(Box<RenderArguments>),
    /// Write the triangles and points of each frame: .npz, or .ply and .obj sequences.
    Convert(ConvertArguments),
    /// Tell what is in a scene, what moves how, and what is wrong with it; or which graphics
    /// adapters there are.
    Info(InfoArguments),
    /// Tell how many hours the sun shines on each face or vertex of a scene.
    Sun(Box<SunArguments>),
    /// Sweep a scene with a LiDAR or a depth camera while it moves: points, ranges, intensities.
    Sense(Box<SenseArguments>),
    /// Measure engines side by side.
    #[cfg(feature = "bench")]
    Bench(Box<BenchArguments>),
}

/// Options of `demo`.
#[derive(Debug, Args)]
pub(crate) struct DemoArguments {
    /// Where the film goes.
    #[arg(short, long, value_name = "PATH", default_value = "rayflock-demo.gif")]
    pub(crate) output: PathBuf,

    /// What traces the rays.
    #[command(flatten)]
    pub(crate) engine: EngineChoice,

    /// Threads to work with [default: one a core].
    #[arg(long, value_name = "N", value_parser = thread_count())]
    pub(crate) threads: Option<u16>,
}

/// Where a scene comes from.
#[derive(Clone, Debug, Args)]
pub(crate) struct InputArguments {
    /// A file (.gltf .glb .obj .ply .stl .vtk .vtp .npz .aff .nff, each also .gz; .pc2 .mdd), a
    /// sequence, or builtin:NAME.
    ///
    /// A sequence is a mesh file a frame: a folder, a quoted pattern such as 'scan/*.ply.gz', or
    /// the first of files whose names differ in their last number, such as mesh_0001.obj.
    #[arg(value_name = "INPUT")]
    pub(crate) name: String,

    /// Which axis points up in files that do not say, which are all but .gltf and .glb: y, or z as
    /// in most CAD and robotics data.
    #[arg(long, value_name = "AXIS", default_value_t = UpAxis::Y)]
    pub(crate) up: UpAxis,

    /// Level of detail up to which an .aff file includes others [default: what the file states, or
    /// all].
    #[arg(long, value_name = "LEVEL")]
    pub(crate) detail: Option<u32>,

    /// Move vertices straight from frame to frame of a sequence, point cache or frame set where
    /// two frames have the same triangles; its frames are then 24 a second, or as many as it
    /// states, whatever --fps. Without it, its frames are shown one each.
    #[arg(long)]
    pub(crate) interpolate: bool,
}

/// Options of `info`.
#[derive(Debug, Args)]
#[command(group(ArgGroup::new("about").required(true).args(["name", "devices"])))]
pub(crate) struct InfoArguments {
    /// Where the scene comes from.
    #[command(flatten)]
    pub(crate) input: Option<InputArguments>,

    /// List the graphics adapters of this machine, for --engine gpu:compute@NUMBER and --device
    /// gpu:NUMBER, in place of a scene.
    #[arg(long)]
    pub(crate) devices: bool,

    /// The clip to tell about, by name [default: the first].
    #[arg(long, value_name = "NAME")]
    pub(crate) clip: Option<String>,

    /// Print one JSON object instead of text; of adapters, an array.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `render`.
#[derive(Debug, Args)]
#[command(after_help = RENDER_EXAMPLES)]
pub(crate) struct RenderArguments {
    /// Where the scene comes from.
    #[command(flatten)]
    pub(crate) input: InputArguments,

    /// Where the result goes: a picture (.png .exr), a film (.gif .webp .mp4), a folder, or a
    /// pattern such as out/frame_%04d.png.
    ///
    /// A picture path with one frame is exactly that path; with several frames the frame number
    /// is put before the extension. The last folder of a folder or pattern is created when it is
    /// missing. Files that exist are replaced. PNG and films are tone-mapped sRGB; EXR is linear.
    /// MP4 needs the program ffmpeg.
    #[arg(short, long, value_name = "PATH")]
    pub(crate) output: PathBuf,

    /// Frames to render, both ends included, counted from 0: `A..B`, or `A` for one.
    ///
    /// Without it, films, folders and patterns get the whole motion once; a single picture gets
    /// frame 0.
    #[arg(long, value_name = "A..B")]
    pub(crate) frames: Option<FrameRange>,

    /// How the scene moves.
    #[command(flatten)]
    pub(crate) motion: MotionArguments,

    /// Size of the picture in pixels.
    #[arg(long, value_name = "WxH", default_value = "640x360")]
    pub(crate) size: Size,

    /// Samples a pixel: more make edges smoother, take noise away, and cost as much more time
    /// [default: 1, and 64 for --integrator path].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub(crate) spp: Option<u32>,

    /// How often a ray may be mirrored or refracted, or turn at all for --integrator path
    /// [default: 5, and 32 for path].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=32))]
    pub(crate) depth: Option<u32>,

    /// How light is found.
    #[command(flatten)]
    pub(crate) light: LightArguments,

    /// The camera, by name [default: the scene's first, else one that frames the whole motion].
    #[arg(long, value_name = "NAME")]
    pub(crate) camera: Option<String>,

    /// What traces the rays.
    #[command(flatten)]
    pub(crate) engine: EngineChoice,

    /// What renders whole frames: cpu, or in a program built with --features gpu also gpu, which
    /// takes no engine, and gpu:NUMBER or gpu:NAME for one of the adapters that `rayflock info
    /// --devices` lists.
    ///
    /// Pictures of both look the same. What a graphics card cannot render yet, paths and virtual
    /// lights with exact visibility among it, the processor does, and the program says so.
    #[arg(long, value_name = "DEVICE", default_value_t = Device::Cpu)]
    pub(crate) device: Device,

    /// Threads to work with; they never change the picture [default: one a core].
    #[arg(long, value_name = "N", value_parser = thread_count())]
    pub(crate) threads: Option<u16>,

    /// Exposure in stops: 1 doubles the light, -1 halves it. EXR is written without it.
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_negative_numbers = true,
          value_parser = parse_exposure)]
    pub(crate) exposure: f32,

    /// How light is brought into the range of a screen: srgb clips what is brighter than white,
    /// agx fades bright colours to white as film does. EXR is written without it.
    #[arg(long, value_name = "NAME", default_value_t = ToneMap::Srgb)]
    pub(crate) tone_map: ToneMap,

    /// Bits a channel of PNG pictures.
    #[arg(long, value_name = "N", default_value = "8")]
    pub(crate) bits: PngDepth,

    /// Go on with a render that was stopped, from the frames it left.
    ///
    /// Frames are kept beside the output until a film is finished. They are taken over only when
    /// they were rendered from the same input with the same settings; --frames may differ.
    #[arg(long)]
    pub(crate) resume: bool,

    /// Write what each frame cost to a JSON file: times, rays, tests of each kind, candidate pairs,
    /// bytes, allocations on the heap.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) stats: Option<PathBuf>,

    /// Tell which engine answered each batch of rays, how long it took, and what it and the others
    /// were expected to take; with the engine subfields, tell how many directions and nested objects
    /// it holds.
    #[arg(long)]
    pub(crate) explain: bool,

    /// Draw update and render time of each frame to a .svg or .html file.
    #[arg(long, value_name = "FILE")]
    pub(crate) plot: Option<PathBuf>,

    /// Where the profile goes.
    #[command(flatten)]
    pub(crate) trace: TraceArguments,
}

/// Bits a channel of PNG pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PngDepth {
    /// For screens.
    #[value(name = "8")]
    Eight,
    /// For further work.
    #[value(name = "16")]
    Sixteen,
}

fn thread_count() -> clap::builder::RangedI64ValueParser<u16> {
    clap::value_parser!(u16).range(1..=1024)
}

fn parse_fps(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(fps) if (0.001..=1000.0).contains(&fps) => Ok(fps),
        _ => Err("expected a number from 0.001 to 1000, such as 24".to_owned()),
    }
}

fn parse_exposure(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(stops) if (-100.0..=100.0).contains(&stops) => Ok(stops),
        _ => Err("expected a number from -100 to 100, such as 0.5".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn rates_and_exposures_are_finite_and_sane() {
        assert_eq!(parse_fps("23.976"), Ok(23.976));
        for text in ["0", "-1", "nan", "inf", "1e9", ""] {
            assert!(parse_fps(text).is_err(), "{text}");
        }
        assert!(parse_exposure("nan").is_err());
    }
}
