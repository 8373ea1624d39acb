//! Sensors as Python describes them: dictionaries, of which those of the library are made.

use glam::{Mat3, Quat, Vec3};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayflock::engine::{EngineKind, create};
use rayflock::render::sensor::{
    DropOut, Pose, PoseKey, PosePath, RangeNoise, Scanner, Sensor, SensorSettings, Surroundings,
};
use rayflock::scene::{Projection, frame_bounds};

use crate::errors::Failure;
use crate::sensor_pattern::PatternOptions;
use crate::world::World;

/// What a sensor is: a dictionary with an item for each field of the three.
#[derive(Clone, Debug)]
pub(crate) struct SensorOptions {
    pattern: PatternOptions,
    place: PlaceOptions,
    echoes: EchoOptions,
}

/// Where a sensor is.
#[derive(Clone, Debug, FromPyObject)]
#[pyo3(from_item_all)]
struct PlaceOptions {
    /// Along these, or at the only one.
    poses: Vec<KeyOptions>,
    /// Without poses: on the camera of this name, or on the first, or where all is seen.
    camera: Option<String>,
}

/// A pose at a time: the time, the place, where it looks to, or else its rotation row by row.
#[derive(Clone, Debug, FromPyObject)]
struct KeyOptions(f64, [f32; 3], Option<[f32; 3]>, Option<[f32; 9]>);

/// What a sensor sees. What is `None` is as by default.
#[derive(Clone, Debug, FromPyObject)]
#[pyo3(from_item_all)]
struct EchoOptions {
    time_steps: Option<u32>,
    min_range: Option<f32>,
    max_range: Option<f32>,
    noise: Option<f32>,
    noise_per_range: Option<f32>,
    drop_out: Option<f32>,
    drop_out_grazing: Option<f32>,
    drop_out_far: Option<f32>,
    min_intensity: Option<f32>,
    returns: Option<String>,
    dust: Option<f32>,
    panes: Option<u32>,
    seed: Option<u64>,
}

impl SensorOptions {
    /// Takes the dictionary that Python hands over.
    pub(crate) fn new(given: &Bound<'_, PyDict>) -> PyResult<Self> {
        let (pattern, place, echoes) = (given.extract()?, given.extract()?, given.extract()?);
        Ok(Self { pattern, place, echoes })
    }

    /// The sensor in a world.
    pub(crate) fn in_world(&self, world: &mut World) -> Result<Sensor, Failure> {
        let path = match self.place.path() {
            Some(path) => path,
            None => self.place.on_camera(world)?,
        };
        let vertical_fov = match path {
            PosePath::Camera(idx) => vertical_fov(world, idx),
            PosePath::Fixed(_) | PosePath::Keyed(_) => None,
        };
        let (preset, changes) = (&self.pattern.preset, self.pattern.changes()?);
        let wants_diagonal = changes.wants_diagonal(preset);
        let diagonal = if wants_diagonal { world.bounds()?.size().length() } else { 0.0 };
        let pattern = changes.pattern(preset, &Surroundings { vertical_fov, diagonal })?;
        Ok(Sensor { pattern, path, settings: self.echoes.settings()? })
    }

    /// The sensor as far as it does not depend on a world.
    fn anywhere(&self) -> Result<Sensor, Failure> {
        let path = self.place.path().unwrap_or(PosePath::Fixed(Pose::at(Vec3::ZERO)));
        let changes = self.pattern.changes()?;
        let pattern = changes.pattern(&self.pattern.preset, &Surroundings::default())?;
        Ok(Sensor { pattern, path, settings: self.echoes.settings()? })
    }
}

/// The angle of view up of a camera of the file.
fn vertical_fov(world: &World, camera_idx: usize) -> Option<f32> {
    match world.source()?.scene().cameras.get(camera_idx)?.projection {
        Projection::Perspective { vertical_fov } => Some(vertical_fov),
        Projection::Orthographic { .. } => None,
    }
}

impl PlaceOptions {
    /// The poses; `None` where the sensor is on a camera.
    fn path(&self) -> Option<PosePath> {
        let keys = self.poses.iter().map(KeyOptions::key).collect();
        (!self.poses.is_empty()).then_some(PosePath::Keyed(keys))
    }

    fn on_camera(&self, world: &mut World) -> Result<PosePath, Failure> {
        if let Some(idx) = world.camera_idx(self.camera.as_deref())? {
            return Ok(PosePath::Camera(idx));
        }
        // Any aspect will do: a sensor need not see everything.
        let (world_from_camera, _) = frame_bounds(&world.bounds()?, 1.0);
        Ok(PosePath::Fixed(Pose::from_transform(&world_from_camera)))
    }
}

impl KeyOptions {
    fn key(&self) -> PoseKey {
        let Self(time, at, look_at, rows) = self;
        let position = Vec3::from(*at);
        let pose = match (look_at, rows) {
            (Some(target), _) => Pose::looking_at(position, (*target).into()),
            (None, Some(rows)) => {
                let rotation = Mat3::from_cols_array(rows).transpose();
                Pose { position, rotation: Quat::from_mat3(&rotation).normalize() }
            }
            (None, None) => Pose::at(position),
        };
        PoseKey { time: *time, pose }
    }
}

impl EchoOptions {
    fn settings(&self) -> Result<SensorSettings, Failure> {
        let default = SensorSettings::default();
        Ok(SensorSettings {
            min_range: self.min_range.unwrap_or(default.min_range),
            max_range: self.max_range.unwrap_or(default.max_range),
            noise: RangeNoise {
                constant: self.noise.unwrap_or(default.noise.constant),
                proportional: self.noise_per_range.unwrap_or(default.noise.proportional),
            },
            drop_out: DropOut {
                constant: self.drop_out.unwrap_or(default.drop_out.constant),
                grazing: self.drop_out_grazing.unwrap_or(default.drop_out.grazing),
                far: self.drop_out_far.unwrap_or(default.drop_out.far),
            },
            min_intensity: self.min_intensity.unwrap_or(default.min_intensity),
            returns: self.returns.as_deref().map_or(Ok(default.returns), str::parse)?,
            dust: self.dust.unwrap_or(default.dust),
            panes: self.panes.unwrap_or(default.panes),
            seed: self.seed.unwrap_or(default.seed),
            time_steps: self.time_steps,
        })
    }
}

/// Checks a sensor as far as it does not depend on a scene, and tells what is known about it, under
/// the names of the attributes of the Python class `Sensor`.
#[pyfunction]
pub(crate) fn describe_sensor<'py>(
    py: Python<'py>,
    options: &Bound<'py, PyDict>,
) -> PyResult<Bound<'py, PyDict>> {
    let options = SensorOptions::new(options)?;
    let scanner = py.detach(|| {
        // Any engine: it is not asked.
        let engine = create(EngineKind::Brute);
        options.anywhere().and_then(|sensor| Ok(Scanner::new(engine, sensor)?))
    })?;
    let pattern = &scanner.sensor().pattern;
    let dict = PyDict::new(py);
    dict.set_item("rate", pattern.rate())?;
    dict.set_item("beam_count", scanner.beam_count())?;
    dict.set_item("time_steps", scanner.step_count())?;
    dict.set_item("shape", pattern.is_picture().then(|| pattern.shape()))?;
    Ok(dict)
}
