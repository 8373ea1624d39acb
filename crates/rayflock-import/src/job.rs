//! One import: which file, where its neighbours lie, and whom to tell.

use std::path::{Component, Path, PathBuf};

use glam::{Affine3A, Quat};
use rayflock_scene::{LocalTransform, Node, NodeIdx, Scene, SceneObject, Shape};

use crate::{ImportError, LoadOptions, Reporter, UpAxis, Warning, gz};

/// What every importer needs besides the bytes.
#[derive(Debug)]
pub(crate) struct Job<'a> {
    pub(crate) file: &'a Path,
    pub(crate) options: &'a LoadOptions,
    pub(crate) reporter: &'a mut Reporter,
    /// Pixels that images may still have, all together.
    pub(crate) pixels_left: u64,
    /// Whether materials are wanted.
    pub(crate) looks: Looks,
    /// The radius of points that have none, once it is known.
    pub(crate) point_radius: Option<f32>,
}

/// What is wanted of materials that lie in files of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Looks {
    /// Everything.
    Read,
    /// Their names: a frame of a sequence has the materials of the first.
    Names,
}

impl<'a> Job<'a> {
    /// An import that has just begun.
    pub(crate) fn new(
        file: &'a Path,
        options: &'a LoadOptions,
        reporter: &'a mut Reporter,
    ) -> Self {
        let pixels_left = crate::texture::PIXEL_LIMIT;
        let (looks, point_radius) = (Looks::Read, None);
        Self { file, options, reporter, pixels_left, looks, point_radius }
    }

    /// The same import, of another file.
    pub(crate) fn of_file<'b>(&'b mut self, file: &'b Path) -> Job<'b> {
        let Job { options, pixels_left, looks, point_radius, .. } = *self;
        Job { file, options, reporter: self.reporter, pixels_left, looks, point_radius }
    }

    /// Tells that a part of the file was left out or put right.
    pub(crate) fn warn(&mut self, element: impl Into<String>, message: impl Into<String>) {
        let (file, message) = (self.file.to_owned(), crate::error::shorten(&message.into()));
        self.reporter.warn(Warning { file, element: element.into(), message });
    }

    /// Content that breaks the rules of its format.
    pub(crate) fn invalid(
        &self,
        element: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> ImportError {
        ImportError::invalid(self.file, element, found, expected)
    }

    /// The file's name without folder and extensions.
    pub(crate) fn name(&self) -> String {
        let name = self.file.file_name().unwrap_or_default().to_string_lossy();
        name.split('.').find(|part| !part.is_empty()).unwrap_or_default().to_owned()
    }

    /// Where a relative path inside the file leads.
    ///
    /// Only the file's own folder and folders below it are open: a file from a stranger must
    /// not reach elsewhere.
    pub(crate) fn neighbour(&self, relative: &str) -> Result<PathBuf, String> {
        let relative = relative.replace('\\', "/");
        let inside = |part: Component<'_>| matches!(part, Component::Normal(_) | Component::CurDir);
        if relative.contains(':') {
            return Err(format!("\"{relative}\" is not a relative path"));
        }
        if relative.is_empty() || !Path::new(&relative).components().all(inside) {
            return Err(format!("\"{relative}\" leads out of the file's folder"));
        }
        Ok(self.file.parent().unwrap_or(Path::new("")).join(relative))
    }

    /// The content of the file, decompressed if its name ends in `.gz`.
    pub(crate) fn content(&self) -> Result<Vec<u8>, ImportError> {
        let io = |reason| ImportError::Io { file: self.file.to_owned(), reason };
        let bytes = read_file(self.file).map_err(io)?;
        let (_, compressed) = crate::split_extension(self.file);
        if compressed { gz::decompress(self.file, &bytes) } else { Ok(bytes) }
    }

    /// The content of a file beside this one.
    pub(crate) fn read_neighbour(&self, relative: &str) -> Result<Vec<u8>, String> {
        let path = self.neighbour(relative)?;
        read_file(&path).map_err(|reason| format!("\"{relative}\" cannot be read: {reason}"))
    }

    /// Puts objects of a format without a convention for "up" into a scene.
    pub(crate) fn add_upright(&self, scene: &mut Scene, objects: Vec<(String, Shape)>) {
        let node = match self.options.up_axis {
            UpAxis::Y => None,
            UpAxis::Z => {
                let turn = Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2);
                let rest = LocalTransform::Matrix(Affine3A::from_quat(turn));
                let name = "z up".to_owned();
                scene.nodes.push(Node { name, parent: None, rest, rest_weights: Vec::new() });
                Some(NodeIdx(0))
            }
        };
        let object = |(name, shape)| SceneObject { name, node, mask: u32::MAX, shape };
        scene.objects.extend(objects.into_iter().map(object));
    }
}

/// The bytes of a regular file, or why they cannot be had.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>, String> {
    check_file(path)?;
    std::fs::read(path).map_err(|error| error.to_string())
}

/// Whether there is a regular file at `path`, or what is there.
pub(crate) fn check_file(path: &Path) -> Result<(), String> {
    let metadata = std::fs::metadata(path).map_err(|error| error.to_string())?;
    if metadata.is_file() {
        return Ok(());
    }
    let found = if metadata.is_dir() { "a folder" } else { "a device or pipe" };
    Err(format!("found {found}, expected a file"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_stay_in_the_folder() {
        let (options, mut reporter) = (LoadOptions::default(), Reporter::new());
        let file = Path::new("models/a.v2.gltf");
        let job = Job::new(file, &options, &mut reporter);
        assert_eq!(job.name(), "a");
        assert_eq!(job.neighbour("tex\\b.png"), Ok(PathBuf::from("models/tex/b.png")));
        for bad in ["", "../b.png", "/etc/passwd", "c:\\b.png", "http://host/b.png", "a/../../b"] {
            assert!(job.neighbour(bad).is_err(), "{bad}");
        }
    }
}
