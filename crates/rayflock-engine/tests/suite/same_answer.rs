//! Every engine gives the answer of the definition, to the bit: whatever frames came before,
//! however the rays are laid out, hinted and split, at every SIMD level, on any number of threads.

use glam::Vec3;
use proptest::prelude::*;
use rayflock_geom::{
    FrameChanges, Geometry, GeometryObject, Hit, HitBuffer, Hits, Mesh, ObjectId, PrimId, RayBatch,
    RayOrder,
};
use rayflock_testkit::Rng;
use rayflock_testkit::rays::{RayForm, RaySet, every_order};
use rayflock_testkit::scenes::{SceneRecipe, scene_recipe};

use crate::engines::{Subject, definition, first_difference, seeded};

type Verdict = Result<(), String>;

/// The hits of a batch by definition: each ray alone, on an engine that knows one frame.
fn expected_hits(geometry: &Geometry, batch: &RayBatch<'_>) -> HitBuffer {
    let mut engine = definition(geometry);
    let mut hits = HitBuffer::new(batch.len());
    let mut one = HitBuffer::new(1);
    for idx in 0..batch.len() {
        one.reset(1);
        engine.closest_hit(&batch.slice(idx, 1), &mut one.as_hits());
        hits.as_hits().offer(idx, &one.get(0));
    }
    hits
}

/// What differs first, in words.
fn compare(name: &str, batch: &RayBatch<'_>, found: &HitBuffer, expected: &HitBuffer) -> Verdict {
    let Some(idx) = first_difference(found, expected) else { return Ok(()) };
    let (ray, order) = (batch.ray(idx), batch.order());
    let (found, expected) = (found.get(idx), expected.get(idx));
    Err(format!("{name}, {order:?}, ray {idx}: found {found:?}, not {expected:?}\n{ray:?}"))
}

/// Both questions, asked about the whole batch.
fn check_whole(subject: &mut Subject, batch: &RayBatch<'_>, expected: &HitBuffer) -> Verdict {
    let (found, stats) = subject.trace(batch);
    compare(&subject.name, batch, &found, expected)?;
    let (occluded, occluded_stats) = subject.occluded(batch);
    if let Some(idx) = (0..batch.len()).find(|&i| occluded[i] == expected.get(i).is_miss()) {
        let name = format!("{}, occluded is {}", subject.name, occluded[idx]);
        return Err(format!("{name}: ray {idx} should hit {:?}", expected.get(idx)));
    }
    for stats in [stats, occluded_stats] {
        if stats.rays != batch.len() as u64 {
            return Err(format!("{}: {} of {} rays", subject.name, stats.rays, batch.len()));
        }
    }
    Ok(())
}

/// The batch in pieces of random lengths.
fn check_split(
    subject: &mut Subject,
    rng: &mut Rng,
    batch: &RayBatch<'_>,
    expected: &HitBuffer,
) -> Verdict {
    let mut joined = HitBuffer::new(batch.len());
    let mut start = 0;
    while start < batch.len() {
        let len = (1 + rng.below(100)).min(batch.len() - start);
        let (piece, _) = subject.trace(&batch.slice(start, len));
        for idx in 0..len {
            joined.as_hits().offer(start + idx, &piece.get(idx));
        }
        start += len;
    }
    compare(&format!("{} in pieces", subject.name), batch, &joined, expected)
}

/// Hits that another engine might have found before: nearer, equally near, farther, or none.
fn earlier_hits(rng: &mut Rng, expected: &HitBuffer) -> HitBuffer {
    let mut earlier = HitBuffer::new(expected.len());
    for idx in 0..expected.len() {
        let hit = expected.get(idx);
        let t = match rng.below(5) {
            0 => continue,
            1 => 0.5 * hit.t,
            2 => 2.0 * hit.t,
            _ if hit.is_miss() => 3.0,
            _ => hit.t,
        };
        let (object_id, prim_id) = (ObjectId(rng.below(12) as u32), PrimId(rng.below(5) as u32));
        let other = Hit { t, u: 0.125, v: 0.25, object_id, prim_id };
        earlier.as_hits().offer(idx, &other);
    }
    earlier
}

