//! Objects with subfields of their own: the same answers, fewer tests.

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};
use rayflock_engine::subfields::{Config, SubfieldsEngine};
use rayflock_engine::{RayEngine, TraceStats};
use rayflock_geom::{
    FrameChanges, Geometry, GeometryObject, HitBuffer, Mesh, ObjectId, RayBatch, transform_point,
};
use rayflock_testkit::Rng;

use crate::engines::{definition, first_difference};

/// Columns and rows of a rock's grid of vertices.
const COLUMNS: u32 = 64;
const ROWS: u32 = 40;

/// A bumpy ball of radius 1 with 5120 triangles. Some have no area because corners coincide, some
/// because they lie in a line, which rounding may change under a transform.
pub(crate) fn rock(seed: u64) -> Mesh {
    let mut rng = Rng::new(seed);
    let vertex = |column: u32, row: u32| row * COLUMNS + column % COLUMNS;
    let mut vertices: Vec<Vec3> = (0..=ROWS)
        .flat_map(|row| (0..COLUMNS).map(move |column| (column, row)))
        .map(|(column, row)| {
            let (around, down) = (column as f32 / COLUMNS as f32, row as f32 / ROWS as f32);
            let (sin, cos) = (std::f32::consts::TAU * around).sin_cos();
            let (side, up) = (std::f32::consts::PI * down).sin_cos();
            Vec3::new(cos * side, up, sin * side) * rng.between(0.9, 1.0)
        })
        .collect();
    let (first, last) = (vertices.len() as u32, vertices[7]);
    vertices.extend([Vec3::ZERO, last, 2.0 * last, 3.0 * last]);
    let mut triangles: Vec<[u32; 3]> = (0..ROWS)
        .flat_map(|row| (0..COLUMNS).map(move |column| (column, row)))
        .flat_map(|(x, y)| {
            let [a, b, c, d] =
                [vertex(x, y), vertex(x + 1, y), vertex(x + 1, y + 1), vertex(x, y + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    triangles.extend([[first, first + 1, first + 2], [first + 1, first + 2, first + 3]]);
    Mesh::from_triangles(vertices, triangles).unwrap()
}

/// Two large triangles.
pub(crate) fn ground(size: f32) -> Mesh {
    let corner = |x: f32, z: f32| Vec3::new(x * size, -4.0, z * size);
    let corners = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    Mesh::from_triangles(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

/// A scene with rocks here and there; which of them there are, and how they lie, changes.
fn frames(count: usize) -> Vec<Geometry> {
    let (first, second, floor) = (Arc::new(rock(1)), Arc::new(rock(2)), Arc::new(ground(500.0)));
    let frame = |frame_idx: usize| {
        let time = frame_idx as f32;
        let place = |scale: f32, turn: f32, at: Vec3| {
            let rotation = Quat::from_rotation_y(turn) * Quat::from_rotation_x(0.7 * turn);
            Affine3A::from_scale_rotation_translation(Vec3::splat(scale), rotation, at)
        };
        let object = |id: u32, shape: &Arc<Mesh>| GeometryObject::new(ObjectId(id), shape.clone());
        let turning = place(1.0, 0.3 * time, Vec3::new(100.0, 3.0, -80.0));
        let sliding = place(0.5, 1.0, Vec3::new(-300.0 + 0.1 * time, 5.0, 40.0));
        let mirrored = Affine3A::from_scale(Vec3::new(-3.0, 3.0, 3.0))
            * place(1.0, 0.1 * time, Vec3::new(20.0, 0.0, 30.0));
        let sheared = Affine3A::from_mat3(glam::Mat3::from_cols(Vec3::X, Vec3::ONE, Vec3::Z));
        let mut objects = vec![
            object(2, &floor),
            object(3, &first).with_transform(turning),
            object(5, &first).with_transform(sliding).with_mask(0b01),
            object(6, if frame_idx % 4 == 3 { &second } else { &first }).with_transform(mirrored),
            object(9, &second),
        ];
        if frame_idx >= 2 {
            objects.push(object(1, &second).with_transform(sheared));
        }
        if frame_idx == 3 {
            objects.remove(1);
        }
        Geometry::new(objects).unwrap()
    };
    (0..count).map(frame).collect()
}

/// Points on the objects: vertices, and middles of edges.
fn targets(rng: &mut Rng, geometry: &Geometry, count: usize) -> Vec<Vec3> {
    let one = |_| {
        let object = &geometry.objects()[rng.below(geometry.objects().len())];
        let [a, b, c] = object.shape.corners(rng.below(object.shape.triangles().len()));
        let place = object.world_from_object.unwrap_or_default();
        let [a, b, c] = [a, b, c].map(|corner| transform_point(&place, corner));
        match rng.below(4) {
            0 => a,
            1 => 0.5 * (b + c),
            _ => (a + b + c) / 3.0,
        }
    };
    (0..count).map(one).collect()
}

/// Origins around the targets, near and far.
fn origins(rng: &mut Rng, targets: &[Vec3]) -> Vec<Vec3> {
    let around = |&target: &Vec3| {
        let to = Vec3::new(rng.between(-1.0, 1.0), rng.between(0.1, 1.0), rng.between(-1.0, 1.0));
        target + to * [0.01, 1.0, 30.0, 1e4][rng.below(4)]
    };
    targets.iter().map(around).collect()
}

pub(crate) fn check(
    name: &str,
    engine: &mut dyn RayEngine,
    geometry: &Geometry,
    batch: &RayBatch<'_>,
) {
    let mut expected = HitBuffer::new(batch.len());
    definition(geometry).closest_hit(batch, &mut expected.as_hits());
    let mut found = HitBuffer::new(batch.len());
    let stats = engine.closest_hit(batch, &mut found.as_hits());
    assert_eq!(first_difference(&found, &expected), None, "{name}");
    assert_eq!(stats.rays, batch.len() as u64, "{name}");
    let mut occluded = vec![false; batch.len()];
    engine.occluded(batch, &mut occluded);
    let differs = (0..batch.len()).find(|&idx| occluded[idx] == expected.get(idx).is_miss());
    assert_eq!(differs, None, "{name}: occluded");
}

fn fact(engine: &SubfieldsEngine, name: &str) -> f64 {
    engine.facts().into_iter().find(|fact| fact.name == name).unwrap().value
}

#[test]
fn nested_objects_are_hit_as_others_are() {
    for setting in ["on-demand", "eager+40", "locked+10", "7+list"] {
        let mut rng = Rng::new(11);
        let mut engine = SubfieldsEngine::new(setting.parse().unwrap());
        let mut most_nested = 0.0_f64;
        for (frame_idx, geometry) in frames(8).iter().enumerate() {
            engine.commit(geometry, &FrameChanges::all()).unwrap();
            most_nested = most_nested.max(fact(&engine, "nested objects"));
            let targets = targets(&mut rng, geometry, 600);
            let origins = origins(&mut rng, &targets);
            let directions: Vec<Vec3> =
                targets.iter().zip(&origins).map(|(target, origin)| *target - *origin).collect();
            let name = format!("{setting}, frame {frame_idx}");
            let masks: Vec<u32> = (0..600).map(|idx| 1 + idx % 3).collect();
            let batch = RayBatch::new(&origins, &directions).unwrap();
            check(&name, &mut engine, geometry, &batch);
            check(&name, &mut engine, geometry, &batch.with_mask(&masks[..]).unwrap());

            let sun = Vec3::new(0.3, -1.0, 0.2);
            let behind: Vec<Vec3> = targets.iter().map(|target| *target - 7.0 * sun).collect();
            let batch = RayBatch::new(&behind, sun).unwrap();
            check(&format!("{name}, one direction"), &mut engine, geometry, &batch);
        }
        assert_eq!(most_nested, 4.0, "{setting}: all rocks but the sheared one");
    }
}

/// Traces rays at a rock that has moved; returns what that took a ray.
fn count_at_rock(config: &str, objects: impl Fn(f32) -> Vec<GeometryObject>) -> TraceStats {
    let mut engine = SubfieldsEngine::new(config.parse().unwrap());
    for step in 0..3 {
        let geometry = Geometry::new(objects(0.01 * step as f32)).unwrap();
        engine.commit(&geometry, &FrameChanges::all()).unwrap();
    }
    let mut rng = Rng::new(12);
    let targets: Vec<Vec3> = (0..2000)
        .map(|_| Vec3::new(rng.between(-0.5, 0.5), rng.between(-0.5, 0.5), rng.between(-0.5, 0.5)))
        .collect();
    let origins: Vec<Vec3> = targets.iter().map(|target| 3.0 * target.normalize()).collect();
    let directions: Vec<Vec3> =
        targets.iter().zip(&origins).map(|(target, origin)| *target - *origin).collect();
    let batch = RayBatch::new(&origins, &directions).unwrap();
    let mut hits = HitBuffer::new(batch.len());
    let stats = engine.closest_hit(&batch, &mut hits.as_hits());
    assert!((0..batch.len()).all(|idx| hits.get(idx).object_id == ObjectId(0)));
    stats
}

#[test]
fn a_rock_in_a_stadium_costs_as_much_as_alone() {
    let (shape, floor) = (Arc::new(rock(3)), Arc::new(ground(500.0)));
    let rock_at = |id: u32, at: Vec3| {
        GeometryObject::new(ObjectId(id), shape.clone())
            .with_transform(Affine3A::from_translation(at))
    };
    let alone = |step: f32| vec![rock_at(0, step * Vec3::X)];
    // Another rock moves half a kilometer away.
    let stadium = |step: f32| {
        let floor = GeometryObject::new(ObjectId(1), floor.clone());
        let far = rock_at(2, Vec3::new(400.0, 10.0 * step, 300.0));
        vec![rock_at(0, step * Vec3::X), floor, far]
    };
    let [alone, nested, flat] = [
        count_at_rock("40", alone),
        count_at_rock("40", stadium),
        count_at_rock("40+flat", stadium),
    ]
    .map(|stats| stats.triangle_tests);
    assert!(nested <= 2 * alone, "{nested} tests in the stadium, {alone} alone");
    assert!(flat >= 10 * nested, "{flat} tests without nesting, {nested} with");
}

#[test]
fn settings_can_turn_nesting_off() {
    let geometry = &frames(3)[2];
    let count = |config: Config| {
        let mut engine = SubfieldsEngine::new(config);
        engine.commit(geometry, &FrameChanges::all()).unwrap();
        fact(&engine, "nested objects")
    };
    assert!(count(Config::default()) > 0.0);
    assert_eq!(count("flat".parse().unwrap()), 0.0);
}
