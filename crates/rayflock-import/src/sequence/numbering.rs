//! Numbers in the names of frames.

use std::path::{Path, PathBuf};

use crate::job::Job;

/// Numbers and ranges listed at most.
const LISTED: usize = 8;

/// A file name around its last number: `cloth_` 0012 `.obj`. Digits in extensions do not count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Numbered<'a> {
    before: &'a str,
    pub(super) number: u64,
    after: &'a str,
}

impl<'a> Numbered<'a> {
    /// `None` for a name without a number of usual size.
    pub(super) fn new(name: &'a str) -> Option<Self> {
        let is_compressed = name.to_ascii_lowercase().ends_with(".gz");
        let inner = if is_compressed { &name[..name.len() - 3] } else { name };
        let (stem, _) = inner.rsplit_once('.').unwrap_or((inner, ""));
        let end = stem.rfind(|c: char| c.is_ascii_digit())? + 1;
        let start = stem[..end].trim_end_matches(|c: char| c.is_ascii_digit()).len();
        let number = name[start..end].parse().ok()?;
        Some(Self { before: &name[..start], number, after: &name[end..] })
    }

    /// Whether the names are the same but for their numbers.
    pub(super) fn belongs_to(&self, other: &Self) -> bool {
        (self.before, self.after) == (other.before, other.after)
    }
}

fn numbered(file: &Path) -> Option<Numbered<'_>> {
    Numbered::new(file.file_name()?.to_str()?)
}

/// What the names of all files begin with before their numbers, or else the name of their folder.
pub(super) fn common_name(files: &[PathBuf]) -> Option<String> {
    let first = files.first()?;
    let before = numbered(first).map_or("", |numbered| numbered.before);
    let is_common = files.iter().all(|file| {
        file.file_name().is_some_and(|name| name.to_string_lossy().starts_with(before))
    });
    let trimmed = before.trim_end_matches(['_', '-', '.', ' ']);
    if is_common && !trimmed.is_empty() {
        return Some(trimmed.to_owned());
    }
    let folder = first.parent()?.file_name()?.to_string_lossy();
    Some(folder.into_owned())
}

/// Warns of numbers that are missing between those of the files, or there twice. Names that
/// differ in more than one number have no order that could have gaps.
pub(super) fn report_gaps(files: &[PathBuf], job: &mut Job<'_>) {
    let Some(numbers) = numbers(files) else { return };
    let pairs = || numbers.windows(2).map(|pair| (pair[0], pair[1], pair[1].abs_diff(pair[0])));
    // Frames may be some steps of a simulation apart.
    let step = pairs().map(|(.., distance)| distance).filter(|&distance| distance > 0).min();
    let step = step.unwrap_or(1);
    let gap = |(before, after, _): (u64, u64, u64)| match (before + step, after - step) {
        (first, last) if first < last => format!("{first}..{last}"),
        (first, _) => first.to_string(),
    };
    let gaps: Vec<String> = pairs().filter(|(.., distance)| *distance > step).map(gap).collect();
    if !gaps.is_empty() {
        let message = format!("{} missing; frames follow each other without them", list(&gaps));
        job.warn("numbers", message);
    }
    let double = |(number, ..): (u64, u64, u64)| number.to_string();
    let doubles: Vec<String> =
        pairs().filter(|(.., distance)| *distance == 0).map(double).collect();
    if !doubles.is_empty() {
        job.warn("numbers", format!("{} there twice; both are frames", list(&doubles)));
    }
}

/// The first few of many.
fn list(words: &[String]) -> String {
    match words.get(..LISTED) {
        Some(first) if words.len() > LISTED => {
            format!("{} and {} more are", first.join(", "), words.len() - LISTED)
        }
        _ if words.len() == 1 && !words[0].contains("..") => format!("{} is", words[0]),
        _ => format!("{} are", words.join(", ")),
    }
}

/// The numbers of the files, if their names differ in nothing else (but compression).
fn numbers(files: &[PathBuf]) -> Option<Vec<u64>> {
    fn core<'a>(numbered: &Numbered<'a>) -> (&'a str, &'a str) {
        (numbered.before, numbered.after.strip_suffix(".gz").unwrap_or(numbered.after))
    }
    let first = numbered(files.first()?)?;
    let number = |file: &PathBuf| {
        numbered(file).filter(|this| core(this) == core(&first)).map(|this| this.number)
    };
    files.iter().map(number).collect()
}
