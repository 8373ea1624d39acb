//! From the arguments of `convert` to files that are to be written.

use std::fmt;
use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use rayflock::scene::Evaluator;

use crate::args::ConvertArguments;
use crate::failure::{Blame, Failure};
use crate::frames::FrameRange;
use crate::input::Input;
use crate::output::{FrameNames, atomic, create_folder, folder_of};
use crate::plan::check_frames;

const EXPECTED: &str = "expected a frame set (.npz), morphs (.glb), a mesh (.ply, .obj), a folder (ending in /) \
                        or a pattern such as out/frame_%04d.ply";

/// A conversion, thought through.
#[derive(Debug)]
pub(crate) struct ConvertPlan {
    /// Where the scene came from.
    pub(crate) input: Input,
    /// Plays the chosen clip.
    pub(crate) evaluator: Evaluator,
    /// Which frames.
    pub(crate) frames: FrameRange,
    /// Frames a second.
    pub(crate) fps: f64,
    /// Where the geometry goes.
    pub(crate) target: MeshTarget,
}

/// Where geometry goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum MeshTarget {
    /// All frames in one file.
    FrameSet(PathBuf),
    /// All frames in one file, as morphs of the first.
    Morphs(PathBuf),
    /// One mesh, at exactly this path if there is one frame.
    Mesh(PathBuf, MeshFormat),
    /// A mesh a frame.
    Meshes(FrameNames, MeshFormat),
}

/// Formats of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MeshFormat {
    /// Binary PLY.
    Ply,
    /// OBJ.
    Obj,
}

impl ConvertPlan {
    /// Finds everything the user got wrong.
    pub(crate) fn new(args: &ConvertArguments) -> Result<Self, Failure> {
        let target = MeshTarget::from_path(&args.output).blame_input()?;
        let (input, evaluator, fps) =
            Input::open_moving(&args.input, &args.motion).blame_input()?;
        let whole = FrameRange::first_frames(input.whole_motion(evaluator.clip(), fps));
        let default = match target {
            MeshTarget::Mesh(..) => FrameRange::first_frames(1),
            MeshTarget::FrameSet(_) | MeshTarget::Morphs(_) | MeshTarget::Meshes(..) => whole,
        };
        let frames = args.frames.unwrap_or(default);
        check_frames(frames, whole, &input).blame_input()?;
        Ok(Self { input, evaluator, frames, fps, target })
    }

    /// The time of a frame, in seconds.
    pub(crate) fn time(&self, frame: u32) -> f64 {
        f64::from(frame) / self.fps
    }
}

impl MeshTarget {
    /// Understands `path` by its extension, its `%04d` or its final slash.
    fn from_path(path: &Path) -> Result<Self> {
        if path.to_string_lossy().ends_with(['/', std::path::MAIN_SEPARATOR]) || path.is_dir() {
            return Ok(Self::Meshes(FrameNames::in_folder(path, "ply"), MeshFormat::Ply));
        }
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let format = match extension.as_str() {
            "npz" => return Ok(Self::FrameSet(path.to_owned())),
            "glb" => return Ok(Self::Morphs(path.to_owned())),
            "ply" => MeshFormat::Ply,
            "obj" => MeshFormat::Obj,
            _ => bail!("cannot tell the format of the output \"{}\": {EXPECTED}", path.display()),
        };
        Ok(match FrameNames::from_pattern(path) {
            Some(names) => Self::Meshes(names, format),
            None => Self::Mesh(path.to_owned(), format),
        })
    }

    /// The paths of meshes, if `frame_count` of them are written, and their format; `None` for one
    /// file of all frames.
    pub(crate) fn meshes(&self, frame_count: u64) -> Option<(FrameNames, MeshFormat)> {
        Some(match self {
            Self::FrameSet(_) | Self::Morphs(_) => return None,
            Self::Mesh(path, format) if frame_count == 1 => {
                (FrameNames::Single(path.clone()), *format)
            }
            Self::Mesh(path, format) => (FrameNames::numbered_from(path), *format),
            Self::Meshes(names, format) => (names.clone(), *format),
        })
    }

    /// Finds out whether the target can be written, and creates the last folder of many meshes.
    pub(crate) fn prepare(&self, frames: FrameRange) -> Result<()> {
        let probe = match self {
            Self::FrameSet(path) | Self::Morphs(path) => path.clone(),
            Self::Meshes(names, _) => {
                let probe = names.path(frames.first);
                create_folder(&folder_of(&probe))?;
                probe
            }
            Self::Mesh(path, _) => match self.meshes(frames.count()) {
                Some((names, _)) => names.path(frames.first),
                None => path.clone(),
            },
        };
        atomic::check_writable(&probe)
    }
}

impl fmt::Display for MeshFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Ply => ".ply",
            Self::Obj => ".obj",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn target(path: &str) -> MeshTarget {
        MeshTarget::from_path(Path::new(path)).unwrap()
    }

    #[test]
    fn sets_meshes_folders_and_patterns_are_told_apart() {
        assert_eq!(target("a/B.NPZ"), MeshTarget::FrameSet("a/B.NPZ".into()));
        assert_eq!(target("a.glb"), MeshTarget::Morphs("a.glb".into()));
        let (names, format) = target("x.obj").meshes(1).unwrap();
        assert_eq!((names.path(7), format), ("x.obj".into(), MeshFormat::Obj));
        let (names, _) = target("x.obj").meshes(2).unwrap();
        assert_eq!(names.path(7), Path::new("./x_0007.obj"));
        let (names, format) = target("out/").meshes(1).unwrap();
        assert_eq!((names.path(7), format), ("out/frame_0007.ply".into(), MeshFormat::Ply));
        let (names, format) = target("out/%02d.obj").meshes(1).unwrap();
        assert_eq!((names.path(7), format), ("out/07.obj".into(), MeshFormat::Obj));
    }

    #[test]
    fn unknown_formats_are_told_what_there_is() {
        for path in ["x", "x.stl", "no/such/folder", "x.ply.gz"] {
            let error = MeshTarget::from_path(Path::new(path)).unwrap_err();
            assert!(error.to_string().contains(".npz"), "{path}: {error}");
        }
    }
}