/// Hits that are there already stay unless the engine's are nearer; absent columns change nothing.
fn check_earlier_hits(
    subject: &mut Subject,
    rng: &mut Rng,
    batch: &RayBatch<'_>,
    expected: &HitBuffer,
) -> Verdict {
    let earlier = earlier_hits(rng, expected);
    let (mut found, mut wanted) = (earlier.clone(), earlier.clone());
    subject.trace_into(batch, &mut found);
    for idx in 0..batch.len() {
        wanted.as_hits().offer(idx, &expected.get(idx));
    }
    compare(&format!("{} after earlier hits", subject.name), batch, &found, &wanted)?;

    let mut t = earlier.t;
    subject.engine().closest_hit(batch, &mut Hits::distances(&mut t));
    match (0..t.len()).find(|&idx| t[idx].to_bits() != wanted.t[idx].to_bits()) {
        Some(idx) => Err(format!("{}: t of ray {idx} without ids: {}", subject.name, t[idx])),
        None => Ok(()),
    }
}

/// A batch of one form, or a picture.
fn random_set(rng: &mut Rng, geometry: &Geometry, len: usize) -> RaySet {
    match rng.below(8) {
        0 => RaySet::pinhole(rng, geometry, [len / 16, 16], 0),
        1 => RaySet::pinhole(rng, geometry, [len.div_ceil(64) * 8, 8], 8),
        _ => {
            let form = rng.pick(&RayForm::ALL);
            RaySet::random(rng, geometry, form, len)
        }
    }
}

/// Runs engines through all frames of a recipe, half of them with exact changes.
fn check_frames(
    mut subjects: Vec<Subject>,
    recipe: &SceneRecipe,
    frame_count: usize,
    len: usize,
) -> Verdict {
    let mut rng = Rng::new(recipe.seed ^ 0x5eed);
    let mut previous = Geometry::default();
    for (frame_idx, geometry) in recipe.frames(frame_count).into_iter().enumerate() {
        let exact = FrameChanges::between(&previous, &geometry);
        let sets: Vec<RaySet> = (0..2).map(|_| random_set(&mut rng, &geometry, len)).collect();
        let expected: Vec<_> =
            sets.iter().map(|set| expected_hits(&geometry, &set.batch())).collect();
        for (subject_idx, subject) in subjects.iter_mut().enumerate() {
            let exactly = (subject_idx / 2 + frame_idx) % 2 == 0;
            let changes = if exactly { exact.clone() } else { FrameChanges::all() };
            subject.commit(&geometry, &changes);
            for (set, expected) in sets.iter().zip(&expected) {
                let order = rng.pick(&every_order(len));
                let batch = set.batch();
                check_whole(subject, &batch, expected)
                    .and_then(|()| check_whole(subject, &batch.with_order(order), expected))
                    .and_then(|()| check_split(subject, &mut rng, &batch, expected))
                    .and_then(|()| check_earlier_hits(subject, &mut rng, &batch, expected))
                    .map_err(|fault| {
                        format!("frame {frame_idx}, exact changes {exactly}: {fault}")
                    })?;
            }
        }
        previous = geometry;
    }
    Ok(())
}

proptest! {
    #![proptest_config(seeded(40, 2))]

    #[test]
    fn engines_agree_on_random_frames(recipe in scene_recipe(5, 40)) {
        if let Err(fault) = check_frames(Subject::all(), &recipe, 4, 130) {
            prop_assert!(false, "{fault}");
        }
    }
}

proptest! {
    #![proptest_config(seeded(10, 3))]

    #[test]
    fn engines_agree_under_every_setting(recipe in scene_recipe(5, 40)) {
        if let Err(fault) = check_frames(Subject::with_settings(), &recipe, 4, 130) {
            prop_assert!(false, "{fault}");
        }
    }
}

/// A sheet of triangles that waves over `frame_count` frames. One triangle degenerates in frame 6
/// and comes back; in frame 9 all vertices change places.
fn waving_sheet(frame_count: usize) -> Vec<Geometry> {
    const SIDE: u32 = 24;
    let corner = |column: u32, row: u32| column * (SIDE + 1) + row;
    let triangles: Vec<[u32; 3]> = (0..SIDE * SIDE)
        .map(|idx| (idx / SIDE, idx % SIDE))
        .flat_map(|(x, y)| {
            let [a, b] = [corner(x, y), corner(x + 1, y)];
            [[a, b, corner(x + 1, y + 1)], [a, corner(x + 1, y + 1), corner(x, y + 1)]]
        })
        .collect();
    let mut sheet = None;
    let frame = |frame_idx: usize| {
        let height = |x: f32, y: f32| 0.2 * (3.0 * x + y + 0.3 * frame_idx as f32).sin();
        let place = |idx: u32| [idx / (SIDE + 1), idx % (SIDE + 1)].map(|i| i as f32 / SIDE as f32);
        let mut vertices: Vec<Vec3> = (0..(SIDE + 1) * (SIDE + 1))
            .map(place)
            .map(|[x, y]| Vec3::new(x, y, height(x, y)))
            .collect();
        if frame_idx == 6 {
            vertices[0] = vertices[1];
        } else if frame_idx == 9 {
            let len = vertices.len();
            vertices = (0..len).map(|idx| vertices[idx * 7 % len]).collect();
        }
        let sheet = sheet.get_or_insert_with(|| {
            Mesh::from_triangles(vertices.clone(), triangles.clone()).unwrap()
        });
        let sheet = sheet.with_vertices(vertices).unwrap();
        Geometry::new(vec![GeometryObject::new(ObjectId(0), sheet)]).unwrap()
    };
    (0..frame_count).map(frame).collect()
}

