//! What the path after `-o` stands for.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use super::names::folder_of;
use super::{Container, FrameNames, PictureFormat, atomic, mp4};
use crate::args::PngDepth;

const EXPECTED: &str = "expected a picture (.png, .exr), a film (.gif, .webp, .mp4), a folder \
                        (ending in /) or a pattern such as out/frame_%04d.png";

/// Where a render goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    /// One picture, at exactly this path if there is one frame.
    Picture(PathBuf, PictureFormat),
    /// A picture a frame.
    Sequence(FrameNames, PictureFormat),
    /// All frames in one file.
    Film(PathBuf, Container),
}

impl Target {
    /// Understands `path` by its extension, its `%04d` or its final slash.
    pub(crate) fn from_path(path: &Path, png_depth: PngDepth) -> Result<Self> {
        let png = match png_depth {
            PngDepth::Eight => PictureFormat::Png8,
            PngDepth::Sixteen => PictureFormat::Png16,
        };
        if path.to_string_lossy().ends_with(['/', std::path::MAIN_SEPARATOR]) || path.is_dir() {
            return Ok(Self::Sequence(FrameNames::in_folder(path, "png"), png));
        }
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let picture = |format| match FrameNames::from_pattern(path) {
            Some(names) => Self::Sequence(names, format),
            None => Self::Picture(path.to_owned(), format),
        };
        Ok(match extension.as_str() {
            "png" => picture(png),
            "exr" => picture(PictureFormat::Exr),
            "gif" => Self::Film(path.to_owned(), Container::Gif),
            "webp" => Self::Film(path.to_owned(), Container::Webp),
            "mp4" => Self::Film(path.to_owned(), Container::Mp4),
            _ => bail!("cannot tell the format of the output \"{}\": {EXPECTED}", path.display()),
        })
    }

    /// The paths of the frames, if `frame_count` of them are rendered. Those of a film are kept
    /// in a hidden folder beside it until it is finished.
    pub(crate) fn frame_names(&self, frame_count: u64) -> FrameNames {
        match self {
            Self::Picture(path, _) if frame_count == 1 => FrameNames::Single(path.clone()),
            Self::Picture(path, _) => FrameNames::numbered_from(path),
            Self::Sequence(names, _) => names.clone(),
            Self::Film(path, _) => FrameNames::in_folder(&work_folder(path), "png"),
        }
    }

    /// The format of the frames.
    pub(crate) const fn frame_format(&self) -> PictureFormat {
        match self {
            Self::Picture(_, format) | Self::Sequence(_, format) => *format,
            Self::Film(..) => PictureFormat::Png8,
        }
    }

    /// Finds out whether the target can be written, and creates the last folder of a sequence.
    pub(crate) fn prepare(&self, frame_count: u64) -> Result<()> {
        match self {
            Self::Picture(path, _) if frame_count == 1 => atomic::check_writable(path),
            Self::Picture(..) => atomic::check_writable(&self.frame_names(frame_count).path(0)),
            Self::Sequence(names, _) => {
                let probe = names.path(0);
                create_folder(&folder_of(&probe))?;
                atomic::check_writable(&probe)
            }
            Self::Film(path, container) => {
                if *container == Container::Mp4 {
                    mp4::check_available()?;
                }
                atomic::check_writable(path)?;
                create_folder(&work_folder(path))
            }
        }
    }
}

/// Where the frames of the film at `path` are kept until it is finished.
pub(crate) fn work_folder(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.frames"))
}

/// Creates one folder, not those above it: a mistyped path is an error, not a tree of folders.
pub(crate) fn create_folder(folder: &Path) -> Result<()> {
    if folder.is_dir() {
        return Ok(());
    }
    fs::create_dir(folder).with_context(|| format!("cannot create the folder {}", folder.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn target(path: &str) -> Target {
        Target::from_path(Path::new(path), PngDepth::Eight).unwrap()
    }

    #[test]
    fn one_frame_goes_to_exactly_the_path() {
        let picture = target("x.png");
        assert_eq!(picture.frame_names(1).path(7), Path::new("x.png"));
        assert_eq!(picture.frame_names(2).path(7), Path::new("./x_0007.png"));
    }

    #[test]
    fn folders_patterns_and_films_are_told_apart() {
        assert_eq!(target("out/").frame_names(1).path(3), Path::new("out/frame_0003.png"));
        assert!(matches!(target("out/%02d.EXR"), Target::Sequence(_, PictureFormat::Exr)));
        assert!(matches!(target("a.GIF"), Target::Film(_, Container::Gif)));
        let folder = work_folder(Path::new("a/b.mp4"));
        assert_eq!(folder, Path::new("a/.b.mp4.frames"));
    }

    #[test]
    fn unknown_formats_are_told_what_there_is() {
        for path in ["x", "x.jpg", "no/such/folder", "x.png.gz"] {
            let error = Target::from_path(Path::new(path), PngDepth::Eight).unwrap_err();
            assert!(error.to_string().contains(".webp"), "{path}: {error}");
        }
    }
}
