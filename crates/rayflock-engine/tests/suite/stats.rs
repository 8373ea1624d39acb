//! What engines count, and what they do with nothing.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use rayflock_engine::{Ignored, TraceStats, count_ignored};
use rayflock_geom::{
    FrameChanges, Geometry, GeometryObject, HitBuffer, Hits, Mesh, ObjectId, RayBatch, Sphere,
};
use rayflock_testkit::Rng;
use rayflock_testkit::scenes::{SoupKind, UserBoxes, triangle_soup};

use crate::engines::Subject;

const INVALID: [Vec3; 4] =
    [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY, Vec3::new(1.0, f32::NEG_INFINITY, 0.0)];

fn scene() -> Geometry {
    let mut rng = Rng::new(31);
    let soup = triangle_soup(&mut rng, SoupKind::Plain, 50, Vec3::ZERO, 1.0);
    Geometry::new(vec![GeometryObject::new(ObjectId(0), soup)]).unwrap()
}

#[test]
fn invalid_rays_are_counted_and_inactive_ones_are_not() {
    let mut directions = vec![Vec3::X; 100];
    let mut t_max = vec![f32::INFINITY; 100];
    for (idx, direction) in INVALID.into_iter().enumerate() {
        directions[7 + 17 * idx] = direction;
    }
    t_max[90] = f32::NAN;
    t_max[3] = -1.0;
    let origins = vec![Vec3::ZERO; 100];
    let shared = RayBatch::new(Vec3::ZERO, &directions).unwrap();
    let own = RayBatch::new(&origins, &directions).unwrap();
    for mut subject in Subject::all() {
        subject.commit(&scene(), &FrameChanges::all());
        for batch in [shared, own] {
            let batch = batch.with_interval(0.0, &t_max).unwrap();
            let (_, stats) = subject.trace(&batch);
            assert_eq!((stats.rays, stats.invalid_rays), (100, 5), "{}", subject.name);
            let (_, stats) = subject.occluded(&batch);
            assert_eq!((stats.rays, stats.invalid_rays), (100, 5), "{}", subject.name);
        }
    }
}

#[test]
fn a_batch_with_an_invalid_shared_column_is_all_invalid() {
    let rays = vec![Vec3::X; 33];
    for mut subject in Subject::all() {
        subject.commit(&scene(), &FrameChanges::all());
        for invalid in INVALID {
            let (hits, stats) = subject.trace(&RayBatch::new(&rays, invalid).unwrap());
            assert_eq!(stats.invalid_rays, 33, "{}, direction {invalid}", subject.name);
            assert!((0..33).all(|idx| hits.get(idx).is_miss()));
        }
        let (_, stats) = subject.trace(&RayBatch::new(Vec3::NAN, &rays).unwrap());
        assert_eq!(stats.invalid_rays, 33, "{}, shared origin", subject.name);
    }
}

#[test]
fn ignored_primitives_are_counted_and_not_hit_frame_after_frame() {
    let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::NAN, 2.0 * Vec3::X];
    let faces = vec![[0, 1, 2], [0, 1, 4], [0, 0, 2], [0, 1, 3]];
    let broken = Mesh::from_triangles(vertices, faces).unwrap().with_spheres(vec![
        Sphere::new(Vec3::ZERO, 1.0),
        Sphere::new(Vec3::ZERO, 0.0),
        Sphere::new(Vec3::INFINITY, 1.0),
    ]);
    let broken = Arc::new(broken);
    let object = |id: u32| GeometryObject::new(ObjectId(id), Arc::clone(&broken));
    let one = Geometry::new(vec![object(1)]).unwrap();
    let two = Geometry::new(vec![object(1), object(2)]).unwrap();
    for (frame, times) in [(&one, 1), (&two, 2), (&Geometry::default(), 0)] {
        let expected = Ignored { non_finite: 2 * times, degenerate: 3 * times };
        assert_eq!(count_ignored(frame), expected);
    }
    for mut subject in Subject::all() {
        let mut previous = Geometry::default();
        for (frame, times) in
            [(&one, 1), (&two, 2), (&two, 2), (&one, 1), (&Geometry::default(), 0)]
        {
            let stats = subject.commit(frame, &FrameChanges::between(&previous, frame));
            assert_eq!(stats.prim_count, 7 * times, "{}", subject.name);
            previous = frame.clone();
        }
    }
}

#[test]
fn an_unchanged_frame_rewrites_nothing() {
    let geometry = scene();
    for mut subject in Subject::all() {
        let first = subject.commit(&geometry, &FrameChanges::all());
        assert_eq!(first.rewritten_count, 50, "{}", subject.name);
        let again = subject.commit(&geometry, &FrameChanges::between(&geometry, &geometry));
        assert_eq!(again.rewritten_count, 0, "{}", subject.name);
    }
}

/// An object that appears, is masked out, moves, becomes another mesh and vanishes, all under the
/// claim that nothing changed.
#[test]
fn a_false_claim_that_nothing_changed_does_no_harm() {
    let sphere =
        |distance: f32| Arc::new(Mesh::from_spheres(vec![Sphere::new(distance * Vec3::X, 1.0)]));
    let object = GeometryObject::new(ObjectId(0), sphere(3.0));
    let moved = object.clone().with_transform(Affine3A::from_translation(Vec3::X));
    let frames = [
        (vec![object.clone()], 2.0),
        (vec![object.clone().with_mask(2)], f32::INFINITY),
        (vec![object], 2.0),
        (vec![moved], 3.0),
        (vec![GeometryObject::new(ObjectId(0), sphere(6.0))], 5.0),
        (Vec::new(), f32::INFINITY),
    ];
    let rays = vec![Vec3::X; 40];
    let batch = RayBatch::new(Vec3::ZERO, &rays).unwrap().with_mask(1).unwrap();
    for mut subject in Subject::all() {
        for (step, (objects, t)) in frames.iter().enumerate() {
            let frame = Geometry::new(objects.clone()).unwrap();
            subject.commit(&frame, &FrameChanges::none());
            let (hits, _) = subject.trace(&batch);
            assert_eq!(hits.t, [*t; 40], "{}, step {step}", subject.name);
        }
    }
}

