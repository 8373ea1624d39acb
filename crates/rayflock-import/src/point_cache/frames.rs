//! The samples of a cache as frames.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use glam::Vec3;
use rayflock_scene::{FrameSource, MotionKind, SurfaceMesh};

use super::base_mesh::BaseMesh;
use super::header::Header;

/// Frames read from the file when they are shown.
#[derive(Debug)]
pub(super) struct CacheFrames {
    file: PathBuf,
    header: Header,
    base: BaseMesh,
}

impl CacheFrames {
    /// The samples of the file at `file`, which move `base`.
    pub(super) fn new(file: &Path, header: Header, base: BaseMesh) -> Self {
        Self { file: file.to_owned(), header, base }
    }

    /// The points of a sample.
    fn points(&self, sample_idx: usize) -> std::io::Result<Vec<Vec3>> {
        let Header { start, is_big_endian, .. } = self.header;
        let mut file = File::open(&self.file)?;
        file.seek(SeekFrom::Start(start + sample_idx as u64 * self.header.sample_size()))?;
        let mut bytes = vec![0; self.header.sample_size() as usize];
        file.read_exact(&mut bytes)?;
        let number = |bytes: [u8; 4]| match is_big_endian {
            true => f32::from_be_bytes(bytes),
            false => f32::from_le_bytes(bytes),
        };
        let numbers: Vec<f32> = bytes.as_chunks().0.iter().map(|&bytes| number(bytes)).collect();
        Ok(numbers.as_chunks().0.iter().map(|&point| Vec3::from(point)).collect())
    }
}

impl FrameSource for CacheFrames {
    fn frame_count(&self) -> usize {
        self.header.sample_count
    }

    fn motion(&self) -> MotionKind {
        MotionKind::Deforming
    }

    fn load(&self, frame_idx: usize) -> Result<SurfaceMesh, String> {
        let context =
            |error: String| format!("{}: sample {frame_idx}: {error}", self.file.display());
        let points = self.points(frame_idx).map_err(|error| context(error.to_string()))?;
        self.base.moved(&points).map_err(|error| context(error.to_string()))
    }
}
