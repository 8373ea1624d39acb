//! Reads files into scenes.
//!
//! | Format | Extensions | Read |
//! |---|---|---|
//! | glTF 2.0 | `.gltf`, `.glb` | meshes, instances, skins, morphs, clips, materials, cameras, lights |
//! | OBJ | `.obj` with `.mtl` | polygons in groups, with materials by face |
//! | PLY | `.ply` | polygons with attributes, or points; ascii, binary of both byte orders |
//! | STL | `.stl` | binary and ascii; corners at one place are welded |
//! | AFF | `.aff`, `.nff` | BART's animated scenes, and NFF: all but what makes surfaces one-sided |
//! | VTK | `.vtk`, `.vtp` | polygons and strips with normals, or points; legacy and XML |
//! | NumPy | `.npz` | frames of triangles or points as arrays |
//! | point caches | `.pc2`, `.mdd` | vertices of each frame, with the mesh beside the cache |
//! | sequences | folders, patterns | a file a frame: OBJ, PLY, STL or VTK |
//!
//! Each but point caches may be compressed: `.stl.gz` and so on. [`load`] chooses by extension.
//! Points are spheres; where they have no radius, it comes from the distances between them.
//!
//! **Frames.** Sequences and point caches are read when a frame is shown, and hold only the
//! frames at hand ([`FrameStream`](rayflock_scene::FrameStream)); what is wrong with a late one
//! is an error of that frame.
//!
//! **Up.** Scenes are +Y up. glTF says so itself; AFF is taken as it is, for its camera says what is
//! up; the other formats have no convention and are taken as they are, or turned by
//! [`LoadOptions::up_axis`].
//!
//! **Damage.** Every file is taken for hostile: sizes are checked against the bytes that are
//! there before anything is allocated, indices before they are used, and paths may not leave the
//! file's folder. What breaks the rules is an [`ImportError`]; what can be left out or put right
//! is a [`Warning`] in the [`Reporter`], and the import goes on.
//!
//! **The other way.** [`export`] writes the geometry of frames: OBJ, PLY, NumPy and glTF.
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
pub mod export;
mod gltf;
mod gz;
mod job;
mod mesh_parts;
mod npz;
mod obj;
mod options;
mod particles;
mod ply;
mod point_cache;
mod polygon;
mod reporter;
mod sequence;
mod stl;
mod texture;
mod texture_files;
mod vtk;

#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

use rayflock_scene::Scene;

pub use error::ImportError;
pub use options::{LoadOptions, NumberedFile, UpAxis};
pub use reporter::{Reporter, Warning};

use job::Job;
use sequence::Source;

/// The extensions that are read, lower case, without `.gz`.
pub const EXTENSIONS: &[&str] =
    &["gltf", "glb", "obj", "ply", "stl", "vtk", "vtp", "npz", "pc2", "mdd", "aff", "nff"];

/// Reads the file at `path`, whose extension says how, where `.gz` on top means compressed; or
/// the frames in the folder at `path`, or that match the pattern `path`.
///
/// # Errors
/// [`ImportError`] when the file cannot be read, has an unknown extension or breaks the rules of
/// its format, and when there are no frames or frames of several formats.
pub fn load(path: &Path, reporter: &mut Reporter) -> Result<Scene, ImportError> {
    load_with(path, &LoadOptions::default(), reporter)
}

/// Reads the file or frames at `path` like [`load`], with options.
///
/// # Errors
/// As for [`load`].
pub fn load_with(
    path: &Path,
    options: &LoadOptions,
    reporter: &mut Reporter,
) -> Result<Scene, ImportError> {
    let mut job = Job::new(path, options, reporter);
    match sequence::find(path, options)? {
        Source::File => load_file(&mut job),
        Source::Frames(files) => sequence::load(files, &mut job),
    }
}

/// The files that [`load_with`] takes geometry from: one; a point cache and its mesh; or one a
/// frame in the order of frames.
///
/// # Errors
/// As for [`load`], when there are no frames or frames of several formats.
pub fn source_files(path: &Path, options: &LoadOptions) -> Result<Vec<PathBuf>, ImportError> {
    Ok(match sequence::find(path, options)? {
        Source::File => match split_extension(path).0.as_str() {
            "pc2" | "mdd" => {
                [path.to_owned()].into_iter().chain(point_cache::mesh_file(path)).collect()
            }
            _ => vec![path.to_owned()],
        },
        Source::Frames(files) => files,
    })
}

/// Reads the one file of a job.
fn load_file(job: &mut Job<'_>) -> Result<Scene, ImportError> {
    let (extension, compressed) = extension(job.file)?;
    match importer(&extension) {
        Some(Importer::Content(load)) => {
            let bytes = job.content()?;
            load(bytes, job)
        }
        Some(Importer::InPlace(load)) if !compressed => load(job),
        Some(Importer::InPlace(_)) => Err(ImportError::Unsupported {
            file: job.file.to_owned(),
            element: "name".to_owned(),
            found: "a compressed point cache".to_owned(),
            expected: "an uncompressed one".to_owned(),
        }),
        None => unreachable!("`extension` lets through what has an importer"),
    }
}

/// What reads a format.
#[derive(Clone, Copy, Debug)]
enum Importer {
    /// Takes the whole content.
    Content(fn(Vec<u8>, &mut Job<'_>) -> Result<Scene, ImportError>),
    /// Reads parts of the file when they are wanted.
    InPlace(fn(&mut Job<'_>) -> Result<Scene, ImportError>),
}

fn importer(extension: &str) -> Option<Importer> {
    Some(match extension {
        "gltf" | "glb" => Importer::Content(gltf::load),
        "obj" => Importer::Content(obj::load),
        "ply" => Importer::Content(ply::load),
        "stl" => Importer::Content(stl::load),
        "vtk" | "vtp" => Importer::Content(vtk::load),
        "aff" | "nff" => Importer::Content(aff::load),
        "npz" => Importer::Content(npz::load),
        "pc2" => Importer::InPlace(point_cache::load_pc2),
        "mdd" => Importer::InPlace(point_cache::load_mdd),
        _ => return None,
    })
}

/// The extension in lower case without `.gz`, and whether `.gz` was there.
fn split_extension(path: &Path) -> (String, bool) {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let (inner, compressed) = match name.strip_suffix(".gz") {
        Some(inner) => (inner, true),
        None => (name.as_str(), false),
    };
    let (_, extension) = inner.rsplit_once('.').unwrap_or_default();
    (extension.to_owned(), compressed)
}

/// The extension in lower case without `.gz`, one that is read, and whether `.gz` was there.
fn extension(path: &Path) -> Result<(String, bool), ImportError> {
    let (extension, compressed) = split_extension(path);
    if importer(&extension).is_some() {
        return Ok((extension, compressed));
    }
    Err(ImportError::UnknownFormat {
        file: path.to_owned(),
        found: match extension.as_str() {
            "" => "no extension".to_owned(),
            _ => format!("the extension \".{extension}\""),
        },
        expected: format!(".{}, or these with .gz", EXTENSIONS.join(", .")),
    })
}
