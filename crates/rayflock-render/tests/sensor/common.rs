//! Scenes and sensors.

use std::sync::Arc;

use glam::Vec3;
use rayflock_engine::{EngineKind, create};
use rayflock_geom::{Mesh, Sphere};
use rayflock_render::sensor::{
    DepthCamera, Pattern, Pose, PosePath, Scanner, Sensor, Shutter, Spinning, Sweep, evenly,
};
use rayflock_scene::{Evaluator, Material, MaterialIdx, Scene, SceneObject, Shape, SurfaceMesh};

/// A square of side `2 * half` across Z.
pub(crate) fn wall(z: f32, half: f32) -> Mesh {
    let corner = |x: f32, y: f32| Vec3::new(x * half, y * half, z);
    let corners = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    Mesh::from_triangles(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

pub(crate) fn ball(center: Vec3, radius: f32) -> Mesh {
    Mesh::from_spheres(vec![Sphere::new(center, radius)])
}

/// A scene of meshes at rest, each with its material.
pub(crate) fn scene(parts: Vec<(Mesh, Material)>) -> Scene {
    let mut scene = Scene::default();
    for (idx, (mesh, material)) in (0..).zip(parts) {
        let shape = Shape::Fixed(SurfaceMesh::new(mesh, MaterialIdx(idx)));
        scene.objects.push(SceneObject { name: idx.to_string(), node: None, mask: 1, shape });
        scene.materials.push(material);
    }
    scene
}

pub(crate) fn matte(reflectance: f32) -> Material {
    Material { diffuse: Vec3::splat(reflectance), ..Material::default() }
}

/// Elevations from 20 degrees up to 20 down.
pub(crate) fn spinning(rows: u32, columns: u32) -> Pattern {
    let elevations = evenly(20.0_f64.to_radians(), -20.0_f64.to_radians(), rows);
    Pattern::Spinning(Spinning { elevations, columns, revolutions_per_second: 10.0 })
}

/// A right angle up and down.
pub(crate) fn depth(width: u32, height: u32, shutter: Shutter) -> Pattern {
    let vertical_field = 90.0_f64.to_radians();
    Pattern::Depth(DepthCamera { width, height, vertical_field, rate: 25.0, shutter })
}

pub(crate) fn sensor(pattern: Pattern) -> Sensor {
    Sensor::new(pattern, PosePath::Fixed(Pose::at(Vec3::ZERO)))
}

pub(crate) fn evaluator(scene: Scene) -> Evaluator {
    Evaluator::new(Arc::new(scene), None).unwrap()
}

/// What `sensor` sees of `scene` from time `start` on.
pub(crate) fn sweep_by(kind: EngineKind, scene: &Scene, sensor: &Sensor, start: f64) -> Sweep {
    let mut sweep = Sweep::default();
    let mut scanner = Scanner::new(create(kind), sensor.clone()).unwrap();
    scanner.sweep(&mut evaluator(scene.clone()), start, &mut sweep).unwrap();
    sweep
}

pub(crate) fn sweep(scene: &Scene, sensor: &Sensor) -> Sweep {
    sweep_by(EngineKind::Auto, scene, sensor, 0.0)
}
