//! A device that is lost while it is in use.

use glam::Vec3;
use rayflock_engine::RayEngine;
use rayflock_geom::{
    FrameChanges, Geometry, GeometryObject, HitBuffer, Mesh, ObjectId, RayBatch, Sphere,
};
use rayflock_gpu::{AdapterChoice, GpuContext, GpuEngine, GpuEngineKind};

use crate::device::contexts;

fn frame(distance: f32) -> Geometry {
    let sphere = Sphere::new(distance * Vec3::X, 1.0);
    let object = GeometryObject::new(ObjectId(3), Mesh::from_spheres(vec![sphere]));
    Geometry::new(vec![object]).unwrap()
}

#[test]
fn the_cpu_goes_on_when_the_device_is_lost_and_says_so() {
    let rays = [Vec3::X; 5];
    let batch = RayBatch::new(Vec3::ZERO, &rays[..]).unwrap();
    let pairs = GpuEngineKind::ALL.map(|kind| (0..contexts().len()).map(move |idx| (kind, idx)));
    for (kind, idx) in pairs.into_iter().flatten() {
        // A device of its own: the others are in use by other tests.
        let own = GpuContext::new(AdapterChoice::Number(idx)).unwrap();
        let mut engine = GpuEngine::new(kind, &own).unwrap();
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
    }
}
