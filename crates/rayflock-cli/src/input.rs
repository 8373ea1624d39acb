//! Where a scene comes from: a file, a sequence of files or `builtin:NAME`.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::UNIX_EPOCH;

use anyhow::{Context, Result, bail};
use rayflock::import::{self, LoadOptions, NumberedFile, Reporter};
use rayflock::scene::builtin::{self, Builtin};
use rayflock::scene::{Clip, Evaluator, InBetweens, Scene};

use crate::args::{InputArguments, MotionArguments};

/// What stands before the name of a built-in scene.
const BUILTIN: &str = "builtin:";

/// A scene and what is known about its source.
#[derive(Debug)]
pub(crate) struct Input {
    /// INPUT as given.
    pub(crate) name: String,
    /// The scene.
    pub(crate) scene: Arc<Scene>,
    /// What is wrong with the file without making it useless, for the user.
    pub(crate) warnings: Vec<String>,
    /// Size and time of the files and how they are taken, to notice that they have changed; empty
    /// for built-in scenes.
    pub(crate) revision: String,
    /// Length of the motion in seconds, where the source has one of its own besides clips.
    own_duration: Option<f64>,
}

impl Input {
    /// Reads the scene that INPUT names.
    pub(crate) fn open(args: &InputArguments) -> Result<Self> {
        Self::open_at(args, None)
    }

    /// Reads the scene that INPUT names and chooses its clip; tells how many frames there are a
    /// second as well.
    pub(crate) fn open_moving(
        args: &InputArguments,
        motion: &MotionArguments,
    ) -> Result<(Self, Evaluator, f64)> {
        let input = Self::open_at(args, motion.fps)?;
        let evaluator = Evaluator::new(input.scene.clone(), motion.clip.as_deref())?;
        let fps = motion.fps.unwrap_or_else(|| input.scene.default_frame_rate());
        Ok((input, evaluator, fps))
    }

    /// Reads the scene that INPUT names. Sources that are frames by nature are shown at this many a
    /// second, where one is asked for.
    fn open_at(args: &InputArguments, fps: Option<f64>) -> Result<Self> {
        match args.name.strip_prefix(BUILTIN) {
            Some(builtin) => Self::builtin(&args.name, builtin),
            None => Self::files(args, fps),
        }
    }

    fn builtin(name: &str, builtin_name: &str) -> Result<Self> {
        let known = builtin::all().iter().find(|builtin| builtin.name == builtin_name);
        let Some((known, scene)) = known.zip(builtin::build(builtin_name)) else {
            bail!("no built-in scene is called \"{builtin_name}\"; there are:{}", builtin_list());
        };
        let own_duration = Some(known.frame_count as f64 / scene.default_frame_rate());
        let scene = Arc::new(scene);
        let (warnings, revision) = (Vec::new(), String::new());
        Ok(Self { name: name.to_owned(), scene, warnings, revision, own_duration })
    }

    fn files(args: &InputArguments, fps: Option<f64>) -> Result<Self> {
        let options = LoadOptions {
            up_axis: args.up,
            detail: args.detail,
            numbered_file: NumberedFile::FirstFrame,
            // Frames in between need a rate that is not that of the pictures.
            frame_rate: fps.filter(|_| !args.interpolate),
            in_betweens: if args.interpolate { InBetweens::Linear } else { InBetweens::Held },
        };
        let path = Path::new(&args.name);
        let revision = revision(&import::source_files(path, &options)?, args)?;
        let mut reporter = Reporter::new();
        let scene = Arc::new(import::load_with(path, &options, &mut reporter)?);
        let warnings = reporter.warnings().iter().map(ToString::to_string).collect();
        Ok(Self { name: args.name.clone(), scene, warnings, revision, own_duration: None })
    }

    /// Number of frames that show the whole motion once: all frames of a finite source, one loop
    /// of a clip, one frame of a scene where nothing moves.
    ///
    /// A loop of `duration` seconds has `duration * fps` frames: the frame after the last is the
    /// first again.
    pub(crate) fn whole_motion(&self, clip: Option<&Clip>, fps: f64) -> u32 {
        if let Some(count) = self.scene.frame_count {
            let steps = count.saturating_sub(1) as f64 * fps / self.scene.default_frame_rate();
            // The last frame counts, however its time is rounded.
            return ((steps + 1e-3) as u32).saturating_add(1);
        }
        let duration = self.own_duration.or_else(|| clip.map(Clip::duration)).unwrap_or(0.0);
        ((duration * fps).round() as u32).max(1)
    }
}

/// Size and latest change of all files, and what else decides how they are read.
fn revision(files: &[PathBuf], args: &InputArguments) -> Result<String> {
    let (mut size, mut latest) = (0, 0);
    for file in files {
        let metadata =
            fs::metadata(file).with_context(|| format!("cannot read {}", file.display()))?;
        let modified =
            metadata.modified().ok().and_then(|time| time.duration_since(UNIX_EPOCH).ok());
        size += metadata.len();
        latest = latest.max(modified.unwrap_or_default().as_nanos());
    }
    let InputArguments { up, interpolate, detail, .. } = args;
    let detail = detail.map_or_else(String::new, |level| format!(", detail {level}"));
    let (count, taken) = (files.len(), format!("{up} up, interpolate {interpolate}{detail}"));
    Ok(format!("{size} bytes in {count} files, {latest} ns, {taken}"))
}

/// The built-in scenes, one a line.
fn builtin_list() -> String {
    let line = |builtin: &Builtin| format!("\n  {BUILTIN}{:10} {}", builtin.name, builtin.about);
    builtin::all().iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use rayflock::import::UpAxis;

    use super::*;

    fn arguments(name: &str, interpolate: bool) -> InputArguments {
        InputArguments { name: name.to_owned(), up: UpAxis::Y, detail: None, interpolate }
    }

    fn open(name: &str) -> Result<Input> {
        Input::open(&arguments(name, false))
    }

    #[test]
    fn an_unknown_built_in_scene_is_told_which_there_are() {
        let message = open("builtin:kettle").unwrap_err().to_string();
        assert!(message.contains("\"kettle\"") && message.contains("builtin:cornell"), "{message}");
    }

    #[test]
    fn a_built_in_scene_runs_through_once() {
        let input = open("builtin:cornell").unwrap();
        let rate = input.scene.default_frame_rate();
        assert!(input.whole_motion(None, rate) >= 240);
        assert_eq!(input.whole_motion(None, rate / 2.0), input.whole_motion(None, rate) / 2);
    }

    #[test]
    fn a_sequence_has_a_picture_a_file_unless_it_is_interpolated() {
        let folder = tempfile::tempdir().unwrap();
        for number in 1..=5 {
            let name = folder.path().join(format!("a{number}.obj"));
            fs::write(name, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        }
        let folder = folder.path().to_str().unwrap();
        let count = |interpolate, fps| {
            let input = Input::open_at(&arguments(folder, interpolate), fps).unwrap();
            input.whole_motion(None, fps.unwrap_or(24.0))
        };
        assert_eq!([count(false, None), count(false, Some(60.0))], [5, 5]);
        let interpolated = [None, Some(48.0), Some(60.0), Some(6.0)].map(|fps| count(true, fps));
        assert_eq!(interpolated, [5, 9, 11, 2]);
    }

    #[test]
    fn a_file_that_changes_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let name = folder.path().join("a.obj");
        let revision = |text: &str| {
            fs::write(&name, text).unwrap();
            open(name.to_str().unwrap()).unwrap().revision
        };
        assert_ne!(revision("v 0 0 0\n"), revision("v 0 0 0\nv 1 1 1\n"));
    }
}
