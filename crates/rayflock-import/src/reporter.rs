//! Warnings: what an importer left out or put right on its way.

use std::collections::HashSet;
use std::fmt;
use std::path::PathBuf;

/// Something in a file that was left out or put right; the scene is usable nevertheless.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Warning {
    /// The file that was asked for.
    pub file: PathBuf,
    /// The part of it, such as a line or a material.
    pub element: String,
    /// What is the matter and what was done about it.
    pub message: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}: {}", self.file.display(), self.element, self.message)
    }
}

/// Collects the warnings of one or more imports.
#[derive(Clone, Debug, Default)]
pub struct Reporter {
    warnings: Vec<Warning>,
    /// The same again, to find one quickly: a damaged file can cause very many.
    known: HashSet<Warning>,
}

impl Reporter {
    /// A reporter without warnings.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a warning, unless the same one is there already.
    pub fn warn(&mut self, warning: Warning) {
        if self.known.insert(warning.clone()) {
            self.warnings.push(warning);
        }
    }

    /// The warnings in the order in which they came.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warning_is_kept_once_and_names_its_place() {
        let (file, message) = (PathBuf::from("a.glb"), "not there".to_owned());
        let warning = Warning { file, element: "image 0".to_owned(), message };
        let mut reporter = Reporter::new();
        reporter.warn(warning.clone());
        reporter.warn(warning);
        assert_eq!(reporter.warnings().len(), 1);
        assert_eq!(reporter.warnings()[0].to_string(), "a.glb: image 0: not there");
    }
}
