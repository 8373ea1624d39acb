//! Light that mirrors and glass throw, in pictures.

use std::f32::consts::PI;

use glam::Vec3;
use rayflock_engine::EngineKind;
use rayflock_render::RenderSettings;
use rayflock_render::caustics::CausticSettings;
use rayflock_scene::{LightKind, Scene};

use crate::common::{
    ball, glass, look_at, matte, mirror, radiance, render_with, scene, square, sun,
};

fn with_photons(photons: u32) -> RenderSettings {
    let caustics = Some(CausticSettings { photons, ..CausticSettings::default() });
    RenderSettings { caustics, depth: 8, ..RenderSettings::default() }
}

/// A lamp shines into a mirror on the floor, which throws its light onto a wall.
fn mirror_below_a_wall() -> Scene {
    let direction = Vec3::new(1.0, -1.0, 0.0).normalize();
    let (position, intensity) = (Vec3::new(-1.0, 1.0, 0.0), Vec3::splat(5.0));
    let spot = LightKind::Spot { position, direction, intensity, cos_inner: 0.95, cos_outer: 0.9 };
    let floor = (square(Vec3::ZERO, Vec3::Y, 1.0), mirror(0.8));
    let wall = (square(Vec3::new(2.0, 2.0, 0.0), Vec3::NEG_X, 4.0), matte(Vec3::splat(0.5)));
    scene(vec![floor, wall], vec![spot])
}

#[test]
fn a_wall_sends_back_what_a_mirror_throws_onto_it() {
    let (scene, place) = (mirror_below_a_wall(), Vec3::new(2.0, 2.0, 0.0));
    let seen =
        |settings: &RenderSettings| radiance(&scene, Vec3::new(-1.0, 2.5, 2.0), place, settings);
    assert_eq!(seen(&RenderSettings::default()), Vec3::ZERO);
    // The lamp's image lies at (-1, -1, 0).
    let irradiance = 0.8 * 5.0 * 0.5_f32.sqrt() / 18.0;
    let expected = 0.5 * irradiance / PI;
    let found = seen(&with_photons(1 << 16));
    assert!((found / expected - 1.0).abs().max_element() < 0.01, "{found}, not {expected}");
    // Bent once, light is thrown; without any turns, it is not.
    let flat = RenderSettings { depth: 0, ..with_photons(1 << 16) };
    assert_eq!(seen(&flat), Vec3::ZERO);
}

#[test]
fn engines_threads_and_batches_change_nothing_of_it() {
    let floor = (square(Vec3::NEG_Y, Vec3::Y, 4.0), matte(Vec3::splat(0.7)));
    let scene =
        scene(vec![floor, (ball(Vec3::ZERO, 0.6), glass(1.5))], vec![sun(Vec3::NEG_Y, 1.0)]);
    let view = look_at(Vec3::new(0.0, 2.0, 4.0), Vec3::ZERO);
    let (settings, size) = (with_photons(5000), (24, 18));
    let (expected, stats) = render_with(EngineKind::Brute, &scene, &view, &settings, size);
    assert!(stats.caustics.photons > 1000 && stats.rays.indirect > 5000, "{stats:?}");
    assert_eq!(stats.trace.rays, stats.rays.total());
    let (without, _) = render_with(
        EngineKind::Brute,
        &scene,
        &view,
        &RenderSettings { caustics: None, ..settings.clone() },
        size,
    );
    assert!(without != expected);
    for (kind, threads, batch_rays) in [
        (EngineKind::Hierarchy, 1, 50),
        (EngineKind::Bvh, 2, 333),
        (EngineKind::Subfields, 2, 1 << 19),
    ] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let settings = RenderSettings { batch_rays, ..settings.clone() };
        let (film, found) = pool.install(|| render_with(kind, &scene, &view, &settings, size));
        assert!(film == expected, "{kind} with {threads} threads in batches of {batch_rays}");
        assert_eq!(found.rays, stats.rays);
    }
}
