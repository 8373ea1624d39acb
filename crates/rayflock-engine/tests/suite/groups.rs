//! Groups of neighbouring rays in `bvh`, where they are wide for what they meet.

use glam::Vec3;
use rayflock_engine::bvh::{BvhEngine, Config};
use rayflock_engine::{RayEngine, TraceStats};
use rayflock_geom::{
    FrameChanges, Geometry, GeometryObject, HitBuffer, Mesh, ObjectId, RayBatch, RayOrder, Sphere,
};

use crate::nesting::{check, ground, rock};

/// Rays in a row; as many rows.
const SIDE: usize = 64;

/// A rock of small triangles in the middle of wide ground, and rays down on it in rows that run
/// askew, so that the box around sixteen of a row is full of the rock's triangles.
fn rays_at_a_rock() -> (Geometry, Vec<Vec3>, Vec3) {
    let object = |id, mesh| GeometryObject::new(ObjectId(id), mesh);
    let geometry = Geometry::new(vec![object(0, rock(3)), object(1, ground(500.0))]).unwrap();
    let origin = |idx: usize| {
        let [along, across] = [idx % SIDE, idx / SIDE].map(|step| 4.0 * step as f32 / SIDE as f32);
        Vec3::new(along - across, 3.0, along + across - 4.0) / 2.0_f32.sqrt()
    };
    (geometry, (0..SIDE * SIDE).map(origin).collect(), Vec3::new(0.1, -1.0, 0.2))
}

#[test]
fn groups_that_are_too_wide_are_dissolved() {
    let (geometry, origins, direction) = rays_at_a_rock();
    let batch = RayBatch::new(&origins, direction).unwrap().with_order(RayOrder::Coherent);
    let mut engine = BvhEngine::new(Config::default());
    engine.commit(&geometry, &FrameChanges::all()).unwrap();
    let mut hits = HitBuffer::new(batch.len());
    let TraceStats { triangle_tests, .. } = engine.closest_hit(&batch, &mut hits.as_hits());
    let tests_a_ray = triangle_tests / batch.len() as u64;
    assert!(tests_a_ray < 300, "{tests_a_ray} triangle tests a ray");
    check("closest, then occluded", &mut engine, &geometry, &batch);
}

/// As many small spheres as make a cube, and two far away that make the scene wide.
fn cube_of_spheres() -> Geometry {
    let place = |idx: usize| {
        let steps = [idx % 16, idx / 16 % 16, idx / 256].map(|step| step as f32 / 8.0 - 1.0);
        Sphere::new(Vec3::from(steps), 0.02)
    };
    let far = [-500.0, 500.0].map(|x| Sphere::new(x * Vec3::ONE, 0.02));
    let mesh = Mesh::from_spheres((0..4096).map(place).chain(far).collect());
    Geometry::new(vec![GeometryObject::new(ObjectId(0), mesh)]).unwrap()
}

#[test]
fn groups_that_meet_too_many_spheres_are_dissolved() {
    let (_, origins, direction) = rays_at_a_rock();
    let geometry = cube_of_spheres();
    let batch = RayBatch::new(&origins, direction).unwrap().with_order(RayOrder::Coherent);
    let mut engine = BvhEngine::new(Config::default());
    engine.commit(&geometry, &FrameChanges::all()).unwrap();
    let mut hits = HitBuffer::new(batch.len());
    let TraceStats { sphere_tests, .. } = engine.closest_hit(&batch, &mut hits.as_hits());
    let tests_a_ray = sphere_tests / batch.len() as u64;
    assert!(tests_a_ray < 80, "{tests_a_ray} sphere tests a ray");
    check("closest, then occluded", &mut engine, &geometry, &batch);
}

#[test]
fn rays_of_dissolved_groups_keep_their_own_ends() {
    let (geometry, origins, direction) = rays_at_a_rock();
    let mut engine = BvhEngine::new(Config::default());
    engine.commit(&geometry, &FrameChanges::all()).unwrap();
    // From the middle of the rock on, or only up to there, and some rays not at all.
    let starts: Vec<f32> = (0..origins.len()).map(|idx| (idx % 5) as f32).collect();
    let ends: Vec<f32> = (0..origins.len()).map(|idx| 1.5 + (idx % 7) as f32).collect();
    let masks: Vec<u32> = (0..origins.len()).map(|idx| (idx % 3) as u32).collect();
    let batch = RayBatch::new(&origins, direction).unwrap().with_order(RayOrder::Coherent);
    let batch = batch.with_interval(&starts, &ends).unwrap().with_mask(&masks).unwrap();
    check("intervals and masks", &mut engine, &geometry, &batch);
}
