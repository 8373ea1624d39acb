//! What is odd in AFF files but bearable: counted on the way, told once in the end.

use std::collections::BTreeSet;

use super::words::Word;
use crate::ImportError;
use crate::job::Job;

/// Names of unknown commands in a warning.
const UNKNOWN_NAMES: usize = 8;

/// Counts of what is odd, and of commands that are not.
#[derive(Debug, Default)]
pub(super) struct Oddities {
    pub(super) known_commands: usize,
    unknown_commands: usize,
    /// The first few of their names.
    unknown_names: BTreeSet<String>,
    pub(super) stray_numbers: usize,
    pub(super) small_polygons: usize,
    pub(super) pointless_cones: usize,
    pub(super) stretched_spheres: usize,
    pub(super) skipped_includes: usize,
}

impl Oddities {
    pub(super) fn add_unknown(&mut self, command: Word<'_>) {
        self.unknown_commands += 1;
        if self.unknown_names.len() < UNKNOWN_NAMES {
            self.unknown_names.insert(crate::error::shorten(&command.text()));
        }
    }

    /// Warns of everything; an error where nothing at all is known.
    pub(super) fn report(self, job: &mut Job<'_>) -> Result<(), ImportError> {
        let names = Vec::from_iter(self.unknown_names).join(", ");
        if self.known_commands == 0 && self.unknown_commands + self.stray_numbers > 0 {
            let found = if names.is_empty() { "numbers" } else { names.as_str() };
            return Err(job.invalid("text", format!("only {found}"), "commands such as v or p"));
        }
        let unknown = format!("are not known ({names}); their lines are ignored");
        let counts = [
            (self.unknown_commands, "commands", unknown.as_str()),
            (self.stray_numbers, "numbers", "belong to no command; they are ignored"),
            (self.small_polygons, "polygons", "have fewer than 3 corners; they are ignored"),
            (self.pointless_cones, "cones", "have no length; they are ignored"),
            (self.stretched_spheres, "spheres", "are stretched; they become triangles"),
            (self.skipped_includes, "included files", "are above the level of detail; left out"),
        ];
        for (count, element, message) in counts.into_iter().filter(|(count, ..)| *count > 0) {
            job.warn(element, format!("{count} {message}"));
        }
        Ok(())
    }
}
