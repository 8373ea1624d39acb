//! The frames of a sequence, each from its file.

use std::path::{Path, PathBuf};

use rayflock_scene::{FrameSource, SurfaceMesh};

use super::palette::{Palette, joined};
use super::surfaces;
use crate::job::{Job, Looks};
use crate::{ImportError, LoadOptions, Reporter};

/// Files that are read when their frame is shown.
#[derive(Debug)]
pub(super) struct FileFrames {
    files: Vec<PathBuf>,
    options: LoadOptions,
    palette: Palette,
    /// Of points that have none, so that it is the same in all frames.
    point_radius: Option<f32>,
}

impl FileFrames {
    /// Frames read as `job` says, with materials of `palette`.
    pub(super) fn new(files: Vec<PathBuf>, palette: Palette, job: &Job<'_>) -> Self {
        let (options, point_radius) = (job.options.clone(), job.point_radius);
        Self { files, options, palette, point_radius }
    }

    fn read(&self, file: &Path) -> Result<SurfaceMesh, ImportError> {
        // What is odd was told of the first frame; nobody listens while frames are shown.
        let mut reporter = Reporter::new();
        let mut job = Job::new(file, &self.options, &mut reporter);
        job.looks = Looks::Names;
        job.point_radius = self.point_radius;
        let scene = crate::load_file(&mut job)?;
        let translated = self.palette.translate(&scene.materials);
        let meshes: Vec<&SurfaceMesh> = surfaces(&scene).collect();
        joined(&meshes, &translated)
            .map_err(|error| job.invalid("objects", error.to_string(), "indices in range"))
    }
}

impl FrameSource for FileFrames {
    fn frame_count(&self) -> usize {
        self.files.len()
    }

    fn load(&self, frame_idx: usize) -> Result<SurfaceMesh, String> {
        self.read(&self.files[frame_idx]).map_err(|error| error.to_string())
    }
}
