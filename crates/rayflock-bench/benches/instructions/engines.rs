//! Whole calls of engines on a frame of the museum, in the steady state.

use std::sync::Arc;

use rayflock::engine::{EngineKind, RayEngine, create};
use rayflock::geom::{FrameChanges, HitBuffer};
use rayflock::prelude::*;
use rayflock::scene::builtin;
use rayflock_bench::work::{Question, RayKind, RaySet, Surroundings, generate};

use crate::{Case, measured_part};

/// The scene of the cases of `hierarchy`: 4,096 triangles that move, and the hall.
const LARGE: &str = "museum6";
/// The scene of the cases of `brute`: 64 triangles that move, and the hall.
const SMALL: &str = "museum3";
/// The scene whose table of primitives is written: 16,384 triangles that move, and the hall.
const MOVING: &str = "museum7";

pub(crate) const CASES: [Case; 9] = [
    Case { name: "commit", item: "triangles", run: commit },
    Case {
        name: "hierarchy_primary",
        item: "rays",
        run: || trace(EngineKind::Hierarchy, LARGE, RayKind::Primary),
    },
    Case {
        name: "hierarchy_shadow",
        item: "rays",
        run: || trace(EngineKind::Hierarchy, LARGE, RayKind::PointShadow),
    },
    Case {
        name: "hierarchy_mirror",
        item: "rays",
        run: || trace(EngineKind::Hierarchy, LARGE, RayKind::Mirror),
    },
    Case {
        name: "hierarchy_diffuse",
        item: "rays",
        run: || trace(EngineKind::Hierarchy, LARGE, RayKind::Diffuse),
    },
    Case { name: "bvh_build", item: "triangles", run: build },
    Case {
        name: "bvh_mirror",
        item: "rays",
        run: || trace(EngineKind::Bvh, LARGE, RayKind::Mirror),
    },
    Case {
        name: "bvh_diffuse",
        item: "rays",
        run: || trace(EngineKind::Bvh, LARGE, RayKind::Diffuse),
    },
    Case {
        name: "brute_primary",
        item: "rays",
        run: || trace(EngineKind::Brute, SMALL, RayKind::Primary),
    },
];

/// The frame that is traced: the triangles swarm.
const FRAME: u32 = 150;

/// Width and height of the picture whose rays are traced.
const SIZE: [usize; 2] = [64, 64];

/// A frame of a built-in scene, and the surroundings for its rays.
fn frame(name: &str, frame: u32) -> (SceneFrame, Surroundings) {
    let scene = Arc::new(builtin::build(name).unwrap());
    let time = f64::from(frame) / scene.default_frame_rate();
    let projection = scene.cameras[0].projection;
    let frame = Evaluator::new(scene, None).unwrap().evaluate(time).unwrap().clone();
    let view = View::new(frame.cameras[0], projection);
    let surroundings = Surroundings::of_scene(&frame.geometry.bounds(), view, &frame.lights);
    (frame, surroundings)
}

/// Three frames in which the sculpture moves and the hall stands still.
fn moving_frames() -> [SceneFrame; 3] {
    let scene = Arc::new(builtin::build(MOVING).unwrap());
    let mut evaluator = Evaluator::new(Arc::clone(&scene), None).unwrap();
    let rate = scene.default_frame_rate();
    [FRAME, FRAME + 1, FRAME + 2]
        .map(|frame| evaluator.evaluate(f64::from(frame) / rate).unwrap().clone())
}

/// Takes over a frame, and writes its primitives.
fn commit() -> usize {
    let [first, second, last] = moving_frames();
    let mut engine = create(EngineKind::Brute);
    for frame in [&first, &second] {
        engine.commit(&frame.geometry, &frame.changes).unwrap();
    }
    let stats = measured_part(|| engine.commit(&last.geometry, &last.changes)).unwrap();
    stats.rewritten_count
}

/// Builds the tree over what moved, which the first ray of a frame asks for.
fn build() -> usize {
    let mut engine = create(EngineKind::Bvh);
    let ray = RayBatch::new(Vec3::ZERO, Vec3::Y).unwrap();
    let mut hits = HitBuffer::new(1);
    let [first, second, last] = moving_frames();
    for frame in [&first, &second] {
        engine.commit(&frame.geometry, &frame.changes).unwrap();
        engine.closest_hit(&ray, &mut hits.as_hits());
    }
    let stats = engine.commit(&last.geometry, &last.changes).unwrap();
    measured_part(|| engine.closest_hit(&ray, &mut hits.as_hits()));
    stats.rewritten_count
}

/// Asks the rays' own question.
fn trace(kind: EngineKind, scene: &str, rays: RayKind) -> usize {
    let (frame, surroundings) = frame(scene, FRAME);
    let mut engine = create(kind);
    engine.commit(&frame.geometry, &FrameChanges::all()).unwrap();
    let rays = generate(rays, SIZE, &surroundings, &frame.geometry, &mut *engine, 1);
    let mut hits = HitBuffer::new(rays.len());
    let mut occluded = vec![false; rays.len()];
    ask(&mut *engine, &rays, &mut hits, &mut occluded);
    let mut hits = HitBuffer::new(rays.len());
    measured_part(|| ask(&mut *engine, &rays, &mut hits, &mut occluded));
    rays.len()
}

/// Traces a set of one batch.
fn ask(engine: &mut dyn RayEngine, rays: &RaySet, hits: &mut HitBuffer, occluded: &mut [bool]) {
    let batch = rays.batches().next().unwrap();
    match rays.question() {
        Question::ClosestHit => engine.closest_hit(&batch, &mut hits.as_hits()),
        Question::Occluded => engine.occluded(&batch, occluded),
    };
}
