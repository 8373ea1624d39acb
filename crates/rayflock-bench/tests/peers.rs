//! Engines of others answer as the definition does, within the error of their arithmetic.
//!
//! Tests of Embree need its library and say so when they skip: `cargo xtask embree` fetches it.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use rayflock::engine::{self, EngineError, EngineKind, RayEngine};
use rayflock::geom::{
    Aabb, FrameChanges, Geometry, GeometryObject, HitBuffer, Mesh, ObjectId, RayBatch,
    RayBatchError, Sphere,
};
use rayflock_bench::peer::PeerError;
use rayflock_bench::peer::embree::{EmbreeEngine, EmbreeLibrary, Setting};
use rayflock_bench::peer::obvhs::ObvhsEngine;
use rayflock_testkit::Rng;
use rayflock_testkit::scenes::UserBoxes;

/// Frames of a scene where objects stand, move, turn, deform, come, go, and change masks.
fn frames(rng: &mut Rng) -> Vec<Geometry> {
    let room = Arc::new(soup(rng, 80, 2.0));
    let turning = Arc::new(soup(rng, 60, 0.6));
    let balls: Vec<_> =
        (0..12).map(|_| Sphere::new(rng.in_cube(), rng.between(0.05, 0.3))).collect();
    let balls = Arc::new(soup(rng, 20, 0.4).with_spheres(balls));
    let mut deformed = soup(rng, 70, 0.5);
    let mut frames = Vec::new();
    for frame in 0..5_u8 {
        let angle = 0.4 * f32::from(frame);
        let moved: Vec<_> = deformed.vertices().iter().map(|&v| v + 0.05 * rng.in_cube()).collect();
        deformed = deformed.with_vertices(moved).expect("as many vertices");
        let similar = Affine3A::from_rotation_z(angle)
            * Affine3A::from_translation(Vec3::new(0.3, 0.0, 0.1))
            * Affine3A::from_scale(Vec3::splat(0.8));
        let mut objects = vec![
            GeometryObject::new(ObjectId(3), Arc::clone(&room)),
            GeometryObject::new(ObjectId(4), Arc::clone(&turning))
                .with_transform(Affine3A::from_rotation_y(angle)),
            GeometryObject::new(ObjectId(7), deformed.clone()),
        ];
        if frame != 2 {
            let mask = if frame < 3 { 1 } else { 6 };
            let balls = GeometryObject::new(ObjectId(9), Arc::clone(&balls));
            objects.push(balls.with_transform(similar).with_mask(mask));
        }
        if frame > 2 {
            objects.push(GeometryObject::new(ObjectId(1), soup(rng, 10, 1.0)));
        }
        frames.push(Geometry::new(objects).expect("ids are unique"));
    }
    frames
}

fn soup(rng: &mut Rng, count: u32, size: f32) -> Mesh {
    let mut vertices = Vec::new();
    for _ in 0..count {
        let center = rng.in_cube();
        vertices.extend((0..3).map(|_| center + 0.5 * size * rng.in_cube()));
    }
    let triangles: Vec<_> = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh::from_triangles(vertices, triangles).expect("vertices are there")
}

/// Rays in columns, a few of them inactive or invalid.
struct Rays {
    origins: Vec<Vec3>,
    directions: Vec<Vec3>,
    t_min: Vec<f32>,
    t_max: Vec<f32>,
    masks: Vec<u32>,
}

impl Rays {
    fn random(rng: &mut Rng, count: usize) -> Self {
        let origins: Vec<_> = (0..count).map(|_| 3.0 * rng.in_cube()).collect();
        let towards = |rng: &mut Rng, origin: &Vec3| {
            rng.between(0.3, 3.0) * (rng.in_cube() - *origin).normalize()
        };
        let directions = origins.iter().map(|origin| towards(rng, origin)).collect();
        let t_min = (0..count).map(|_| rng.pick(&[0.0, 0.5, -2.0, f32::NEG_INFINITY])).collect();
        let t_max = (0..count).map(|_| rng.pick(&[f32::INFINITY, 4.0, 1.5])).collect();
        let masks = (0..count).map(|_| rng.pick(&[u32::MAX, 1, 2, 4])).collect();
        let mut rays = Self { origins, directions, t_min, t_max, masks };
        for idx in (0..count).step_by(13) {
            match rng.below(6) {
                0 => rays.t_max[idx] = -5.0,
                1 => rays.t_min[idx] = f32::INFINITY,
                2 => rays.t_max[idx] = f32::NAN,
                3 => rays.directions[idx] = Vec3::ZERO,
                4 => rays.origins[idx] = Vec3::NAN,
                _ => rays.directions[idx] = Vec3::INFINITY,
            }
        }
        rays
    }

