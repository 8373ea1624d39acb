//! How near spheres come to what is exactly in the way.

use rayflock_engine::{EngineKind, create};

use super::common::{
    exact, frame, irradiances, lights_on_surfaces, past_spheres, seen_points, spheres_of,
};

/// Relative root mean squared error of the irradiance from all lights.
fn error(found: &[f32], expected: &[f32]) -> f32 {
    let squared: f32 = found.iter().zip(expected).map(|(a, b)| (a - b) * (a - b)).sum();
    let scale: f32 = expected.iter().map(|b| b * b).sum();
    (squared / scale).sqrt()
}

#[test]
fn spheres_take_away_about_as_much_light_as_what_they_stand_for() {
    // As many spheres and the error they are allowed, from few lights that all cast hard shadows.
    for (scene, time, count, most) in
        [("cornell", 1.0, 64, 0.06), ("crowd", 1.0, 512, 0.20), ("museum5", 8.0, 1024, 0.15)]
    {
        let frame = frame(scene, time);
        let mut engine = create(EngineKind::Auto);
        let points = seen_points(scene, &frame, &mut *engine, 48);
        let lights = lights_on_surfaces(&frame, &mut *engine, &points, 64);
        let size = frame.geometry.bounds().size().length();
        let exact = exact(&points, &lights, &frame);
        let expected = irradiances(&points, &lights, &exact, size);
        let without =
            error(&irradiances(&points, &lights, &vec![1.0; exact.len()], size), &expected);
        let past = |count: usize| {
            let shares = past_spheres(&points, &lights, &spheres_of(&frame, count), 64);
            error(&irradiances(&points, &lights, &shares, size), &expected)
        };
        let (few, many) = (past(count / 8), past(count));
        assert!(many < most && many < 0.6 * without, "{scene}: {many} of {without}");
        assert!(many < few, "{scene}: {many} with {count} spheres, {few} with an eighth");
    }
}

#[test]
fn tiles_change_nothing() {
    let frame = frame("crowd", 2.0);
    let mut engine = create(EngineKind::Auto);
    let points = seen_points("crowd", &frame, &mut *engine, 24);
    let lights = lights_on_surfaces(&frame, &mut *engine, &points, 24);
    let spheres = spheres_of(&frame, 300);
    let small = past_spheres(&points, &lights, &spheres, 16);
    let large = past_spheres(&points, &lights, &spheres, 512);
    let differ = small.iter().zip(&large).filter(|(a, b)| (*a - *b).abs() > 1e-3).count();
    assert_eq!(differ, 0, "of {}", small.len());
    assert!(small.iter().any(|share| *share > 0.1 && *share < 0.9));
}
