//! A device that is lost while it is in use.

use std::sync::Arc;

use glam::Vec3;
use rayflock_engine::RayEngine;
use rayflock_geom::{
    Aabb, FrameChanges, Geometry, GeometryObject, HitBuffer, Mesh, ObjectId, RayBatch, Sphere,
};
use rayflock_gpu::{GpuContext, GpuEngine, GpuEngineKind};
use rayflock_testkit::scenes::UserBoxes;

use crate::device::open_all;

fn frame(distance: f32) -> Geometry {
    let sphere = Sphere::new(distance * Vec3::X, 1.0);
    one(ObjectId(3), Mesh::from_spheres(vec![sphere]))
}

/// A frame that no device takes.
fn user_frame(distance: f32) -> Geometry {
    let near =
        Aabb { min: Vec3::new(distance, -1.0, -1.0), max: Vec3::new(distance + 1.0, 1.0, 1.0) };
    one(ObjectId(4), Mesh::from_user(Arc::new(UserBoxes(vec![near]))))
}

fn one(id: ObjectId, mesh: Mesh) -> Geometry {
    Geometry::new(vec![GeometryObject::new(id, mesh)]).unwrap()
}

#[test]
fn the_cpu_goes_on_when_the_device_is_lost_and_says_so() {
    for kind in GpuEngineKind::ALL {
        // Devices of their own: the others are in use by other tests.
        open_all().iter().for_each(|own| lose(kind, own));
    }
}

fn lose(kind: GpuEngineKind, own: &Arc<GpuContext>) {
    let rays = [Vec3::X; 5];
    let batch = RayBatch::new(Vec3::ZERO, &rays[..]).unwrap();
    let mut engine = GpuEngine::new(kind, own).unwrap();
    engine.commit(&frame(3.0), &FrameChanges::all()).unwrap();
    assert_eq!(engine.notice(), None);

    own.destroy();
    let mut hits = HitBuffer::new(5);
    engine.closest_hit(&batch, &mut hits.as_hits());
    assert_eq!((hits.get(4).t, hits.get(4).object_id), (2.0, ObjectId(3)));
    let notice = engine.notice().unwrap_or_default();
    assert!(notice.contains(" was lost: ") && notice.contains("the CPU goes on"), "{notice}");

    // The next frames are the CPU's.
    engine.commit(&frame(6.0), &FrameChanges::all()).unwrap();
    let mut occluded = [false; 5];
    engine.occluded(&batch.with_interval(0.0, 5.5).unwrap(), &mut occluded);
    assert_eq!(occluded, [true; 5]);

    // So are those that the device would refuse.
    engine.commit(&user_frame(8.0), &FrameChanges::all()).unwrap();
    let mut hits = HitBuffer::new(5);
    engine.closest_hit(&batch, &mut hits.as_hits());
    assert_eq!((hits.get(4).t, hits.get(4).object_id), (8.0, ObjectId(4)));
}
