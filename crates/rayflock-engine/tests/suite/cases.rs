//! The case files, on every engine.

use glam::Vec3;
use rayflock_engine::count_ignored;
use rayflock_geom::{FrameChanges, Geometry, RayBatch};
use rayflock_testkit::cases::{Case, CaseFrame, CaseRay, cases_folder, load_cases};

use crate::engines::Subject;

#[test]
fn every_engine_gives_the_answers_of_the_case_files() {
    let cases = load_cases(&cases_folder()).unwrap();
    for mut subject in Subject::all() {
        for case in &cases {
            check_case(&mut subject, case);
        }
    }
}

fn check_case(subject: &mut Subject, case: &Case) {
    let mut previous = Geometry::default();
    subject.commit(&previous, &FrameChanges::all());
    for (frame_idx, frame) in case.frames.iter().enumerate() {
        let context = format!("{}, frame {frame_idx}, {}", case.name, subject.name);
        let changes = FrameChanges::between(&previous, &frame.geometry);
        let stats = subject.commit(&frame.geometry, &changes);
        assert_eq!(stats.prim_count, frame.geometry.prim_count(), "{context}");
        if let Some(ignored) = frame.ignored {
            let counted = count_ignored(&frame.geometry);
            let counted = (counted.non_finite, counted.degenerate);
            assert_eq!(counted, (ignored.non_finite, ignored.degenerate), "{context}");
        }
        check_rays(subject, frame, &context);
        previous = frame.geometry.clone();
    }
}

/// All rays of a frame as one batch, then each alone.
fn check_rays(subject: &mut Subject, frame: &CaseFrame, context: &str) {
    let rays = &frame.rays;
    let column = |get: fn(&CaseRay) -> Vec3| -> Vec<Vec3> { rays.iter().map(get).collect() };
    let origins = column(|case| case.ray.origin);
    let directions = column(|case| case.ray.direction);
    let t_min: Vec<f32> = rays.iter().map(|case| case.ray.t_min).collect();
    let t_max: Vec<f32> = rays.iter().map(|case| case.ray.t_max).collect();
    let masks: Vec<u32> = rays.iter().map(|case| case.ray.mask).collect();
    let batch = RayBatch::new(&origins, &directions).unwrap();
    let batch = batch.with_interval(&t_min, &t_max).unwrap().with_mask(&masks).unwrap();

    let (hits, stats) = subject.trace(&batch);
    if let Some(invalid_rays) = frame.invalid_rays {
        assert_eq!(stats.invalid_rays, invalid_rays, "{context}");
    }
    let (occluded, _) = subject.occluded(&batch);
    for (idx, case) in rays.iter().enumerate() {
        let mut found = hits.get(idx);
        let (alone, _) = subject.trace(&batch.slice(idx, 1));
        assert_eq!(alone.get(0), found, "{context}, ray {idx} alone: {:?}", case.ray);
        assert_eq!(occluded[idx], !case.expected.is_miss(), "{context}, ray {idx}, occluded");
        if !case.has_uv {
            (found.u, found.v) = (0.0, 0.0);
        }
        assert_eq!(found, case.expected, "{context}, ray {idx}: {:?}", case.ray);
    }
}
