//! LiDAR and depth sensors in scenes that move while they look.
//!
//! | Part | Use it when |
//! |---|---|
//! | [`Pattern`] | you say where beams go and when: spinning, raster, rosette, depth camera, orthographic |
//! | [`PatternOptions`] | you change a preset by what a user says |
//! | [`PosePath`] | you say where the sensor is: at rest, along keys, or on a camera of the scene |
//! | [`SensorSettings`] | you say what it sees: ranges, noise, drop-outs, returns |
//! | [`Sensor`] | all three together, as data |
//! | [`Scanner`] | you sweep with it, through any engine |
//! | [`Sweep`] | you read what came back, as columns |
//!
//! # Rolling time
//!
//! A sweep takes time, and the scene and the sensor move in it. Beams that fire together are a
//! *line* (a column of a spinning sensor, a row of a raster), and lines are cut into time steps:
//! one a line, unless [`SensorSettings::time_steps`] asks for fewer. For each step the scene is
//! evaluated at the time in the middle between its first and its last line, committed, and the
//! beams of the step are traced as one batch that shares its origin, or its direction.
//!
//! # What comes back
//!
//! With `r` the range, `a` the angle between beam and normal, `k` the luminance of the material's
//! diffuse colour at the point, and `T` the shares of light that panes before it let through, an
//! echo has the intensity
//!
//! ```text
//! k cos(a) / r^2 * T_1^2 * T_2^2 ...
//! ```
//!
//! so 1 is a white, matte surface that faces the sensor at one scene unit. Where a material lets
//! light through, the beam goes on straight behind it, up to [`SensorSettings::panes`] times; such
//! a surface scatters at least [`SensorSettings::dust`], or sensors would not see glass at all.
//! Echoes are lost outside the ranges, below the least intensity, and by chance ([`DropOut`]);
//! [`Returns`] says which of the others are told.
//!
//! Normals are those of facets. The sensor's frame is that of a camera: it looks along its -Z,
//! with +Y up and +X to the right.
//!
//! **Source**: the LiDAR equation for targets that fill the beam: P. McManamon, *Review of ladar*,
//! Optical Engineering 51(6), 2012, section 3. Patterns name their sources.
//!
//! **Departures**: a beam is a ray without width; light neither bends nor slows down in glass, nor
//! is it absorbed on the way; mirrors end a beam. Colours of the visible stand for the
//! reflectance at the sensor's wavelength.
//!
//! **Invariants**: a sweep depends on its start, the scene and the sensor alone: not on the engine,
//! the number of threads, or earlier sweeps. Without noise every point lies on the surface as it
//! is at the time of the point.
//!
//! **Cost**: one evaluation, one commit and one batch a time step, and a batch more for each pane
//! in a row; about 100 bytes a beam of the largest step, and 76 a point.
//!
//! # Example
//!
//! ```
//! use std::sync::Arc;
//!
//! use rayflock_engine::{EngineKind, create};
//! use rayflock_render::sensor::{Pattern, Pose, PosePath, Scanner, Sensor, Sweep};
//! use rayflock_scene::{Evaluator, builtin};
//!
//! let scene = builtin::build("crowd").ok_or("no such scene")?;
//! let mut evaluator = Evaluator::new(Arc::new(scene), None)?;
//! let pose = Pose::at(glam::Vec3::new(2.0, 1.4, 0.6));
//! let mut sensor = Sensor::new("spinning:16".parse::<Pattern>()?, PosePath::Fixed(pose));
//! sensor.settings.time_steps = Some(8);
//! let mut scanner = Scanner::new(create(EngineKind::Auto), sensor)?;
//! let mut sweep = Sweep::default();
//! scanner.sweep(&mut evaluator, 0.0, &mut sweep)?;
//! assert!(sweep.len() > 1000 && sweep.time.iter().all(|time| (0.0..0.1).contains(time)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod beams;
mod draws;
mod error;
mod layout;
mod pattern;
mod pose;
mod returns;
mod scanner;
mod settings;
mod sweep;
mod trace_beams;

pub use error::SensorError;
pub use pattern::{
    DepthCamera, Elevations, FieldOfView, OrthographicScanner, Pattern, PatternOptions, Raster,
    Rosette, Shutter, Spinning, Surroundings, evenly,
};
pub use pose::{Pose, PoseKey, PosePath};
pub use returns::Returns;
pub use scanner::{Scanner, StepStats};
pub use settings::{DropOut, RangeNoise, Sensor, SensorSettings};
pub use sweep::{StepPose, Sweep};