    /// Batches with columns per ray and uniform ones.
    fn batches(&self) -> [RayBatch<'_>; 4] {
        self.try_batches().expect("columns are of the same length")
    }

    fn try_batches(&self) -> Result<[RayBatch<'_>; 4], RayBatchError> {
        let all = RayBatch::new(&self.origins, &self.directions)?;
        let limited = all.with_interval(&self.t_min, &self.t_max)?;
        let masked = limited.with_mask(&self.masks)?;
        let camera = RayBatch::new(Vec3::new(0.1, -3.0, 0.2), &self.directions)?;
        let sun = RayBatch::new(&self.origins, Vec3::new(0.3, 1.0, -0.2))?;
        Ok([masked, limited, camera, sun.with_interval(0.25, 3.0)?])
    }
}

fn near(a: f32, b: f32) -> bool {
    a == b || (a - b).abs() <= 1e-5 * a.abs().max(b.abs()).max(1.0)
}

/// How many rays are answered in another way than by the definition.
fn compare(engine: &mut dyn RayEngine, definition: &mut dyn RayEngine, batch: &RayBatch<'_>) {
    let (mut found, mut expected) = (HitBuffer::new(batch.len()), HitBuffer::new(batch.len()));
    let stats = engine.closest_hit(batch, &mut found.as_hits());
    let expected_stats = definition.closest_hit(batch, &mut expected.as_hits());
    let counts = |stats: engine::TraceStats| (stats.rays, stats.invalid_rays);
    assert_eq!(counts(stats), counts(expected_stats), "{}", engine.name());
    let mut occluded = vec![false; batch.len()];
    engine.occluded(batch, &mut occluded);
    for (idx, &occluded) in occluded.iter().enumerate() {
        let (found, expected, ray) = (found.get(idx), expected.get(idx), batch.ray(idx));
        let context = || format!("{}: {ray:?}: found {found:?}, not {expected:?}", engine.name());
        let ids = |hit: rayflock::geom::Hit| (hit.object_id, hit.prim_id);
        assert_eq!(ids(found), ids(expected), "{}", context());
        assert!(near(found.t, expected.t), "{}", context());
        let uv_error = (found.u - expected.u).abs().max((found.v - expected.v).abs());
        assert!(uv_error < 2e-3, "{}", context());
        assert_eq!(occluded, !expected.is_miss(), "{}: {ray:?}", engine.name());
    }
}

fn check(engine: &mut dyn RayEngine, frames: &[Geometry], rays: &Rays) {
    let mut definition = engine::create(EngineKind::Brute);
    for frame in frames {
        let expected = definition.commit(frame, &FrameChanges::all()).expect("a supported frame");
        let stats = engine.commit(frame, &FrameChanges::all()).expect("a supported frame");
        assert_eq!(stats.prim_count, expected.prim_count);
        for batch in rays.batches() {
            compare(engine, &mut *definition, &batch);
        }
    }
    assert!(engine.memory_usage() > 0);
}

