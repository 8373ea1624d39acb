//! Sequences: a mesh file a frame, in a folder, by a pattern, or beginning with a first file.
//!
//! The files are the frames in natural order (9 before 10), whatever the numbers in their names;
//! numbers that are missing are told. Each frame is one mesh: its objects are joined, since those
//! of one frame need not be those of the next. Materials are those of the first frame that shows
//! anything, by their names; what has another name is light grey.
//!
//! **Invariants.** A frame is read when it is shown; nothing of it stays behind but what
//! [`FrameStream`] holds.
//!
//! **Cost.** The names of all files; the time to read a file each time a frame is shown.

mod find;
mod frames;
mod numbering;
mod palette;

#[cfg(test)]
mod tests;

use std::path::PathBuf;
use std::sync::Arc;

use rayflock_scene::{FrameSource, FrameStream, Scene, Shape, SurfaceMesh};

use crate::ImportError;
use crate::job::Job;
use frames::FileFrames;
use palette::Palette;

pub(crate) use find::{Source, find};
pub(crate) use palette::joined;

/// Frames that are searched for one that shows anything, for its materials.
const SEARCHED_FRAMES: usize = 100;

/// Streams the frames in `files`, one at least.
pub(crate) fn load(files: Vec<PathBuf>, job: &mut Job<'_>) -> Result<Scene, ImportError> {
    if job.file.is_file() && files.len() > 1 {
        let message = format!("the first of {} numbered files, which are the frames", files.len());
        job.warn("name", message);
    }
    numbering::report_gaps(&files, job);
    let first = first_shown(&files, job)?;
    let name = numbering::common_name(&files).unwrap_or_else(|| job.name());
    let mut materials = first.materials;
    let palette = Palette::new(&mut materials);
    let mut scene = Scene { name, materials, textures: first.textures, ..Scene::default() };
    let source = FileFrames::new(files, palette, job);
    add_stream(&mut scene, source, job)?;
    Ok(scene)
}

/// Adds an object of this many frames to a scene, which gets the object's name, rate and number
/// of frames.
pub(crate) fn add_stream(
    scene: &mut Scene,
    source: impl FrameSource + 'static,
    job: &Job<'_>,
) -> Result<(), ImportError> {
    scene.frame_rate = job.options.frame_rate.or(scene.frame_rate);
    scene.frame_count = Some(source.frame_count());
    let stream = FrameStream::new(source, scene.default_frame_rate(), job.options.in_betweens)
        .map_err(|error| job.invalid("frames", error.to_string(), "at least one"))?;
    let shape = Shape::Animated(Arc::new(stream));
    job.add_upright(scene, vec![(scene.name.clone(), shape)]);
    Ok(())
}

/// The first frame with any primitives among the first [`SEARCHED_FRAMES`], or else the first.
fn first_shown(files: &[PathBuf], job: &mut Job<'_>) -> Result<Scene, ImportError> {
    let mut shown = Scene::default();
    for file in files.iter().take(SEARCHED_FRAMES) {
        let mut frame = job.of_file(file);
        shown = crate::load_file(&mut frame)?;
        job.point_radius = frame.point_radius;
        if surfaces(&shown).any(|surface| surface.mesh.prim_count() > 0) {
            break;
        }
    }
    Ok(shown)
}

/// The meshes of a scene in which nothing moves.
pub(crate) fn surfaces(scene: &Scene) -> impl Iterator<Item = &SurfaceMesh> {
    scene.objects.iter().filter_map(|object| match &object.shape {
        Shape::Fixed(surface) => Some(surface),
        _ => None,
    })
}
