//! The class `Scene`: what can be hit, and questions about it.

use std::path::Path;
use std::sync::Mutex;

use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayflock::engine::list_hits;

use crate::answer::Answer;
use crate::arrays::{numbers, numbers_mut, readable, rows, writable};
use crate::errors::Failure;
use crate::hit_arrays::hit_arrays;
use crate::meshes;
use crate::picture::{PictureSettings, render};
use crate::question::Question;
use crate::sense::{SenseQuestion, sense};
use crate::sensor_options::SensorOptions;
use crate::source::{Source, load_options};
use crate::stats::SceneStats;
use crate::sweep_arrays::sweep_arrays;
use crate::world::{Owner, World};

/// Objects that rays can hit, each of which may change at any time. Arrays are float32 and uint32,
/// C-contiguous; the Python class of the same name sees to that.
#[pyclass(frozen, module = "rayflock._native")]
#[derive(Debug)]
pub(crate) struct Scene {
    world: Mutex<World>,
}

impl Scene {
    /// Does something with the world of the scene, without the interpreter lock.
    fn with_world<T: Send>(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut World) -> Result<T, Failure> + Send,
    ) -> PyResult<T> {
        let done = py.detach(|| {
            let mut world = self.world.lock().unwrap_or_else(|poisoned| {
                let mut world = poisoned.into_inner();
                world.forget_engines();
                self.world.clear_poison();
                world
            });
            work(&mut world)
        });
        Ok(done?)
    }
}

#[pymethods]
impl Scene {
    #[new]
    fn new(engine: &str, threads: usize) -> PyResult<Self> {
        let engine = engine.parse().map_err(Failure::from)?;
        Ok(Self { world: Mutex::new(World::new(engine, threads)) })
    }

    fn copy(&self, py: Python<'_>) -> PyResult<Self> {
        let world = self.with_world(py, |world| Ok(world.copy()))?;
        Ok(Self { world: Mutex::new(world) })
    }

    fn add_mesh(
        &self,
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        triangles: &Bound<'_, PyAny>,
        mask: u32,
        is_static: bool,
    ) -> PyResult<u32> {
        let vertices = readable(vertices, "vertices")?;
        let triangles = readable(triangles, "triangles")?;
        let (vertices, triangles) = (rows(&vertices)?, rows(&triangles)?);
        self.with_world(py, |world| {
            Ok(world.add(meshes::triangles(vertices, triangles)?, mask, owner(is_static)))
        })
    }

    fn update_mesh(
        &self,
        py: Python<'_>,
        id: u32,
        vertices: &Bound<'_, PyAny>,
        triangles: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let vertices = readable(vertices, "vertices")?;
        let vertices = rows(&vertices)?;
        let triangles = triangles.map(|given| readable(given, "triangles")).transpose()?;
        let triangles = triangles.as_ref().map(rows).transpose()?;
        self.with_world(py, |world| {
            let before = world.mesh_to_change(id)?;
            world.replace(id, meshes::changed_triangles(&before, vertices, triangles)?)
        })
    }

    fn add_spheres(
        &self,
        py: Python<'_>,
        centers: &Bound<'_, PyAny>,
        radii: &Bound<'_, PyAny>,
        mask: u32,
        is_static: bool,
    ) -> PyResult<u32> {
        let (centers, radii) = (readable(centers, "centers")?, readable(radii, "radii")?);
        let (centers, radii) = (rows(&centers)?, numbers(&radii)?);
        self.with_world(py, |world| {
            Ok(world.add(meshes::spheres(centers, radii)?, mask, owner(is_static)))
        })
    }

    fn update_spheres(
        &self,
        py: Python<'_>,
        id: u32,
        centers: &Bound<'_, PyAny>,
        radii: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let centers = readable(centers, "centers")?;
        let centers = rows(&centers)?;
        let radii = radii.map(|given| readable(given, "radii")).transpose()?;
        let radii = radii.as_ref().map(numbers).transpose()?;
        self.with_world(py, |world| {
            let before = world.mesh_to_change(id)?;
            world.replace(id, meshes::changed_spheres(&before, centers, radii)?)
        })
    }

    fn remove(&self, py: Python<'_>, id: u32) -> PyResult<()> {
        self.with_world(py, |world| world.remove(id))
    }

