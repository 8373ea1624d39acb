//! Why a file cannot be read.

use std::path::{Path, PathBuf};

use thiserror::Error;

/// Why a file cannot be read. The first group is for the author of the file to mend, the second
/// for whoever chose it, the last for the machine's owner.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ImportError {
    /// The content breaks the rules of its format.
    #[error("{}: {element}: found {found}, expected {expected}", file.display())]
    Invalid {
        /// The file that was asked for.
        file: PathBuf,
        /// The part of it: a line, a header, an accessor.
        element: String,
        /// What is there.
        found: String,
        /// What should be there.
        expected: String,
    },
    /// The content needs more room than a file of its size may ask for.
    #[error("{}: {element}: {found} is more than the limit of {limit}", file.display())]
    TooLarge {
        /// The file that was asked for.
        file: PathBuf,
        /// The part of it.
        element: String,
        /// The size asked for.
        found: String,
        /// The largest size that is read.
        limit: String,
    },
    /// The content is in order but uses what is not read.
    #[error("{}: {element}: {found} is not supported; {expected} is", file.display())]
    Unsupported {
        /// The file that was asked for.
        file: PathBuf,
        /// The part of it.
        element: String,
        /// What is not read.
        found: String,
        /// What is read in its place.
        expected: String,
    },
    /// The name does not end in a known way.
    #[error("{}: found {found}, expected one of {expected}", file.display())]
    UnknownFormat {
        /// The file that was asked for.
        file: PathBuf,
        /// How its name ends.
        found: String,
        /// The extensions that are read.
        expected: String,
    },
    /// The file cannot be opened or read.
    #[error("{}: {reason}", file.display())]
    Io {
        /// The file that cannot be read.
        file: PathBuf,
        /// What the system says, or what is there in place of a file.
        reason: String,
    },
}

impl ImportError {
    /// Content that breaks the rules of its format.
    pub(crate) fn invalid(
        file: &Path,
        element: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::Invalid {
            file: file.to_owned(),
            element: element.into(),
            found: shorten(&found.into()),
            expected: expected.into(),
        }
    }
}

/// Longest quotation from a file in a message, in bytes.
const LONGEST_QUOTE: usize = 300;

/// The text without control characters and cut to a length that suits a message.
pub(crate) fn shorten(text: &str) -> String {
    let text = text.trim_end();
    let shown = &text[..text.floor_char_boundary(LONGEST_QUOTE)];
    let clean = shown.replace(|c: char| c.is_control(), " ");
    if shown.len() < text.len() { clean + "..." } else { clean }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_names_file_element_found_and_expected() {
        let error = ImportError::invalid(Path::new("a.obj"), "line 3", "\"f 9\"", "3 corners");
        assert_eq!(error.to_string(), "a.obj: line 3: found \"f 9\", expected 3 corners");
    }

    #[test]
    fn quotations_are_cut_between_characters() {
        let cut = shorten(&"ä".repeat(1000));
        assert!(cut.len() <= LONGEST_QUOTE + 3 && cut.ends_with("ä..."));
        assert_eq!(shorten("a\u{1b}[31m\n"), "a [31m");
    }
}
