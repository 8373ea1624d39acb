//! Every engine, every number of threads and every picture tells the same hours.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use jiff::civil::date;
use rayflock_engine::EngineKind;
use rayflock_geom::FrameChanges;
use rayflock_render::View;
use rayflock_render::sun::{Sampling, Seen, Sides};
use rayflock_scene::{Evaluator, Projection, builtin};

use crate::common::{geometry, ground, in_hours, meter, shine, steps};

#[test]
fn every_engine_tells_the_same_hours() {
    let scene = Arc::new(builtin::build("museum3").unwrap());
    let mut evaluator = Evaluator::new(scene, None).unwrap();
    let mut steps = steps(45.0, date(2024, 8, 1));
    // Six suns see as much of the room as eighty.
    steps = steps.into_iter().step_by(14).collect();
    for sampling in [Sampling::Faces, Sampling::Vertices] {
        let mut found: Vec<(EngineKind, Vec<f64>)> = Vec::new();
        for kind in EngineKind::ALL {
            let mut meter = meter(kind, sampling, Sides::Both);
            for (time, part) in [0.0, 1.0].into_iter().zip(steps.chunks(steps.len().div_ceil(2))) {
                let frame = evaluator.evaluate(time).unwrap();
                meter.commit(&frame.geometry, &FrameChanges::all()).unwrap();
                shine(&mut meter, part);
            }
            found.push((kind, in_hours(&meter)));
        }
        let (_, expected) = &found[0];
        assert!(expected.contains(&0.0));
        assert!(expected.iter().any(|hours| *hours > 1.0));
        assert!(found.iter().all(|(_, hours)| hours == expected), "{sampling:?}: {found:?}");
    }
}

#[test]
fn a_picture_sees_the_hours_of_faces_and_between_vertices() {
    // Seen from above: the first plate fills the left half of the picture, the second hides below.
    let scene = geometry(vec![ground(Vec3::ZERO, 1.0), ground(-Vec3::Y, 2.4)]);
    let turn = Affine3A::from_rotation_x(-std::f32::consts::FRAC_PI_2);
    let eye = Affine3A::from_translation(Vec3::new(1.0, 2.0, 0.0)) * turn;
    let view = View::new(eye, Projection::Orthographic { height: 2.0 });
    for sampling in [Sampling::Faces, Sampling::Vertices] {
        let mut meter = meter(EngineKind::Brute, sampling, Sides::Both);
        meter.commit(&scene, &FrameChanges::all()).unwrap();
        meter.add(Vec3::Y, 100.0);
        let seconds = |seen: &Seen| match seen {
            Seen::Seconds(seconds) => *seconds,
            seen => panic!("{seen:?}"),
        };
        let picture = meter.see(&view, (16, 16), 0);
        let [left, right] = [4, 12].map(|x| seconds(&picture[8 * 16 + x]));
        // The middles of the second plate's faces lie below the first, its corners see the sun.
        let expected = if sampling == Sampling::Faces { 0.0 } else { 100.0 };
        assert!((left - 100.0).abs() < 1e-9 && (right - expected).abs() < 1e-9, "{left} {right}");
        let beside = View::new(Affine3A::from_translation(Vec3::Y * 50.0), view.projection);
        assert_eq!(meter.see(&beside, (2, 2), 0), [Seen::Nothing; 4]);
    }
}
