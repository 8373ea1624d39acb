//! Geometry that moves while the sun does.

use glam::Vec3;
use jiff::civil::date;
use rayflock_engine::EngineKind;
use rayflock_geom::{FrameChanges, Geometry};
use rayflock_render::sun::{Sampling, Sides};

use crate::common::{geometry, ground, hours, in_hours, meter, shine, steps, total};

/// A plate on the ground, and a large one over it or beside it.
fn frame(is_covered: bool) -> Geometry {
    let cover = if is_covered { Vec3::Y } else { Vec3::new(1e5, 1.0, 0.0) };
    geometry(vec![ground(Vec3::ZERO, 1.0), ground(cover, 1000.0)])
}

#[test]
fn a_plate_is_dark_while_something_covers_it() {
    let steps = steps(40.0, date(2024, 5, 1));
    let mut meter = meter(EngineKind::Auto, Sampling::Faces, Sides::Both);
    let mut frames = [frame(true), frame(false)].into_iter().cycle();
    let mut covered = 0.0;
    for (idx, part) in steps.chunks(steps.len().div_ceil(6)).enumerate() {
        meter.commit(&frames.next().unwrap(), &FrameChanges::all()).unwrap();
        shine(&mut meter, part);
        if idx % 2 == 0 {
            covered += total(part);
        }
    }
    let found = in_hours(&meter);
    assert!(covered > 3.0);
    for hours in &found[..2] {
        assert!((hours - (total(&steps) - covered)).abs() < 1e-9, "{hours} without {covered}");
    }
    assert!((found[2] - total(&steps)).abs() < 1e-9, "the cover itself is lit all day");
}

#[test]
fn faces_take_their_hours_along() {
    // A wall that turns with the sun's back to it: its front is never lit.
    let steps = steps(40.0, date(2024, 5, 1));
    let mut meter = meter(EngineKind::Brute, Sampling::Faces, Sides::Front);
    for step in &steps {
        let side = step.to_sun.cross(Vec3::Y).normalize();
        let wall = crate::common::square(Vec3::ZERO, side, Vec3::Y, 1.0);
        meter.commit(&geometry(vec![wall]), &FrameChanges::all()).unwrap();
        shine(&mut meter, &[*step]);
    }
    let away = in_hours(&meter);
    let still = hours(
        &geometry(vec![crate::common::square(Vec3::ZERO, Vec3::X, Vec3::Y, 1.0)]),
        &steps,
        Sampling::Faces,
        Sides::Front,
    );
    assert!(still[0] > 3.0 && away == [0.0; 2], "{still:?} {away:?}");
}

#[test]
fn other_faces_are_an_error_and_the_frame_before_stays() {
    let two = geometry(vec![ground(Vec3::ZERO, 1.0)]);
    let four = geometry(vec![ground(Vec3::ZERO, 1.0), ground(-Vec3::Y, 1.0)]);
    for (sampling, what) in [
        (Sampling::Faces, "found 4 faces, expected 2"),
        (Sampling::Vertices, "found 8 vertices, expected 4"),
    ] {
        let mut meter = meter(EngineKind::Brute, sampling, Sides::Both);
        meter.commit(&two, &FrameChanges::all()).unwrap();
        let message = meter.commit(&four, &FrameChanges::all()).unwrap_err().to_string();
        assert!(message.starts_with(what), "{message}");
        meter.add(Vec3::Y, 60.0);
        assert!(meter.seconds().iter().all(|seconds| *seconds == 60.0));
    }
}
