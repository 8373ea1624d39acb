//! Scenes from files: the objects of a scene that a file moves.

use std::path::Path;
use std::sync::Arc;

use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayflock::geom::Aabb;
use rayflock::import::{ImportError, LoadOptions, NumberedFile, Reporter, load_with};
use rayflock::scene::{Evaluator, InBetweens, Scene, SceneFrame, builtin};

use crate::errors::Failure;

/// What stands before the name of a built-in scene.
const BUILTIN: &str = "builtin:";

/// A file, or a built-in scene, played clip by clip.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    evaluator: Evaluator,
    /// The frame that was evaluated last.
    frame: SceneFrame,
    /// The box around the whole motion, once somebody wanted it.
    bounds: Option<Aabb>,
    /// Frames that show everything once, where the scene is a built-in one.
    builtin_frame_count: Option<usize>,
}

impl Source {
    /// Opens a file, a sequence or a built-in scene, at time 0; with what is wrong with it.
    pub(crate) fn open(
        path: &Path,
        clip: Option<&str>,
        options: &LoadOptions,
    ) -> PyResult<(Self, Vec<String>)> {
        let name = path.to_str().and_then(|path| path.strip_prefix(BUILTIN));
        let (scene, builtin_frame_count, warnings) = match name {
            Some(name) => {
                let known = builtin::all().iter().find(|builtin| builtin.name == name);
                let built = builtin::build(name).zip(known).ok_or_else(|| unknown_builtin(name))?;
                (built.0, Some(built.1.frame_count), Vec::new())
            }
            None => {
                let mut reporter = Reporter::new();
                let scene = load_with(path, options, &mut reporter).map_err(to_exception)?;
                let warnings = reporter.warnings().iter().map(ToString::to_string);
                (scene, None, warnings.collect())
            }
        };
        let mut evaluator = Evaluator::new(Arc::new(scene), clip).map_err(Failure::from)?;
        let frame = evaluator.evaluate(0.0).map_err(Failure::from)?.clone();
        Ok((Self { evaluator, frame, bounds: None, builtin_frame_count }, warnings))
    }

    /// Goes to a time, in seconds.
    pub(crate) fn evaluate(&mut self, time: f64) -> Result<(), Failure> {
        self.frame = self.evaluator.evaluate(time)?.clone();
        Ok(())
    }

    /// A player of the same file, which goes to other times without this one.
    pub(crate) fn player(&self) -> Evaluator {
        self.evaluator.clone()
    }

    /// What the file describes.
    pub(crate) fn scene(&self) -> &Arc<Scene> {
        self.evaluator.scene()
    }

    /// The scene at the time that was evaluated last.
    pub(crate) const fn frame(&self) -> &SceneFrame {
        &self.frame
    }

    /// The box around everything over the whole motion.
    pub(crate) fn bounds(&mut self) -> Result<Aabb, Failure> {
        if let Some(bounds) = self.bounds {
            return Ok(bounds);
        }
        let bounds = self.evaluator.bounds_over_clip()?;
        self.bounds = Some(bounds);
        Ok(bounds)
    }

    /// Names and numbers about the file.
    pub(crate) fn about(&self) -> About {
        let scene = self.scene();
        let frame_rate = scene.default_frame_rate();
        let frames = || self.evaluator.frame_count(frame_rate);
        About {
            name: scene.name.clone(),
            objects: scene.objects.iter().map(|object| object.name.clone()).collect(),
            clips: scene.clips.iter().map(|clip| clip.name.clone()).collect(),
            cameras: scene.cameras.iter().map(|camera| camera.name.clone()).collect(),
            frame_rate,
            frame_count: self.builtin_frame_count.unwrap_or_else(frames),
            time: self.frame.time,
        }
    }
}

/// Names and numbers about a file.
pub(crate) struct About {
    name: String,
    objects: Vec<String>,
    clips: Vec<String>,
    cameras: Vec<String>,
    frame_rate: f64,
    frame_count: usize,
    time: f64,
}

impl About {
    /// The same, under the names of the fields of the Python class `Source`.
    pub(crate) fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        dict.set_item("name", &self.name)?;
        dict.set_item("objects", &self.objects)?;
        dict.set_item("clips", &self.clips)?;
        dict.set_item("cameras", &self.cameras)?;
        dict.set_item("frame_rate", self.frame_rate)?;
        dict.set_item("frame_count", self.frame_count)?;
        dict.set_item("time", self.time)?;
        Ok(dict)
    }
}

/// How a file is to be taken: a dictionary with an item for each of these names.
pub(crate) fn load_options(given: &Bound<'_, PyDict>) -> PyResult<LoadOptions> {
    let item = |name| given.as_any().get_item(name);
    let up: String = item("up")?.extract()?;
    let interpolate: bool = item("interpolate")?.extract()?;
    Ok(LoadOptions {
        up_axis: up.parse().map_err(|error| Failure::value(format!("up: {error}")))?,
        detail: item("detail")?.extract()?,
        numbered_file: NumberedFile::FirstFrame,
        frame_rate: item("frame_rate")?.extract()?,
        in_betweens: if interpolate { InBetweens::Linear } else { InBetweens::Held },
    })
}

fn unknown_builtin(name: &str) -> Failure {
    let names: Vec<_> = builtin::all().iter().map(|builtin| builtin.name).collect();
    let names = names.join(", ");
    Failure::value(format!("no built-in scene is called \"{name}\"; there are: {names}"))
}

fn to_exception(error: ImportError) -> PyErr {
    let message = error.to_string();
    match error {
        ImportError::Io { file, .. } if !file.exists() => PyFileNotFoundError::new_err(message),
        ImportError::Io { .. } => PyOSError::new_err(message),
        _ => PyValueError::new_err(message),
    }
}
