//! Options of `convert`.

use std::path::PathBuf;

use clap::Args;

use super::{InputArguments, MotionArguments};
use crate::frames::FrameRange;

const EXAMPLES: &str = "\
What is written:
  The triangles and spheres of each frame, in world space and single precision, +Y up: no
  materials, no normals. .npz is one file for all frames, in the arrays that docs/formats.md tells;
  .glb is one too, a mesh with a morph target a frame, if all have the same triangles; .ply and
  .obj are a file a frame. A .ply has spheres where it has no triangles, an .obj has none.

Examples:
  rayflock convert fox.glb -o fox.npz                      one loop, to be read by NumPy
  rayflock convert fox.glb --clip Run --fps 60 -o run/     run/frame_0000.ply ...
  rayflock convert scan/ --frames 10..19 -o 'out/%03d.obj' some frames of a sequence
  rayflock convert cloth.pc2 -o cloth.ply                  frame 0, at exactly this path

Exit codes: 0 done; 1 the output failed; 2 arguments or input are wrong; 130 stopped by Ctrl-C.";

/// Options of `convert`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct ConvertArguments {
    /// Where the scene comes from.
    #[command(flatten)]
    pub(crate) input: InputArguments,

    /// Where the result goes: a frame set (.npz), morphs (.glb), a mesh (.ply .obj), a folder of
    /// .ply meshes, or a pattern such as out/frame_%04d.obj.
    ///
    /// A mesh path with one frame is exactly that path; with several frames the frame number is
    /// put before the extension. The last folder of a folder or pattern is created when it is
    /// missing. Files that exist are replaced.
    #[arg(short, long, value_name = "PATH")]
    pub(crate) output: PathBuf,

    /// Frames to write, both ends included, counted from 0: `A..B`, or `A` for one.
    ///
    /// Without it, frame sets, morphs, folders and patterns get the whole motion once; a single
    /// mesh gets frame 0.
    #[arg(long, value_name = "A..B")]
    pub(crate) frames: Option<FrameRange>,

    /// How the scene moves.
    #[command(flatten)]
    pub(crate) motion: MotionArguments,
}
