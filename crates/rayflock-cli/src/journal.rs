//! The journal of a render: which frames are finished, and with which settings.
//!
//! A text file beside the frames: a line with the settings, then a line a finished frame, written
//! after the frame's file has its name. A run that is killed leaves at most a torn last line,
//! which is ignored, so `--resume` trusts exactly the frames that are whole. The lines hold the
//! statistics of their frames, so those of a resumed render are complete, too.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::failure::{Blame, Failure};
use crate::output::{FrameNames, atomic};
use crate::stats::FrameRecord;

/// Everything that decides what a frame looks like and what it costs, by the name of its option.
pub(crate) type Settings = BTreeMap<String, String>;

/// Finished frames and where they are noted.
#[derive(Debug)]
pub(crate) struct Journal {
    finished: BTreeMap<u32, FrameRecord>,
    /// `None` for a single picture, which is never resumed.
    file: Option<(PathBuf, File)>,
}

impl Journal {
    /// Opens the journal of the frames called `names`: empty, or with `resume` as a render with
    /// the same settings left it.
    pub(crate) fn open(
        names: &FrameNames,
        settings: &Settings,
        resume: bool,
    ) -> Result<Self, Failure> {
        let Some(path) = journal_path(names) else {
            return Ok(Self { finished: BTreeMap::new(), file: None });
        };
        let mut finished = BTreeMap::new();
        if resume {
            finished = read(&path, settings).blame_input()?;
            finished.retain(|&frame, _| names.path(frame).is_file());
        }
        let file = start(&path, settings, &finished).blame_output()?;
        Ok(Self { finished, file: Some((path, file)) })
    }

    /// What frame `frame` cost, if it is finished.
    pub(crate) fn get(&self, frame: u32) -> Option<&FrameRecord> {
        self.finished.get(&frame)
    }

    /// Notes that a frame's file is whole.
    pub(crate) fn add(&mut self, record: FrameRecord) -> Result<()> {
        if let Some((path, file)) = &mut self.file {
            let line = serde_json::to_string(&record)? + "\n";
            let written = file.write_all(line.as_bytes());
            written.with_context(|| format!("cannot write {}", path.display()))?;
        }
        self.finished.insert(record.frame, record);
        Ok(())
    }
}

/// `.frame_%04d.png.rayflock` in the folder of the frames.
fn journal_path(names: &FrameNames) -> Option<PathBuf> {
    let FrameNames::Numbered { .. } = names else { return None };
    let pattern = names.pattern();
    let name = pattern.file_name()?.to_string_lossy();
    Some(pattern.with_file_name(format!(".{name}.rayflock")))
}

/// The finished frames of a journal; none when there is no journal.
fn read(path: &Path, settings: &Settings) -> Result<BTreeMap<u32, FrameRecord>> {
    let text = match fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(BTreeMap::new()),
        Err(error) => return Err(error).with_context(|| format!("cannot read {}", path.display())),
    };
    let mut lines = text.lines();
    let header = lines.next().unwrap_or_default();
    let Ok(found) = serde_json::from_str::<Settings>(header) else {
        bail!("cannot resume: {} is not the journal of a render", path.display());
    };
    ensure_same(&found, settings)?;
    let records = lines.map_while(|line| serde_json::from_str::<FrameRecord>(line).ok());
    Ok(records.map(|record| (record.frame, record)).collect())
}

/// Refuses to mix frames of different settings, naming the first difference.
fn ensure_same(found: &Settings, settings: &Settings) -> Result<()> {
    for name in found.keys().chain(settings.keys()) {
        let [was, is] = [found, settings].map(|settings| settings.get(name).map_or("", |v| v));
        if was != is {
            bail!(
                "cannot resume: the frames that are there were rendered with {name} \"{was}\", \
                 now it is \"{is}\"; give the same, or leave out --resume to start anew"
            );
        }
    }
    Ok(())
}

/// Writes the journal anew, without torn lines and frames that are gone, and opens it for more.
fn start(path: &Path, settings: &Settings, finished: &BTreeMap<u32, FrameRecord>) -> Result<File> {
    let mut text = serde_json::to_string(settings)? + "\n";
    for record in finished.values() {
        text += &serde_json::to_string(record)?;
        text.push('\n');
    }
    atomic::write_whole(path, |partial| Ok(fs::write(partial, text)?))?;
    let file = OpenOptions::new().append(true).open(path);
    file.with_context(|| format!("cannot write {}", path.display()))
}