/// An object that is hidden by a scale of zero, rests so, shows itself, moves, hides and vanishes.
#[test]
fn nothing_stays_of_what_was_hidden() {
    let corners = vec![Vec3::new(3.0, -9.0, -9.0), Vec3::new(3.0, 9.0, -9.0), 3.0 * Vec3::ONE];
    let wall = Arc::new(Mesh::from_triangles(corners, vec![[0, 1, 2]]).unwrap());
    let object = |place: Affine3A| {
        vec![GeometryObject::new(ObjectId(0), Arc::clone(&wall)).with_transform(place)]
    };
    let hidden = || object(Affine3A::from_scale(Vec3::ZERO));
    let frames = [
        (hidden(), f32::INFINITY),
        (hidden(), f32::INFINITY),
        (object(Affine3A::IDENTITY), 3.0),
        (object(Affine3A::from_translation(Vec3::X)), 4.0),
        (hidden(), f32::INFINITY),
        (Vec::new(), f32::INFINITY),
    ];
    let rays = vec![Vec3::X; 40];
    let batch = RayBatch::new(Vec3::NEG_Z, &rays).unwrap();
    for mut subject in Subject::all() {
        let mut previous = Geometry::default();
        for (step, (objects, t)) in frames.iter().enumerate() {
            let frame = Geometry::new(objects.clone()).unwrap();
            subject.commit(&frame, &FrameChanges::between(&previous, &frame));
            let (hits, _) = subject.trace(&batch);
            assert_eq!(hits.t, [*t; 40], "{}, step {step}", subject.name);
            previous = frame;
        }
    }
}

#[test]
fn nothing_is_hit_where_nothing_is() {
    let empty_objects = (0..3).map(|id| GeometryObject::new(ObjectId(id), Mesh::default()));
    let empty_user = Mesh::from_user(Arc::new(UserBoxes(Vec::new())));
    let frames = [
        Geometry::default(),
        Geometry::new(empty_objects.collect()).unwrap(),
        Geometry::new(vec![GeometryObject::new(ObjectId(8), empty_user)]).unwrap(),
    ];
    let rays = vec![Vec3::X; 100];
    for mut subject in Subject::all() {
        // Before the first commit there is an empty frame.
        let batch = RayBatch::new(Vec3::ZERO, &rays).unwrap();
        assert_eq!(subject.trace(&batch).0, HitBuffer::new(100), "{}", subject.name);
        for frame in &frames {
            let stats = subject.commit(frame, &FrameChanges::all());
            assert_eq!(stats.prim_count, 0, "{}", subject.name);
            assert_eq!(subject.trace(&batch).0, HitBuffer::new(100), "{}", subject.name);
            assert!(!subject.occluded(&batch).0.contains(&true), "{}", subject.name);
        }
    }
}

#[test]
fn no_rays_are_no_work() {
    let none: &[Vec3] = &[];
    for mut subject in Subject::all() {
        subject.commit(&scene(), &FrameChanges::all());
        for batch in [
            RayBatch::new(none, none).unwrap(),
            RayBatch::new(Vec3::ZERO, none).unwrap(),
            RayBatch::new(none, Vec3::X).unwrap(),
        ] {
            assert_eq!(subject.trace(&batch).1, TraceStats::default(), "{}", subject.name);
            assert_eq!(subject.occluded(&batch).1, TraceStats::default(), "{}", subject.name);
        }
    }
}

#[test]
fn two_uniform_columns_are_one_ray() {
    for mut subject in Subject::all() {
        let sphere = Mesh::from_spheres(vec![Sphere::new(4.0 * Vec3::Z, 1.0)]);
        let object = GeometryObject::new(ObjectId(6), sphere);
        subject.commit(&Geometry::new(vec![object]).unwrap(), &FrameChanges::all());
        let batch = RayBatch::new(Vec3::ZERO, Vec3::Z).unwrap();
        assert_eq!(subject.trace(&batch).0.get(0).t, 3.0, "{}", subject.name);
        assert_eq!(subject.occluded(&batch).0, [true], "{}", subject.name);
    }
}

#[test]
fn columns_of_another_length_are_refused() {
    let rays = vec![Vec3::X; 3];
    let batch = RayBatch::new(Vec3::ZERO, &rays).unwrap();
    for mut subject in Subject::best() {
        let mut ask = |question: &mut dyn FnMut(&mut dyn rayflock_engine::RayEngine)| {
            let call = std::panic::AssertUnwindSafe(|| question(subject.engine()));
            std::panic::catch_unwind(call).is_err()
        };
        assert!(ask(&mut |engine| {
            engine.closest_hit(&batch, &mut Hits::distances(&mut [0.0; 2]));
        }));
        assert!(ask(&mut |engine| {
            engine.occluded(&batch, &mut [false; 4]);
        }));
    }
}
