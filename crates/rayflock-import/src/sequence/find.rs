//! What a path stands for: one file, a folder of frames, a pattern, or the first of many frames.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::numbering::Numbered;
use crate::{ImportError, LoadOptions, NumberedFile, split_extension};

/// The extensions of files that can be frames.
const FRAME_EXTENSIONS: &[&str] = &["obj", "ply", "stl", "vtk", "vtp"];

/// What a path stands for.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Source {
    /// The one file of this path, whether it is there or not.
    File,
    /// These files, one at least, in the order of frames.
    Frames(Vec<PathBuf>),
}

/// Finds out what `path` stands for. What exists is never taken for a pattern.
pub(crate) fn find(path: &Path, options: &LoadOptions) -> Result<Source, ImportError> {
    if path.is_dir() {
        return in_folder(path).map(Source::Frames);
    }
    let is_pattern = path.to_string_lossy().contains(['*', '?', '[']);
    if is_pattern && !path.exists() {
        return matching(path).map(Source::Frames);
    }
    let may_be_first = options.numbered_file == NumberedFile::FirstFrame;
    let followers = may_be_first.then(|| followers(path)).flatten();
    Ok(followers.map_or(Source::File, Source::Frames))
}

/// The frames in a folder, hidden files left out.
fn in_folder(folder: &Path) -> Result<Vec<PathBuf>, ImportError> {
    let files = list(folder)
        .map_err(|error| ImportError::Io { file: folder.to_owned(), reason: error.to_string() })?;
    frames_among(folder, "folder", files)
}

/// The frames whose paths match a pattern.
fn matching(pattern: &Path) -> Result<Vec<PathBuf>, ImportError> {
    let text = pattern.to_string_lossy();
    let paths = glob::glob(&text).map_err(|error| {
        let place = format!("pattern, character {}", error.pos);
        ImportError::invalid(pattern, place, error.msg, "a pattern of *, ?, ** and [a-z]")
    })?;
    let paths = paths.collect::<Result<Vec<_>, _>>().map_err(|error| ImportError::Io {
        file: error.path().to_owned(),
        reason: error.error().to_string(),
    })?;
    let files = paths.into_iter().filter(|path| path.is_file()).collect();
    frames_among(pattern, "pattern", files)
}

/// The file at `path` and those beside it that differ in their number, if its number is the
/// smallest and there are others.
fn followers(path: &Path) -> Option<Vec<PathBuf>> {
    let name = path.file_name()?.to_str()?;
    let first = Numbered::new(name).filter(|_| is_frame(path) && path.is_file())?;
    let folder = path.parent().filter(|folder| *folder != Path::new(""));
    let others = list(folder.unwrap_or(Path::new("."))).ok()?;
    let mut frames = vec![path.to_owned()];
    for other in others {
        let other_name = other.file_name()?.to_str().unwrap_or_default();
        let Some(numbered) = Numbered::new(other_name) else { continue };
        if other_name == name || !numbered.belongs_to(&first) {
            continue;
        }
        if numbered.number < first.number {
            return None;
        }
        frames.push(path.with_file_name(other_name));
    }
    alphanumeric_sort::sort_path_slice(&mut frames);
    (frames.len() > 1).then_some(frames)
}

/// The files in a folder, hidden ones left out.
fn list(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(folder)?.collect::<std::io::Result<Vec<_>>>()?;
    let is_hidden =
        |path: &Path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
    let paths = entries.into_iter().map(|entry| entry.path());
    Ok(paths.filter(|path| !is_hidden(path) && path.is_file()).collect())
}

fn is_frame(path: &Path) -> bool {
    FRAME_EXTENSIONS.contains(&split_extension(path).0.as_str())
}

/// The files that can be frames, in natural order; an error unless all are of one format. Files
/// that are no meshes, such as `.mtl` and `.png`, may lie beside them.
fn frames_among(
    input: &Path,
    kind: &str,
    mut files: Vec<PathBuf>,
) -> Result<Vec<PathBuf>, ImportError> {
    let found = |files: &[PathBuf]| format!("{} files", listing(files));
    if !files.iter().any(|file| is_frame(file)) {
        let expected = format!("files .{}, or these with .gz", FRAME_EXTENSIONS.join(", ."));
        return Err(ImportError::invalid(input, kind, found(&files), expected));
    }
    files.retain(|file| is_frame(file));
    let formats = files.iter().map(|file| split_extension(file).0);
    if formats.clone().min() != formats.max() {
        let expected = "files of one format; a pattern such as '*.ply' chooses";
        return Err(ImportError::invalid(input, kind, found(&files), expected));
    }
    alphanumeric_sort::sort_path_slice(&mut files);
    Ok(files)
}

/// Kinds of files listed at most.
const LISTED_KINDS: usize = 8;

/// How many files there are of each extension: "3 .obj and 2 .ply".
fn listing(files: &[PathBuf]) -> String {
    let mut counts = BTreeMap::<String, usize>::new();
    for file in files {
        *counts.entry(split_extension(file).0).or_default() += 1;
    }
    let word = |(extension, count): (&String, &usize)| match extension.as_str() {
        "" => format!("{count} without extension"),
        _ => format!("{count} .{extension}"),
    };
    let words: Vec<String> = counts.iter().map(word).collect();
    match words.as_slice() {
        [] => "no".to_owned(),
        [last] => last.clone(),
        [all @ .., last] if all.len() < LISTED_KINDS => format!("{} and {last}", all.join(", ")),
        _ => format!("{} and other", words[..LISTED_KINDS].join(", ")),
    }
}
