//! The paths of numbered frames.

use std::path::{Path, PathBuf};

/// Digits of a frame number where the path does not say.
const DEFAULT_DIGITS: usize = 4;

/// How the path of a frame follows from its number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum FrameNames {
    /// One frame, at this path.
    Single(PathBuf),
    /// The number between a prefix and a suffix, with zeros in front up to `digits`.
    Numbered {
        /// The folder of the frames.
        folder: PathBuf,
        /// The file name before the number.
        prefix: String,
        /// Digits at least.
        digits: usize,
        /// The file name after the number.
        suffix: String,
    },
}

impl FrameNames {
    /// Frames called `frame_0000.png` and so on, with this extension.
    pub(crate) fn in_folder(folder: &Path, extension: &str) -> Self {
        Self::Numbered {
            folder: folder.to_owned(),
            prefix: "frame_".to_owned(),
            digits: DEFAULT_DIGITS,
            suffix: format!(".{extension}"),
        }
    }

    /// What a path with `%d` or `%04d` in its file name asks for; `None` when there is no such
    /// mark.
    pub(crate) fn from_pattern(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_str()?;
        let (mark, _) =
            name.match_indices('%').find(|&(at, _)| mark_digits(&name[at..]).is_some())?;
        let (digits, mark_len) = mark_digits(&name[mark..])?;
        Some(Self::Numbered {
            folder: folder_of(path),
            prefix: name[..mark].to_owned(),
            digits,
            suffix: name[mark + mark_len..].to_owned(),
        })
    }

    /// The path of one picture, with the number put before the extension: `x_0000.png`.
    pub(crate) fn numbered_from(path: &Path) -> Self {
        let text = |part: Option<&std::ffi::OsStr>| {
            part.unwrap_or_default().to_string_lossy().into_owned()
        };
        Self::Numbered {
            folder: folder_of(path),
            prefix: format!("{}_", text(path.file_stem())),
            digits: DEFAULT_DIGITS,
            suffix: format!(".{}", text(path.extension())),
        }
    }

    /// The path of frame `frame`.
    pub(crate) fn path(&self, frame: u32) -> PathBuf {
        match self {
            Self::Single(path) => path.clone(),
            Self::Numbered { folder, prefix, digits, suffix } => {
                folder.join(format!("{prefix}{frame:0digits$}{suffix}"))
            }
        }
    }

    /// The folder of the frames.
    pub(crate) fn folder(&self) -> PathBuf {
        folder_of(&self.pattern())
    }

    /// The names as a pattern, for people and for the name of the journal.
    pub(crate) fn pattern(&self) -> PathBuf {
        match self {
            Self::Single(path) => path.clone(),
            Self::Numbered { folder, prefix, digits, suffix } => {
                folder.join(format!("{prefix}%0{digits}d{suffix}"))
            }
        }
    }
}

/// The folder that holds `path`.
pub(crate) fn folder_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if parent != Path::new("") => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// The digits that a mark at the start of `text` asks for, and the length of the mark.
fn mark_digits(text: &str) -> Option<(usize, usize)> {
    let (number, _) = text.strip_prefix('%')?.split_once('d')?;
    let digits = match number {
        "" => 1,
        _ => number.strip_prefix('0')?.parse().ok().filter(|digits| (1..=10).contains(digits))?,
    };
    Some((digits, number.len() + 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_says_where_the_number_goes() {
        let path = |pattern: &str, frame| {
            FrameNames::from_pattern(Path::new(pattern)).map(|names| names.path(frame))
        };
        assert_eq!(path("out/f_%04d.png", 7), Some("out/f_0007.png".into()));
        assert_eq!(path("%03d.exr", 12345), Some("./12345.exr".into()));
        assert_eq!(path("a%db.png", 3), Some("./a3b.png".into()));
        assert_eq!(path("100%_%02d.png", 3), Some("./100%_03.png".into()));
        for pattern in ["x.png", "50%.png", "%s.png", "%4d.png", "%0xd.png", "a%04d/x.png"] {
            assert_eq!(path(pattern, 0), None, "{pattern}");
        }
    }

    #[test]
    fn names_and_patterns_belong_together() {
        let names = FrameNames::numbered_from(Path::new("a/b.c.png"));
        assert_eq!(names.path(12), Path::new("a/b.c_0012.png"));
        assert_eq!(names.pattern(), Path::new("a/b.c_%04d.png"));
        assert_eq!(FrameNames::from_pattern(&names.pattern()), Some(names));
    }
}
