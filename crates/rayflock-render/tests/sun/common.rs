//! Plates, days and meters.

use glam::Vec3;
use jiff::civil::Date;
use rayflock_engine::{EngineKind, create};
use rayflock_geom::{FrameChanges, Geometry, GeometryObject, Mesh, ObjectId};
use rayflock_render::sun::{Axis, Bearings, Days, Place, Sampling, Sides, SunMeter, SunStep};

/// A step of [`Days::one`] in hours.
pub(crate) const STEP: f64 = 1.0 / 6.0;

/// The steps of a day at a latitude on the meridian of Greenwich, in a scene with y up.
pub(crate) fn steps(latitude: f64, date: Date) -> Vec<SunStep> {
    let place = Place::from_degrees(latitude, 0.0).unwrap();
    Days::one(date).sunlit_steps(&place, &Bearings::new(Axis::Y, 0.0)).unwrap()
}

/// All of `steps`, in hours.
pub(crate) fn total(steps: &[SunStep]) -> f64 {
    steps.iter().map(|step| step.seconds).sum::<f64>() / 3600.0
}

/// A square of side `2 * half` around `center`; its front looks along `side` x `up`.
pub(crate) fn square(center: Vec3, side: Vec3, up: Vec3, half: f32) -> Mesh {
    let corner = |s: f32, u: f32| center + (side * s + up * u) * half;
    let corners = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    Mesh::from_triangles(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

/// A square on the ground that looks up.
pub(crate) fn ground(center: Vec3, half: f32) -> Mesh {
    square(center, Vec3::X, -Vec3::Z, half)
}

/// Meshes in world space, with the ids 0, 1, ...
pub(crate) fn geometry(meshes: Vec<Mesh>) -> Geometry {
    let objects = (0..).zip(meshes);
    let objects = objects.map(|(id, mesh)| GeometryObject::new(ObjectId(id), mesh));
    Geometry::new(objects.collect()).unwrap()
}

pub(crate) fn meter(kind: EngineKind, sampling: Sampling, sides: Sides) -> SunMeter {
    SunMeter::new(create(kind), sampling, sides)
}

/// Hours of each sample of a geometry at rest.
pub(crate) fn hours(
    geometry: &Geometry,
    steps: &[SunStep],
    sampling: Sampling,
    sides: Sides,
) -> Vec<f64> {
    let mut meter = meter(EngineKind::Brute, sampling, sides);
    meter.commit(geometry, &FrameChanges::all()).unwrap();
    shine(&mut meter, steps);
    in_hours(&meter)
}

pub(crate) fn shine(meter: &mut SunMeter, steps: &[SunStep]) {
    for step in steps {
        meter.add(step.to_sun, step.seconds);
    }
}

pub(crate) fn in_hours(meter: &SunMeter) -> Vec<f64> {
    meter.seconds().iter().map(|seconds| seconds / 3600.0).collect()
}