/// The library, or a reason to skip.
fn library() -> Option<EmbreeLibrary> {
    match EmbreeLibrary::load(None) {
        Ok(library) => Some(library),
        Err(error @ PeerError::LibraryNotFound { .. }) => {
            eprintln!("skipped: {error}");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn every_setting_of_embree_agrees_with_the_definition() {
    let Some(library) = library() else { return };
    let mut rng = Rng::new(11);
    let (frames, rays) = (frames(&mut rng), Rays::random(&mut rng, 700));
    for setting in Setting::all() {
        check(&mut EmbreeEngine::new(&library, setting).unwrap(), &frames, &rays);
    }
}

#[test]
fn embree_ignores_what_is_not_finite_and_takes_it_up_again() {
    let Some(library) = library() else { return };
    let mut rng = Rng::new(5);
    let rays = Rays::random(&mut rng, 300);
    let whole = soup(&mut rng, 60, 0.8);
    let mut broken = whole.vertices().to_vec();
    for idx in (0..broken.len()).step_by(7) {
        broken[idx] = rng.pick(&[Vec3::NAN, Vec3::INFINITY]);
    }
    let broken = whole.with_vertices(broken).unwrap();
    let flat = whole.with_vertices(vec![Vec3::ONE; whole.vertices().len()]).unwrap();
    let frame = |mesh: &Mesh| Geometry::new(vec![GeometryObject::new(ObjectId(0), mesh.clone())]);
    let empty = Geometry::default();
    let frames: Vec<_> = [&whole, &broken, &whole, &flat, &broken]
        .map(|mesh| frame(mesh).unwrap())
        .into_iter()
        .chain([empty, frame(&whole).unwrap()])
        .collect();
    for setting in Setting::all() {
        check(&mut EmbreeEngine::new(&library, setting).unwrap(), &frames, &rays);
    }
}

#[test]
fn embree_follows_the_number_of_threads() {
    let Some(library) = library() else { return };
    let mut rng = Rng::new(3);
    let (frames, rays) = (frames(&mut rng), Rays::random(&mut rng, 200));
    let mut engine = EmbreeEngine::new(&library, Setting::default()).unwrap();
    for thread_count in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(thread_count).build().unwrap();
        pool.install(|| check(&mut engine, &frames, &rays));
    }
    for traversal in Setting::traversals() {
        engine.set_traversal(traversal);
        assert!(engine.name().ends_with(&traversal.to_string()), "{}", engine.name());
        check(&mut engine, &frames[..1], &rays);
    }
}

#[test]
fn embree_keeps_nearer_hits_that_are_there() {
    let Some(library) = library() else { return };
    let mut rng = Rng::new(8);
    let (frames, rays) = (frames(&mut rng), Rays::random(&mut rng, 200));
    for setting in ["low", "low+packets"].map(|text| text.parse().unwrap()) {
        let mut engine = EmbreeEngine::new(&library, setting).unwrap();
        engine.commit(&frames[0], &FrameChanges::all()).unwrap();
        let batch = &rays.batches()[0];
        let mut found = HitBuffer::new(batch.len());
        engine.closest_hit(batch, &mut found.as_hits());
        let mut earlier = HitBuffer::new(batch.len());
        for idx in 0..batch.len() {
            earlier.t[idx] = if idx % 2 == 0 { 0.5 * found.t[idx] } else { 2.0 * found.t[idx] };
        }
        let before = earlier.clone();
        engine.closest_hit(batch, &mut earlier.as_hits());
        for idx in 0..batch.len() {
            let hit = found.get(idx);
            let is_kept = hit.is_miss() || earlier.t[idx] == before.t[idx];
            let replaces = !hit.is_miss() && hit.t < before.t[idx];
            assert!(if replaces { earlier.get(idx) == hit } else { is_kept }, "ray {idx}");
        }
    }
}

#[test]
fn what_peers_cannot_trace_is_an_error() {
    let boxes = Arc::new(UserBoxes(vec![Aabb { min: Vec3::ZERO, max: Vec3::ONE }]));
    let ball = Mesh::from_spheres(vec![Sphere::new(Vec3::ZERO, 1.0)]);
    let frame = |mesh: Mesh| {
        Geometry::new(vec![GeometryObject::new(ObjectId(2), mesh)]).expect("one object")
    };
    let refuses = |engine: &mut dyn RayEngine, frame: &Geometry, expected: &str| {
        let error = engine.commit(frame, &FrameChanges::all()).unwrap_err();
        assert!(matches!(&error, EngineError::Unsupported { what, .. } if what == expected));
        // What is refused leaves an empty frame.
        let (origins, mut occluded) = ([Vec3::splat(-3.0); 2], [true; 2]);
        let rays = RayBatch::new(&origins[..], Vec3::ONE).unwrap();
        engine.occluded(&rays, &mut occluded);
        assert_eq!(occluded, [false; 2]);
    };
    refuses(&mut ObvhsEngine::new(), &frame(Mesh::from_user(boxes.clone())), "user primitives");
    refuses(&mut ObvhsEngine::new(), &frame(ball), "spheres");
    if let Some(library) = library() {
        let mut engine = EmbreeEngine::new(&library, Setting::default()).unwrap();
        refuses(&mut engine, &frame(Mesh::from_user(boxes)), "user primitives");
    }
}

#[test]
fn obvhs_agrees_with_the_definition() {
    let mut rng = Rng::new(21);
    let rays = Rays::random(&mut rng, 400);
    let without_spheres = |geometry: &Geometry| {
        geometry.subset(|object| object.shape.spheres().is_empty() && object.mask == u32::MAX)
    };
    let mut frames: Vec<_> = frames(&mut rng).iter().map(without_spheres).collect();
    frames.insert(2, Geometry::default());
    check(&mut ObvhsEngine::new(), &frames, &rays);
}