/// Long enough for what engines keep from frame to frame to be kept, improved and given up.
#[test]
fn engines_agree_on_a_sheet_that_waves() {
    let mut rng = Rng::new(6);
    let mut subjects = Subject::all();
    let mut previous = Geometry::default();
    for (frame_idx, geometry) in waving_sheet(12).into_iter().enumerate() {
        let changes = FrameChanges::between(&previous, &geometry);
        let set = random_set(&mut rng, &geometry, 256);
        let expected = expected_hits(&geometry, &set.batch());
        for subject in &mut subjects {
            subject.commit(&geometry, &changes);
            let verdict = check_whole(subject, &set.batch(), &expected);
            assert_eq!(verdict, Ok(()), "frame {frame_idx}");
        }
        previous = geometry;
    }
}

/// More rays and primitives than one tile, block or task holds.
#[test]
fn engines_agree_on_large_batches() {
    for (seed, size, offset) in [(1, 1.0, 0.0), (2, 1e4, 100.0), (3, 1e-3, 10.0)] {
        let recipe = SceneRecipe { seed, object_count: 8, prim_count: 300, size, offset };
        assert_eq!(check_frames(Subject::all(), &recipe, 2, 2048), Ok(()), "{recipe:?}");
    }
}

#[test]
fn engines_agree_under_every_hint() {
    let recipe = SceneRecipe { seed: 4, object_count: 6, prim_count: 50, size: 1.0, offset: 0.0 };
    let geometry = recipe.geometry();
    let mut rng = Rng::new(5);
    for mut subject in Subject::all() {
        subject.commit(&geometry, &FrameChanges::all());
        for form in RayForm::ALL {
            for len in [1, 15, 16, 17, 64, 200] {
                let set = RaySet::random(&mut rng, &geometry, form, len);
                let expected = expected_hits(&geometry, &set.batch());
                for order in every_order(len) {
                    let batch = set.batch().with_order(order);
                    assert_eq!(check_whole(&mut subject, &batch, &expected), Ok(()), "{form:?}");
                }
            }
        }
    }
}

/// A camera's image is taken for a lattice after a look at some rays: one ray that goes elsewhere
/// must not be lost, nor rays that are invalid or switched off.
#[test]
fn engines_agree_on_images_with_a_ray_astray() {
    let recipe = SceneRecipe { seed: 9, object_count: 6, prim_count: 60, size: 1.0, offset: 0.0 };
    let geometry = recipe.geometry();
    let (width, height) = (38, 22);
    let eye = Vec3::new(0.1, 0.2, 3.0);
    let straight: Vec<Vec3> = (0..width * height)
        .map(|idx| {
            let (x, y) = ((idx % width) as f32 - 18.5, (idx / width) as f32 - 10.5);
            Vec3::new(0.05 * x, -0.05 * y, -1.0)
        })
        .collect();
    let astray = [
        None,
        Some((5 * width + 3, Vec3::new(0.3, 0.3, -1.0))),
        Some((5 * width + 3, straight[5 * width + 4])),
        Some((9 * width + 30, Vec3::Z)),
        Some((9 * width + 30, Vec3::NAN)),
        Some((0, Vec3::new(-2.0, 1.0, -1.0))),
    ];
    let mut subjects = Subject::all();
    for subject in &mut subjects {
        subject.commit(&geometry, &FrameChanges::all());
    }
    for one in astray {
        let mut directions = straight.clone();
        if let Some((idx, direction)) = one {
            directions[idx] = direction;
        }
        let order = RayOrder::Image { width, height, tile: 0 };
        let batch = RayBatch::new(eye, &directions).unwrap().with_order(order);
        let expected = expected_hits(&geometry, &batch);
        let hit_count = (0..batch.len()).filter(|&idx| !expected.get(idx).is_miss()).count();
        assert!(hit_count > 40, "{hit_count} hits say little");
        for subject in &mut subjects {
            assert_eq!(check_whole(subject, &batch, &expected), Ok(()), "{one:?}");
        }
    }
}
