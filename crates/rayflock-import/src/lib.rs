//! Reads files into scenes.
//!
//! | Format | Extensions | Read |
//! |---|---|---|
//! | glTF 2.0 | `.gltf`, `.glb` | meshes, instances, skins, morphs, clips, materials, cameras, lights |
//! | OBJ | `.obj` with `.mtl` | polygons in groups, with materials by face |
//! | PLY | `.ply` | polygons with attributes, or spheres; ascii, binary of both byte orders |
//! | STL | `.stl` | binary and ascii; corners at one place are welded |
//! | AFF | `.aff`, `.nff` | BART's animated scenes, and NFF: all but what makes surfaces one-sided |
//!
//! Each may be compressed: `.stl.gz` and so on. [`load`] chooses by extension.
//!
//! **Up.** Scenes are +Y up. glTF says so itself; OBJ, PLY and STL have no convention and are
//! taken as they are, or turned by [`LoadOptions::up_axis`]. AFF is taken as it is: its camera
//! says what is up.
//!
//! **Damage.** Every file is taken for hostile: sizes are checked against the bytes that are
//! there before anything is allocated, indices before they are used, and paths may not leave the
//! file's folder. What breaks the rules is an [`ImportError`]; what can be left out or put right
//! is a [`Warning`] in the [`Reporter`], and the import goes on.
//!
//! ```no_run
//! use rayflock_import::{Reporter, load};
//!
//! let mut reporter = Reporter::new();
//! let scene = load("fox.glb".as_ref(), &mut reporter)?;
//! reporter.warnings().iter().for_each(|warning| eprintln!("{warning}"));
//! println!("{} objects", scene.objects.len());
//! # Ok::<(), rayflock_import::ImportError>(())
//! ```
#![forbid(unsafe_code)]

mod aff;
mod error;
mod gltf;
mod gz;
mod job;
mod mesh_parts;
mod obj;
mod ply;
mod polygon;
mod reporter;
mod stl;
mod texture;
mod texture_files;

#[cfg(test)]
mod tests;

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use rayflock_scene::Scene;

pub use error::ImportError;
pub use reporter::{Reporter, Warning};

/// The extensions that are read, lower case, without `.gz`.
pub const EXTENSIONS: &[&str] = &["gltf", "glb", "obj", "ply", "stl", "aff", "nff"];

/// How to take what a file leaves open.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LoadOptions {
    /// Which way is up in files of formats that do not say: OBJ, PLY and STL.
    pub up_axis: UpAxis,
    /// Files that an AFF file includes are read up to this level of detail; by default up to the
    /// level that the file states, or all if it states none.
    pub detail: Option<u32>,
}

/// Which way is up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UpAxis {
    /// +Y, as in scenes.
    #[default]
    Y,
    /// +Z, as in most CAD and robotics data; the objects hang on a node that turns them.
    Z,
}

impl fmt::Display for UpAxis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Y => "y",
            Self::Z => "z",
        })
    }
}

impl FromStr for UpAxis {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "y" => Ok(Self::Y),
            "z" => Ok(Self::Z),
            _ => Err(format!("found \"{name}\", expected y or z")),
        }
    }
}

/// Reads the file at `path`, whose extension says how; `.gz` on top means compressed.
///
/// # Errors
/// [`ImportError`] when the file cannot be read, has an unknown extension or breaks the rules of
/// its format.
pub fn load(path: &Path, reporter: &mut Reporter) -> Result<Scene, ImportError> {
    load_with(path, &LoadOptions::default(), reporter)
}

/// Reads the file at `path` like [`load`], with options.
///
/// # Errors
/// As for [`load`].
pub fn load_with(
    path: &Path,
    options: &LoadOptions,
    reporter: &mut Reporter,
) -> Result<Scene, ImportError> {
    let (extension, compressed) = extension(path)?;
    let read_error = |reason| ImportError::Io { file: path.to_owned(), reason };
    let mut bytes = job::read_file(path).map_err(read_error)?;
    if compressed {
        bytes = gz::decompress(path, &bytes)?;
    }
    let mut job = job::Job::new(path, options, reporter);
    let Some(load) = importer(&extension) else {
        unreachable!("`extension` lets through what has an importer")
    };
    load(bytes, &mut job)
}

/// What reads a format.
type Importer = fn(Vec<u8>, &mut job::Job<'_>) -> Result<Scene, ImportError>;

fn importer(extension: &str) -> Option<Importer> {
    match extension {
        "gltf" | "glb" => Some(gltf::load),
        "obj" => Some(obj::load),
        "ply" => Some(ply::load),
        "stl" => Some(stl::load),
        "aff" | "nff" => Some(aff::load),
        _ => None,
    }
}

/// The extension in lower case without `.gz`, and whether `.gz` was there.
fn extension(path: &Path) -> Result<(String, bool), ImportError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let (inner, compressed) = match name.strip_suffix(".gz") {
        Some(inner) => (inner, true),
        None => (name.as_str(), false),
    };
    let (_, extension) = inner.rsplit_once('.').unwrap_or_default();
    if importer(extension).is_some() {
        return Ok((extension.to_owned(), compressed));
    }
    Err(ImportError::UnknownFormat {
        file: path.to_owned(),
        found: match extension {
            "" => "no extension".to_owned(),
            _ => format!("the extension \".{extension}\""),
        },
        expected: format!(".{}, or these with .gz", EXTENSIONS.join(", .")),
    })
}
