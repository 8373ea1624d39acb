//! What engines count, and what they do with nothing.

use std::sync::Arc;

use glam::Vec3;
use rayflock_engine::{Clock, EngineError, RayEngine, StageTime, TraceStats};
use rayflock_geom::{
    Aabb, FrameChanges, Geometry, GeometryObject, HitBuffer, Hits, Mesh, ObjectId, RayBatch, Sphere,
};
use rayflock_testkit::scenes::UserBoxes;

use crate::device::engines;

fn ball(id: u32, distance: f32) -> GeometryObject {
    let sphere = Sphere::new(distance * Vec3::X, 1.0);
    GeometryObject::new(ObjectId(id), Mesh::from_spheres(vec![sphere]))
}

#[test]
fn nothing_is_hit_where_nothing_is() {
    let empty = Geometry::new(vec![GeometryObject::new(ObjectId(1), Mesh::default())]).unwrap();
    let rays = vec![Vec3::X; 100];
    let batch = RayBatch::new(Vec3::ZERO, &rays).unwrap();
    let none: &[Vec3] = &[];
    for mut engine in engines() {
        for frame in [None, Some(&Geometry::default()), Some(&empty)] {
            if let Some(frame) = frame {
                engine.commit(frame, &FrameChanges::all()).unwrap();
            }
            let mut hits = HitBuffer::new(100);
            assert_eq!(engine.closest_hit(&batch, &mut hits.as_hits()).rays, 100);
            assert_eq!(hits, HitBuffer::new(100), "{}", engine.name());
        }
        engine.commit(&Geometry::new(vec![ball(0, 4.0)]).unwrap(), &FrameChanges::all()).unwrap();
        let stats = engine.occluded(&RayBatch::new(Vec3::ZERO, none).unwrap(), &mut []);
        assert_eq!(stats, TraceStats::default(), "{}", engine.name());
    }
}

/// Appears, is masked out, comes again elsewhere and vanishes, under the claim that nothing does.
#[test]
fn a_false_claim_that_nothing_changed_does_no_harm() {
    let rays = [Vec3::X; 40];
    let batch = RayBatch::new(Vec3::ZERO, &rays[..]).unwrap().with_mask(1).unwrap();
    for mut engine in engines() {
        let frames = [
            (vec![ball(0, 3.0)], 2.0),
            (vec![ball(0, 3.0).with_mask(2)], f32::INFINITY),
            (vec![ball(0, 6.0), ball(2, 4.0)], 3.0),
            (Vec::new(), f32::INFINITY),
        ];
        for (objects, t) in frames {
            let frame = Geometry::new(objects).unwrap();
            engine.commit(&frame, &FrameChanges::none()).unwrap();
            let mut found = [f32::INFINITY; 40];
            engine.closest_hit(&batch, &mut Hits::distances(&mut found));
            assert!(
                found.iter().all(|&f| f == t || (f - t).abs() < 1e-5),
                "{}: {t}",
                engine.name()
            );
        }
    }
}

#[test]
fn what_did_not_change_is_not_sent_again() {
    let frame = Geometry::new(vec![ball(0, 3.0), ball(1, 5.0)]).unwrap();
    for mut engine in engines() {
        let first = engine.commit(&frame, &FrameChanges::all()).unwrap();
        let again = engine.commit(&frame, &FrameChanges::none()).unwrap();
        assert_eq!((first.rewritten_count, again.rewritten_count), (2, 0), "{}", engine.name());
    }
}

#[test]
fn hits_that_are_there_are_kept_unless_a_nearer_one_is_found() {
    let rays = [Vec3::X; 3];
    let batch = RayBatch::new(Vec3::ZERO, &rays[..]).unwrap();
    for mut engine in engines() {
        engine.commit(&Geometry::new(vec![ball(7, 3.0)]).unwrap(), &FrameChanges::all()).unwrap();
        let mut hits = HitBuffer::new(3);
        (hits.t[0], hits.t[1]) = (1.0, 2.5);
        engine.closest_hit(&batch, &mut hits.as_hits());
        let found = [0, 1, 2].map(|idx| hits.get(idx).object_id);
        assert_eq!(found, [ObjectId::NONE, ObjectId(7), ObjectId(7)], "{}", engine.name());
    }
}

#[test]
fn user_primitives_are_refused_and_leave_an_empty_frame() {
    let boxes = UserBoxes(vec![Aabb { min: Vec3::ONE, max: 2.0 * Vec3::ONE }]);
    let users = GeometryObject::new(ObjectId(1), Mesh::from_user(Arc::new(boxes)));
    let frame = Geometry::new(vec![ball(0, 3.0), users]).unwrap();
    let rays = [Vec3::X; 2];
    for mut engine in engines() {
        let error = engine.commit(&frame, &FrameChanges::all()).unwrap_err();
        assert!(
            matches!(&error, EngineError::Unsupported { what, .. } if what == "user primitives")
        );
        let mut occluded = [true; 2];
        engine.occluded(&RayBatch::new(Vec3::ZERO, &rays[..]).unwrap(), &mut occluded);
        assert_eq!(occluded, [false; 2], "{}", engine.name());
    }
}

/// What runs on the device is told stage by stage, and of this frame alone.
#[test]
fn stages_and_buffers_are_told() {
    let rays = [Vec3::X; 3];
    let batch = RayBatch::new(Vec3::ZERO, &rays[..]).unwrap();
    for mut engine in engines() {
        let frame = Geometry::new(vec![ball(7, 3.0)]).unwrap();
        for _ in 0..2 {
            engine.commit(&frame, &FrameChanges::all()).unwrap();
            engine.closest_hit(&batch, &mut HitBuffer::new(3).as_hits());
            let (budget, name) = (engine.budget(), engine.name());
            let (_, folder) = name.split_once(':').unwrap();
            let is_own = |stage: &StageTime| match budget.clock {
                Clock::Timestamps => stage.name.starts_with(folder),
                Clock::Submissions => stage.name == "whole runs",
                Clock::None => false,
            };
            assert!(budget.stages.iter().any(is_own), "{name}: {budget:?}");
            let ran_once = |stage: &&StageTime| stage.name.contains("trace") && stage.runs > 1;
            assert_eq!(budget.stages.iter().find(ran_once), None, "{name}");
            let held = |kind: &str| budget.buffers.iter().any(|b| b.name == kind && b.bytes > 0);
            assert!(held("primitives") && held("read back"), "{name}: {budget:?}");
            assert_eq!(engine.memory_usage() as u64, budget.bytes(), "{name}");
        }
    }
}
