//! Where a scene comes from: a file or `builtin:NAME`.

use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::time::UNIX_EPOCH;

use anyhow::{Context, Result, bail, ensure};
use rayflock::import::{self, LoadOptions, Reporter};
use rayflock::scene::builtin::{self, Builtin};
use rayflock::scene::{Clip, Scene};

use crate::args::InputArguments;

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
    /// Size, time and options of the file, to notice that it has changed; empty for built-in scenes.
    pub(crate) revision: String,
    /// Length of the motion in seconds, where the source has one of its own besides clips.
    own_duration: Option<f64>,
}

impl Input {
    /// Reads the scene that INPUT names.
    pub(crate) fn open(args: &InputArguments) -> Result<Self> {
        match args.name.strip_prefix(BUILTIN) {
            Some(builtin) => Self::builtin(&args.name, builtin),
            None => Self::file(&args.name, &LoadOptions { up_axis: args.up, detail: args.detail }),
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

    fn file(name: &str, options: &LoadOptions) -> Result<Self> {
        let path = Path::new(name);
        let is_pattern = name.contains(['*', '?']) && !path.exists();
        ensure!(
            !path.is_dir() && !is_pattern,
            "{name}: found a folder or a pattern, expected one file or {BUILTIN}NAME; sequences \
             of files cannot be read yet"
        );
        let metadata = fs::metadata(path).with_context(|| format!("cannot read {name}"))?;
        let mut reporter = Reporter::new();
        let scene = Arc::new(import::load_with(path, options, &mut reporter)?);
        let warnings = reporter.warnings().iter().map(ToString::to_string).collect();
        let modified =
            metadata.modified().ok().and_then(|time| time.duration_since(UNIX_EPOCH).ok());
        let age = modified.unwrap_or_default().as_nanos();
        let detail = options.detail.map_or_else(String::new, |level| format!(", detail {level}"));
        let revision =
            format!("{} bytes, {age} ns, {} up{detail}", metadata.len(), options.up_axis);
        Ok(Self { name: name.to_owned(), scene, warnings, revision, own_duration: None })
    }

    /// Number of frames that show the whole motion once: all frames of a finite source, one loop
    /// of a clip, one frame of a scene where nothing moves.
    ///
    /// A loop of `duration` seconds has `duration * fps` frames: the frame after the last is the
    /// first again.
    pub(crate) fn whole_motion(&self, clip: Option<&Clip>, fps: f64) -> u32 {
        if let Some(count) = self.scene.frame_count {
            return u32::try_from(count).unwrap_or(u32::MAX);
        }
        let duration = self.own_duration.or_else(|| clip.map(Clip::duration)).unwrap_or(0.0);
        ((duration * fps).round() as u32).max(1)
    }
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

    fn open(name: &str) -> Result<Input> {
        Input::open(&InputArguments { name: name.to_owned(), up: UpAxis::Y, detail: None })
    }

    #[test]
    fn an_unknown_built_in_scene_is_told_which_there_are() {
        let message = open("builtin:teapot").unwrap_err().to_string();
        assert!(message.contains("\"teapot\"") && message.contains("builtin:cornell"), "{message}");
    }

    #[test]
    fn a_built_in_scene_runs_through_once() {
        let input = open("builtin:cornell").unwrap();
        let rate = input.scene.default_frame_rate();
        assert!(input.whole_motion(None, rate) >= 240);
        assert_eq!(input.whole_motion(None, rate / 2.0), input.whole_motion(None, rate) / 2);
    }

    #[test]
    fn folders_and_patterns_are_named_as_such() {
        let folder = tempfile::tempdir().unwrap();
        for name in [folder.path().to_str().unwrap(), "frames/*.obj"] {
            let message = open(name).unwrap_err().to_string();
            assert!(message.contains("sequences of files"), "{message}");
        }
    }
}
