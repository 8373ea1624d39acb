//! A LiDAR among people who walk: every point lies on the surface as it is at the point's own time.
//!
//! The check is independent of what made the point: the mesh is evaluated anew at that time, and
//! the distance from the point to the triangle that it names is measured in `f64`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DVec3, Vec3};
use rayflock::geom::{PrimKind, transform_point};
use rayflock::import::Reporter;
use rayflock::prelude::*;
use rayflock::render::sensor::{Pattern, Pose, PosePath, Scanner, Sensor, Spinning, Sweep, evenly};
use rayflock::scene::builtin;

/// A sweep of 24 x 96 beams in half a second, each column at its own time, from `position`.
fn sweep(scene: &Arc<Scene>, position: Vec3, target: Vec3, start: f64) -> Sweep {
    let pattern = Pattern::Spinning(Spinning {
        elevations: evenly(0.4, -0.4, 24),
        columns: 96,
        revolutions_per_second: 2.0,
    });
    let sensor = Sensor::new(pattern, PosePath::Fixed(Pose::looking_at(position, target)));
    let engine = rayflock::engine::create(EngineKind::Auto);
    let mut scanner = Scanner::new(engine, sensor).expect("there is such a sensor");
    let mut evaluator = Evaluator::new(Arc::clone(scene), None).expect("the scene is sound");
    let mut sweep = Sweep::default();
    scanner.sweep(&mut evaluator, start, &mut sweep).expect("the scene is sound");
    assert_eq!(sweep.steps.len(), 96);
    sweep
}

/// How far each point is from its triangle, relative to its range, where the scene is evaluated
/// at the time that `time` makes of the point's. Points on anything but triangles are left out.
fn errors(scene: &Arc<Scene>, sweep: &Sweep, time: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut evaluator = Evaluator::new(Arc::clone(scene), None).expect("the scene is sound");
    let (mut errors, mut geometry) = (Vec::new(), Geometry::default());
    for idx in 0..sweep.len() {
        if idx == 0 || sweep.time[idx] != sweep.time[idx - 1] {
            let frame = evaluator.evaluate(time(sweep.time[idx])).expect("the scene is sound");
            geometry = frame.geometry.clone();
        }
        let object = geometry.object(ObjectId(sweep.object_id[idx])).expect("it is there");
        let prim_id = PrimId(sweep.prim_id[idx]);
        let PrimKind::Triangle(triangle_idx) = object.shape.prim_kind(prim_id) else { continue };
        let corners = object.shape.corners(triangle_idx).map(|corner| {
            let place = object.world_from_object.as_ref();
            place.map_or(corner, |place| transform_point(place, corner)).as_dvec3()
        });
        let distance = distance_to_triangle(sweep.position[idx].as_dvec3(), corners);
        errors.push(distance / f64::from(sweep.range[idx]));
    }
    errors
}

/// The distance from a point to a triangle: to its plane where the point is above it, else to the
/// nearest of its edges.
fn distance_to_triangle(point: DVec3, corners: [DVec3; 3]) -> f64 {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a).normalize();
    let edges = [(a, b), (b, c), (c, a)];
    if edges.iter().all(|(from, to)| (*to - *from).cross(point - *from).dot(normal) >= 0.0) {
        return (point - a).dot(normal).abs();
    }
    let to_edge = |(from, to): (DVec3, DVec3)| {
        let along = to - from;
        let share = ((point - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        point.distance(from + share * along)
    };
    edges.map(to_edge).into_iter().fold(f64::INFINITY, f64::min)
}

/// Checks a sweep, and that the check tells a scene that moves from a frozen one.
fn assert_on_surface(scene: &Arc<Scene>, sweep: &Sweep, least_moving: usize) {
    let errors_then = errors(scene, sweep, |time| time);
    let worst = errors_then.iter().copied().fold(0.0, f64::max);
    assert!(errors_then.len() > 200, "only {} points are on triangles", errors_then.len());
    assert!(worst < 1e-5, "{worst}");

    let start = sweep.steps[0].time;
    let frozen = errors(scene, sweep, |_| start);
    let off = frozen.iter().filter(|error| **error > 1e-4).count();
    assert!(off >= least_moving, "{off} points are off the frozen surface");
}

#[test]
fn points_on_the_crowd_lie_where_people_are_then() {
    let scene = Arc::new(builtin::build("crowd").expect("it is built in"));
    let sweep = sweep(&scene, Vec3::new(2.0, 1.1, 0.6), Vec3::new(3.0, 1.1, 0.8), 0.3);
    assert_on_surface(&scene, &sweep, 100);
}

#[test]
fn points_on_cesium_man_lie_where_he_is_then() {
    let Some(path) = real_scene("cesium-man/CesiumMan.glb") else { return };
    let scene = rayflock::import::load(&path, &mut Reporter::new()).expect("it is sound");
    let scene = Arc::new(scene);
    // From within him, so that many beams meet him.
    let sweep = sweep(&scene, Vec3::new(0.0, 0.9, 0.0), Vec3::new(1.0, 0.9, 0.0), 0.2);
    assert_on_surface(&scene, &sweep, 100);
}

/// A file among the real scenes, or a word on why the test is skipped.
fn real_scene(name: &str) -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let folder = std::env::var_os("RAYFLOCK_DATA").map_or(beside, PathBuf::from);
    let path = folder.join(name);
    if path.exists() {
        return Some(path);
    }
    println!("skipped: {} is not there; RAYFLOCK_DATA says where real scenes are", path.display());
    None
}
