//! The path tracer, where the answer is known.

use std::f32::consts::PI;

use crate::common::{
    ball, closed_room, emitter, glass, lamp, look_at, matte, mean, mirror, render, render_by,
    scene, square, sun,
};
use glam::Vec3;
use rayflock_engine::{EngineKind, create};
use rayflock_render::{Film, FrameStats, PathTracer, RenderSettings, View};
use rayflock_scene::{Background, Fresnel, LightKind, Material, Projection, Scene};

fn settings(samples_per_pixel: u32) -> RenderSettings {
    RenderSettings { samples_per_pixel, depth: 32, ..RenderSettings::default() }
}

fn paths_with(
    kind: EngineKind,
    scene: &Scene,
    view: &View,
    settings: &RenderSettings,
    size: (usize, usize),
) -> (Film, FrameStats) {
    render_by(&mut PathTracer::new(create(kind)), scene, view, settings, size)
}

fn paths(scene: &Scene, view: &View, settings: &RenderSettings, size: (usize, usize)) -> Film {
    paths_with(EngineKind::Bvh, scene, view, settings, size).0
}

fn assert_near(name: &str, found: Vec3, expected: Vec3, relative: f32) {
    let error = (found - expected).abs().max_element();
    assert!(error <= relative * expected.max_element(), "{name}: {found} instead of {expected}");
}

/// A view of nothing but the middle of a ball of radius 1.
fn on_ball() -> View {
    let projection = Projection::Orthographic { height: 1.3 };
    View::new(look_at(Vec3::Z * 8.0, Vec3::ZERO).world_from_camera, projection)
}

#[test]
fn in_a_white_furnace_lossless_materials_disappear_and_none_shines() {
    let black = matte(Vec3::ZERO);
    let varnish = Material { mirror: Vec3::splat(0.05), fresnel: Fresnel::Schlick, ..black };
    let glossy =
        Material { specular: Vec3::splat(0.8), shininess: 20.0, ..matte(Vec3::splat(0.3)) };
    let white = matte(Vec3::ONE);
    let lossless = [
        ("matte", white.clone()),
        ("mirror", mirror(1.0)),
        ("glass", glass(1.5)),
        ("half mirror", Material { mirror: Vec3::splat(0.5), ..matte(Vec3::splat(0.5)) }),
        ("varnish", Material { diffuse: Vec3::splat(0.95), ..varnish }),
        ("too bright", Material { mirror: Vec3::ONE, ..white.clone() }),
    ];
    let furnace = |material: &Material| {
        // A lamp without light keeps the key light away.
        let objects = vec![(ball(Vec3::ZERO, 1.0), material.clone())];
        let mut scene = scene(objects, vec![lamp(Vec3::Y, 0.0)]);
        scene.background = Some(Background::Uniform(Vec3::ONE));
        mean(&paths(&scene, &on_ball(), &settings(32), (12, 12)))
    };
    for (name, material) in &lossless {
        assert_near(name, furnace(material), Vec3::ONE, 0.01);
    }
    assert_near("grey", furnace(&matte(Vec3::new(0.5, 0.2, 0.8))), Vec3::new(0.5, 0.2, 0.8), 0.01);
    let lossy = [
        ("glossy", glossy),
        ("glossy white", Material { specular: Vec3::ONE, shininess: 4.0, ..white }),
        ("rough metal", Material { specular: Vec3::ONE, shininess: 1.0, ..matte(Vec3::ZERO) }),
    ];
    for (name, material) in &lossy {
        let found = furnace(material);
        assert!(found.max_element() < 1.005 && found.min_element() > 0.3, "{name}: {found}");
    }
}

#[test]
fn a_glowing_room_fills_with_the_light_of_all_bounces() {
    let reflectance = Vec3::new(0.5, 0.3, 0.1);
    let walls = Material { emission: Vec3::ONE, ..matte(reflectance) };
    let scene = scene(vec![(closed_room(), walls)], vec![]);
    let view = look_at(Vec3::new(0.2, 0.1, 0.6), Vec3::new(-0.4, -0.3, -1.0));
    let found = mean(&paths(&scene, &view, &settings(64), (8, 8)));
    assert_near("room", found, Vec3::ONE / (Vec3::ONE - reflectance), 0.02);
}

