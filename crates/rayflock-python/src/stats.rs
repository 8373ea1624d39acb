//! What a scene tells about itself: a dictionary, of which Python makes its `Stats`.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayflock::engine::Ignored;

use crate::errors::Failure;
use crate::world::{Asked, Member, World};

/// Numbers about a scene and what it was asked last.
pub(crate) struct SceneStats {
    objects: usize,
    triangles: usize,
    spheres: usize,
    engine: &'static str,
    memory: usize,
    ignored: Ignored,
    commit_seconds: f64,
    asked: Option<Asked>,
}

impl SceneStats {
    /// Looks at a scene, whose engine then knows the objects as they are.
    pub(crate) fn of(world: &mut World) -> Result<Self, Failure> {
        let shapes = || world.objects().map(|found| &found.object.shape);
        let (objects, triangles, spheres) = (
            shapes().count(),
            shapes().map(|shape| shape.triangles().len()).sum(),
            shapes().map(|shape| shape.spheres().len()).sum(),
        );
        let ignored = world.count_ignored()?;
        let member: &Member = world.current_member()?;
        let commit_seconds = member.commit_seconds;
        let (engine, memory) = (member.kind.name(), member.engine.memory_usage());
        let asked = member.asked;
        Ok(Self { objects, triangles, spheres, engine, memory, ignored, commit_seconds, asked })
    }

    /// The numbers under the names of the fields of the Python class `Stats`.
    pub(crate) fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        dict.set_item("objects", self.objects)?;
        dict.set_item("triangles", self.triangles)?;
        dict.set_item("spheres", self.spheres)?;
        dict.set_item("non_finite", self.ignored.non_finite)?;
        dict.set_item("degenerate", self.ignored.degenerate)?;
        dict.set_item("engine_bytes", self.memory)?;
        dict.set_item("update_seconds", self.commit_seconds)?;
        let asked = self.asked.as_ref();
        let choice = asked.and_then(|asked| asked.choice);
        dict.set_item("engine", choice.map_or(self.engine, |choice| choice.engine.name()))?;
        dict.set_item("reason", choice.map(|choice| choice.to_string()))?;
        dict.set_item("query_seconds", asked.map_or(0.0, |asked| asked.seconds))?;
        let trace = asked.map(|asked| asked.trace).unwrap_or_default();
        dict.set_item("rays", trace.rays)?;
        dict.set_item("invalid_rays", trace.invalid_rays)?;
        dict.set_item("triangle_tests", trace.triangle_tests)?;
        dict.set_item("box_tests", trace.box_tests)?;
        dict.set_item("cone_tests", trace.cone_tests)?;
        Ok(dict)
    }
}
