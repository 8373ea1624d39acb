//! What the choosing engine tells about its choices; that its answers are everyone's is tested
//! with all others.

use glam::Vec3;
use rayflock_engine::auto::{AutoEngine, Config, RayClass};
use rayflock_engine::{EngineKind, RayEngine};
use rayflock_geom::{FrameChanges, Geometry, GeometryObject, HitBuffer, Mesh, ObjectId, RayBatch};

fn one_triangle() -> Geometry {
    let mesh = Mesh::from_triangles(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]).unwrap();
    Geometry::new(vec![GeometryObject::new(ObjectId(3), mesh)]).unwrap()
}

#[test]
fn every_batch_of_the_frame_is_explained() {
    let mut engine = AutoEngine::new(Config::default());
    let geometry = one_triangle();
    for _ in 0..2 {
        engine.commit(&geometry, &FrameChanges::all()).unwrap();
        assert!(engine.choices().is_empty());
        let directions = [Vec3::new(0.2, 0.2, -1.0), Vec3::Z];
        let rays = RayBatch::new(Vec3::Z, &directions[..]).unwrap();
        let mut hits = HitBuffer::new(2);
        engine.closest_hit(&rays, &mut hits.as_hits());
        engine.occluded(&rays, &mut [false; 2]);

        let choices = engine.choices();
        assert_eq!(choices.len(), 2);
        assert_eq!((choices[0].ray_count, choices[0].prim_count), (2, 1));
        assert_eq!(choices[0].class, RayClass::SharedOrigin);
        let members: Vec<_> = choices[0].expected_ns().collect();
        assert!(members.iter().all(|&(kind, ns)| kind != EngineKind::Auto && ns > 0.0));
        assert!(members.iter().any(|&(kind, _)| kind == choices[0].engine));
        let text = choices[1].to_string();
        assert!(text.contains("2 shadow rays from one point past 1 primitives: took"), "{text}");
    }
}

#[test]
fn two_rays_and_a_triangle_need_no_structure() {
    let mut engine = AutoEngine::default();
    engine.commit(&one_triangle(), &FrameChanges::all()).unwrap();
    engine.occluded(&RayBatch::new(Vec3::Z, -Vec3::Z).unwrap(), &mut [false]);
    assert_eq!(engine.choices()[0].engine, EngineKind::Brute);
}