#[test]
fn without_turns_light_is_what_whitted_renders() {
    let spot = LightKind::Spot {
        position: Vec3::new(-2.0, 5.0, 2.0),
        direction: Vec3::new(0.3, -1.0, -0.3).normalize(),
        intensity: Vec3::new(40.0, 30.0, 20.0),
        cos_inner: 0.95,
        cos_outer: 0.8,
    };
    let glossy =
        Material { specular: Vec3::splat(0.3), shininess: 20.0, ..matte(Vec3::splat(0.5)) };
    let objects = vec![
        (square(Vec3::ZERO, Vec3::Y, 3.0), matte(Vec3::new(0.8, 0.6, 0.4))),
        (ball(Vec3::Y * 0.8, 0.8), glossy),
    ];
    let scene = scene(objects, vec![spot, sun(Vec3::new(-1.0, -2.0, -1.0), 2.0)]);
    let settings = RenderSettings { depth: 0, ..settings(1) };
    let view = look_at(Vec3::new(1.5, 2.5, 6.0), Vec3::new(0.0, 0.8, 0.0));
    let mut unlit = scene.clone();
    unlit.materials.iter_mut().for_each(|material| material.ambient = Vec3::ZERO);
    let expected = render(&unlit, &view, &settings, (20, 15));
    assert!(paths(&scene, &view, &settings, (20, 15)) == expected);
}

#[test]
fn an_emitter_counts_once_however_it_is_found() {
    // A large panel near the floor is found by turns, a small one far away by shadow rays.
    for (height, half) in [(0.5, 2.0), (4.0, 0.2)] {
        let panel = square(Vec3::Y * height, Vec3::NEG_Y, half);
        let floor = square(Vec3::ZERO, Vec3::Y, 1.0);
        let objects = vec![(floor, matte(Vec3::ONE)), (panel, emitter(Vec3::splat(4.0)))];
        let scene = scene(objects, vec![]);
        let view = look_at(Vec3::new(0.3, 0.3, 0.0), Vec3::ZERO);
        let by_shadow_rays = RenderSettings { light_samples: 16, ..settings(1024) };
        let expected = render(&scene, &view, &by_shadow_rays, (1, 1)).pixel(0, 0);
        // Paths that may not turn leave all of it to shadow rays.
        for depth in [0, 8] {
            let settings = RenderSettings { depth, ..settings(1024) };
            let found = paths(&scene, &view, &settings, (1, 1)).pixel(0, 0);
            assert_near("panel", Vec3::from(found), Vec3::from(expected), 0.02);
        }
    }
}

#[test]
fn of_many_lights_a_few_stand_for_all() {
    let place = |i: u32| {
        let angle = i as f32 * 2.4;
        Vec3::new(angle.cos(), 0.0, angle.sin()) * (i as f32).sqrt() * 0.1 + Vec3::Y * 2.0
    };
    let lights = (0..2000).map(|i| lamp(place(i), 0.001 * (1 + i % 5) as f32)).collect();
    let scene = scene(vec![(square(Vec3::ZERO, Vec3::Y, 3.0), matte(Vec3::ONE))], lights);
    let view = look_at(Vec3::new(0.5, 3.0, 1.0), Vec3::ZERO);
    let expected = render(&scene, &view, &settings(64), (1, 1)).pixel(0, 0);
    let found = paths(&scene, &view, &settings(64), (1, 1)).pixel(0, 0);
    assert_near("lamps", Vec3::from(found), Vec3::from(expected), 0.02);
}

#[test]
fn light_comes_around_a_corner() {
    // A lamp shines on a wall; a screen keeps it from the floor, which the wall lights.
    let objects = vec![
        (square(Vec3::ZERO, Vec3::Y, 1.0), matte(Vec3::ONE)),
        (square(Vec3::new(0.0, 1.0, 0.0), Vec3::Y, 0.2), matte(Vec3::ZERO)),
        (square(Vec3::new(1.0, 1.0, 0.0), Vec3::NEG_X, 1.0), matte(Vec3::new(1.0, 0.0, 0.0))),
    ];
    let scene = scene(objects, vec![lamp(Vec3::Y * 1.1, PI)]);
    let view = look_at(Vec3::new(0.0, 0.5, 0.0), Vec3::ZERO);
    let found = Vec3::from(paths(&scene, &view, &settings(64), (1, 1)).pixel(0, 0));
    assert!(found.x > 0.05 && found.y == 0.0, "{found}");
}

#[test]
fn neither_engine_nor_threads_nor_batches_change_a_picture() {
    let scene = rayflock_scene::builtin::build("cornell").unwrap();
    let view = View::new(scene.cameras[0].node_from_camera, scene.cameras[0].projection);
    let size = (16, 12);
    let (expected, stats) = paths_with(EngineKind::Brute, &scene, &view, &settings(2), size);
    assert_eq!(stats.trace.rays, stats.rays.total());
    assert!(stats.rays.indirect > stats.rays.primary && stats.dropped == 0);
    for thread_count in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(thread_count).build().unwrap();
        for kind in EngineKind::ALL {
            let settings = RenderSettings { batch_rays: 64, ..settings(2) };
            let (film, counted) = pool.install(|| paths_with(kind, &scene, &view, &settings, size));
            assert!(film == expected, "{kind} with {thread_count} threads");
            assert_eq!(counted.rays, stats.rays);
        }
    }
}
