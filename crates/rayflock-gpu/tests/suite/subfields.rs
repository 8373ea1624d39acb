//! `gpu:subfields` against the engine `subfields` of the CPU, on scenes as they are rendered.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use rayflock_engine::{EngineKind, RayEngine};
use rayflock_geom::{FrameChanges, HitBuffer, RayBatch, RayOrder};
use rayflock_gpu::{GpuEngine, GpuEngineKind};
use rayflock_scene::{Evaluator, builtin};
use rayflock_testkit::Rng;

use crate::agreement::{Bench, Tally};
use crate::device::contexts;
use crate::scenes::commit_to;

const SIZE: [usize; 2] = [40, 30];

/// Rays of a camera, and rays from where they hit to all sides.
struct Rays {
    eye: Vec3,
    ways: Vec<Vec3>,
    points: Vec<Vec3>,
    turns: Vec<Vec3>,
}

impl Rays {
    fn in_scene(rng: &mut Rng, engine: &mut dyn RayEngine, world_from_camera: &Affine3A) -> Self {
        let [width, height] = SIZE;
        let way = |idx: usize| {
            let at = |place: usize, size: usize| (place as f32 + 0.5) / size as f32 - 0.5;
            let across = Vec3::new(at(idx % width, width), -at(idx / width, height), -1.0);
            world_from_camera.transform_vector3(across)
        };
        let eye = world_from_camera.translation.into();
        let ways: Vec<_> = (0..width * height).map(way).collect();
        let mut hits = HitBuffer::new(ways.len());
        engine.closest_hit(&RayBatch::new(eye, &ways).unwrap(), &mut hits.as_hits());
        let reached = (0..ways.len()).filter(|&idx| !hits.get(idx).is_miss());
        let points: Vec<_> = reached.map(|idx| eye + 0.999 * hits.get(idx).t * ways[idx]).collect();
        let turns = points.iter().map(|_| 10.0_f32.powi(rng.below(4) as i32 - 2) * rng.on_sphere());
        let turns = turns.collect();
        Self { eye, ways, points, turns }
    }
}

#[test]
fn answers_are_those_of_the_engine_on_the_cpu() {
    for name in ["museum7", "crowd"] {
        let scene = Arc::new(builtin::build(name).unwrap());
        let mut evaluator = Evaluator::new(Arc::clone(&scene), None).unwrap();
        let frame = evaluator.evaluate(2.5).unwrap();
        let mut bench = Bench::against(&frame.geometry, EngineKind::Subfields);
        let mut on_cpu = commit_to(EngineKind::Subfields, &frame.geometry);
        let rays = Rays::in_scene(&mut Rng::new(71), &mut *on_cpu, &frame.cameras[0]);
        assert!(rays.points.len() > 500, "{name}: {} points", rays.points.len());
        for context in contexts() {
            let mut engine = GpuEngine::new(GpuEngineKind::Subfields, context).unwrap();
            bench.commit_to(&mut engine, &FrameChanges::all());
            let tally = compare(&mut bench, &mut engine, &rays);
            println!("{name} on {}: {tally:?}", context.adapter());
            assert!(tally.hits > 2000 && 500 * tally.ties <= tally.hits, "{name}: {tally:?}");
        }
    }
}

/// Rays of the camera, to all sides, and to the sun.
fn compare(bench: &mut Bench, engine: &mut GpuEngine, rays: &Rays) -> Tally {
    let [width, height] = SIZE;
    let order = RayOrder::Image { width, height, tile: 0 };
    let seen = RayBatch::new(rays.eye, &rays.ways).unwrap().with_order(order);
    let turned = RayBatch::new(&rays.points, &rays.turns).unwrap();
    let near = turned.with_interval(1e-3, 12.8).unwrap();
    let sunny = RayBatch::new(&rays.points, Vec3::new(4.0, 20.0, 7.0)).unwrap();
    let all = [seen, turned, near, sunny].map(|batch| bench.compare(engine, &batch));
    // Rays to all sides share nothing, and a grid spares them most tests all the same.
    let stats = engine.closest_hit(&turned, &mut HitBuffer::new(turned.len()).as_hits());
    let per_ray = stats.triangle_tests / stats.rays;
    assert!(per_ray < 200, "{per_ray} tests a ray");
    let sum = |of: fn(&Tally) -> usize| all.iter().map(of).sum();
    Tally { hits: sum(|tally| tally.hits), ties: sum(|tally| tally.ties) }
}