    /// Reads a file into a scene without objects; returns what is wrong with it, but bearable.
    fn load(
        &self,
        py: Python<'_>,
        path: &str,
        clip: Option<&str>,
        options: &Bound<'_, PyDict>,
    ) -> PyResult<Vec<String>> {
        let options = load_options(options)?;
        let (source, warnings) = py.detach(|| Source::open(Path::new(path), clip, &options))?;
        self.with_world(py, |world| world.load(source))?;
        Ok(warnings)
    }

    fn evaluate(&self, py: Python<'_>, time: f64) -> PyResult<()> {
        self.with_world(py, |world| world.evaluate(time))
    }

    fn source<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let about = self.with_world(py, |world| Ok(world.source().map(Source::about)))?;
        about.map(|about| about.to_dict(py)).transpose()
    }

    fn render<'py>(
        &self,
        py: Python<'py>,
        settings: &Bound<'py, PyDict>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let settings = PictureSettings::new(settings)?;
        let pixels = self.with_world(py, |world| render(world, &settings))?;
        Ok(pixels.into_array(py))
    }

    fn sense<'py>(
        &self,
        py: Python<'py>,
        sensor: &Bound<'py, PyDict>,
        start: Option<f64>,
        engine: Option<&str>,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let sensor = SensorOptions::new(sensor)?;
        let engine = engine.map(str::parse).transpose().map_err(Failure::from)?;
        let question = SenseQuestion { sensor, start, engine, threads };
        let sweep = self.with_world(py, |world| sense(world, &question))?;
        sweep_arrays(py, sweep)
    }

    fn ids(&self, py: Python<'_>) -> PyResult<Vec<u32>> {
        self.with_world(py, |world| Ok(world.objects().map(|found| found.object.id.0).collect()))
    }

    fn closest_hit(
        &self,
        py: Python<'_>,
        question: &Bound<'_, PyDict>,
        answer: &Bound<'_, PyDict>,
    ) -> PyResult<()> {
        let question = Question::new(question)?;
        let (rays, engine, threads) = (question.batch()?, question.engine()?, question.threads());
        let mut answer = Answer::new(answer)?;
        let mut columns = answer.columns(rays.len())?;
        self.with_world(py, |world| {
            world.ask(engine, threads, |engine, geometry| {
                columns.clear();
                let stats = engine.closest_hit(&rays, &mut columns.hits);
                columns.write_normals(geometry, &rays);
                Ok(((), stats))
            })
        })
    }

    fn occluded(
        &self,
        py: Python<'_>,
        question: &Bound<'_, PyDict>,
        occluded: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let question = Question::new(question)?;
        let (rays, engine, threads) = (question.batch()?, question.engine()?, question.threads());
        let mut occluded = writable(occluded, "out")?;
        let occluded: &mut [bool] = numbers_mut(&mut occluded)?;
        check_len(occluded.len(), rays.len())?;
        self.with_world(py, |world| {
            world.ask(engine, threads, |engine, _| Ok(((), engine.occluded(&rays, occluded))))
        })
    }

    fn count_hits(
        &self,
        py: Python<'_>,
        question: &Bound<'_, PyDict>,
        counts: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let question = Question::new(question)?;
        let (rays, engine, threads) = (question.batch()?, question.engine()?, question.threads());
        let mut counts = writable(counts, "out")?;
        let counts: &mut [i32] = numbers_mut(&mut counts)?;
        check_len(counts.len(), rays.len())?;
        self.with_world(py, |world| {
            world.ask(engine, threads, |engine, geometry| {
                let (list, stats) = list_hits(engine, geometry, &rays)?;
                for (count, split) in counts.iter_mut().zip(list.splits.windows(2)) {
                    *count = i32::try_from(split[1] - split[0]).unwrap_or(i32::MAX);
                }
                Ok(((), stats))
            })
        })
    }

    fn list_hits<'py>(
        &self,
        py: Python<'py>,
        question: &Bound<'_, PyDict>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let question = Question::new(question)?;
        let (rays, engine, threads) = (question.batch()?, question.engine()?, question.threads());
        let list = self.with_world(py, |world| {
            world.ask(engine, threads, |engine, geometry| list_hits(engine, geometry, &rays))
        })?;
        hit_arrays(py, list)
    }

    fn stats<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.with_world(py, SceneStats::of)?.to_dict(py)
    }
}

const fn owner(is_static: bool) -> Owner {
    if is_static { Owner::Nobody } else { Owner::Caller }
}

fn check_len(found: usize, expected: usize) -> Result<(), Failure> {
    if found == expected {
        return Ok(());
    }
    Err(Failure::value(format!("the array of answers has {found} rows, there are {expected} rays")))
}
