//! Virtual lights against the path tracer, and what may go wrong with them.

use crate::common::{
    add_surface, ball, closed_room, emitter, glass, lamp, look_at, matte, mean, mirror, render_by,
    render_with, scene, square, sun,
};
use glam::Vec3;
use rayflock_engine::{EngineKind, create};
use rayflock_render::occluders::SphereSettings;
use rayflock_render::vpl::{Visibility, VplSettings};
use rayflock_render::{Film, FrameStats, Indirect, PathTracer, RenderSettings, View};
use rayflock_scene::{Background, Fresnel, LightKind, Material, MaterialIdx, Scene, SurfaceMesh};

const SIZE: (usize, usize) = (12, 9);

fn vpl(light_count: u32) -> RenderSettings {
    let indirect = Indirect::Vpl(VplSettings { light_count, ..VplSettings::default() });
    RenderSettings { indirect, samples_per_pixel: 4, ..RenderSettings::default() }
}

fn gathered(scene: &Scene, view: &View, settings: &RenderSettings) -> (Film, FrameStats) {
    let (film, stats) = render_with(EngineKind::Bvh, scene, view, settings, SIZE);
    assert_eq!(stats.dropped, 0);
    assert!(film.pixels().iter().flatten().all(|value| value.is_finite()));
    (film, stats)
}

/// A room with a ball and a block in it, all matte.
fn room(lights: Vec<LightKind>, of_ball: Material) -> Scene {
    let mut scene = scene(
        vec![
            (closed_room(), matte(Vec3::new(0.7, 0.6, 0.5))),
            (ball(Vec3::new(0.3, -0.6, -0.3), 0.35), of_ball),
            (square(Vec3::new(-0.45, -0.2, -0.2), Vec3::X, 0.4), matte(Vec3::new(0.6, 0.1, 0.1))),
        ],
        lights,
    );
    scene.ambient = Vec3::ONE;
    scene
}

fn in_room() -> View {
    look_at(Vec3::new(0.1, 0.2, 0.95), Vec3::new(0.0, -0.3, -0.5))
}

/// Lets the picture by virtual lights be that of the path tracer but for the light that the
/// bound keeps away, as a whole and pixel by pixel.
fn assert_like_paths(name: &str, scene: &Scene, view: &View) {
    let (film, stats) = gathered(scene, view, &vpl(6000));
    let settings =
        RenderSettings { samples_per_pixel: 256, depth: 32, ..RenderSettings::default() };
    let mut tracer = PathTracer::new(create(EngineKind::Bvh));
    let (expected, _) = render_by(&mut tracer, scene, view, &settings, SIZE);

    let pixel_count = (SIZE.0 * SIZE.1 * 4) as f64;
    let clamped = (stats.indirect.clamped / pixel_count) as f32;
    assert!(stats.indirect.clamped_share() < 0.05, "{name}: {:?}", stats.indirect);
    let (found, wanted) = (mean(&film).element_sum() + clamped, mean(&expected).element_sum());
    assert!((found / wanted - 1.0).abs() < 0.02, "{name}: {found} instead of {wanted}");
    let length = |film: &Film, other: Option<&Film>| {
        let others = other.map_or(vec![[0.0; 3]; film.pixels().len()], |o| o.pixels().to_vec());
        let pairs = film.pixels().iter().zip(others);
        pairs.map(|(a, b)| (Vec3::from(*a) - Vec3::from(b)).length_squared()).sum::<f32>().sqrt()
    };
    let error = length(&film, Some(&expected)) / length(&expected, None);
    assert!(error < 0.1, "{name}: pixels differ by {error}");
}

#[test]
fn lamps_spots_and_panels_light_a_room_as_paths_do() {
    let grey = matte(Vec3::splat(0.5));
    let high = Vec3::new(-0.3, 0.7, 0.2);
    let spot = LightKind::Spot {
        position: high,
        direction: Vec3::new(0.5, -1.0, -0.5).normalize(),
        intensity: Vec3::new(3.0, 2.5, 2.0),
        cos_inner: 0.9,
        cos_outer: 0.7,
    };
    assert_like_paths("lamp", &room(vec![lamp(high, 1.0)], grey.clone()), &in_room());
    assert_like_paths("spot", &room(vec![spot], grey.clone()), &in_room());
    let mut lit = room(vec![], grey);
    lit.materials.push(emitter(Vec3::splat(6.0)));
    let panel = SurfaceMesh::new(square(Vec3::Y * 0.98, Vec3::Y, 0.3), MaterialIdx(3));
    add_surface(&mut lit, panel);
    assert_like_paths("panel", &lit, &in_room());
}

#[test]
fn highlights_and_varnish_send_light_on_as_paths_have_it() {
    let base = matte(Vec3::new(0.5, 0.3, 0.2));
    let glossy = Material { specular: Vec3::splat(0.4), shininess: 10.0, ..base.clone() };
    let varnished = Material { mirror: Vec3::splat(0.02), fresnel: Fresnel::Schlick, ..base };
    let lamp = lamp(Vec3::new(-0.3, 0.7, 0.2), 1.0);
    let mut scene = room(vec![lamp], varnished);
    scene.materials[0] = Material { diffuse: Vec3::splat(0.5), ..glossy };
    assert_like_paths("glossy", &scene, &in_room());
}

#[test]
fn sun_and_sky_light_what_is_in_the_open() {
    let objects = vec![
        (square(Vec3::ZERO, Vec3::Y, 3.0), matte(Vec3::splat(0.6))),
        (ball(Vec3::Y * 0.8, 0.8), matte(Vec3::new(0.7, 0.2, 0.2))),
    ];
    let mut scene = scene(objects, vec![sun(Vec3::new(-1.0, -2.0, -1.0), 2.0)]);
    scene.background = Some(Background::Gradient {
        zenith: Vec3::new(0.2, 0.4, 0.8),
        horizon: Vec3::splat(0.6),
        ground: Vec3::splat(0.1),
    });
    let view = look_at(Vec3::new(1.5, 2.5, 3.0), Vec3::new(0.0, 0.6, 0.0));
    assert_like_paths("open", &scene, &view);
}

#[test]
fn a_slow_ball_does_not_make_the_walls_flicker() {
    let settings = RenderSettings { samples_per_pixel: 1, ..vpl(512) };
    let mut before: Option<Film> = None;
    for frame in 0..60 {
        let mut scene = room(vec![lamp(Vec3::new(-0.3, 0.7, 0.2), 1.0)], matte(Vec3::splat(0.5)));
        let center = Vec3::new(0.3 - 0.002 * frame as f32, -0.6, -0.3);
        let moved = SurfaceMesh::new(ball(center, 0.2), MaterialIdx(1));
        scene.objects[1].shape = rayflock_scene::Shape::Fixed(moved);
        // The upper part of the picture: walls that see the ball, but are not in its shadow.
        let view = look_at(Vec3::new(0.1, 0.2, 0.95), Vec3::new(0.0, 0.5, -0.5));
        let (film, _) = gathered(&scene, &view, &settings);
        if let Some(before) = &before {
            let changes = film.pixels().iter().zip(before.pixels());
            let changes = changes.map(|(a, b)| (a[1] - b[1]).abs() / b[1]);
            let mean = changes.sum::<f32>() / film.pixels().len() as f32;
            assert!(mean < 0.005, "frame {frame}: walls change by {mean}");
        }
        before = Some(film);
    }
}

#[test]
fn the_light_kept_away_shrinks_as_lights_grow() {
    let scene = room(vec![lamp(Vec3::new(-0.3, 0.7, 0.2), 1.0)], matte(Vec3::splat(0.5)));
    let share = |count| gathered(&scene, &in_room(), &vpl(count)).1.indirect.clamped_share();
    let (few, many) = (share(64), share(4096));
    assert!(many < 0.5 * few && few > 0.0, "{few} with 64 lights, {many} with 4096");
}

#[test]
fn light_reaches_what_is_seen_in_a_mirror_and_through_glass() {
    // The floor under the screen gets no light but from the wall.
    let objects = |material: Material| {
        vec![
            (square(Vec3::ZERO, Vec3::Y, 1.0), matte(Vec3::ONE)),
            (square(Vec3::Y, Vec3::Y, 0.4), matte(Vec3::ZERO)),
            (square(Vec3::X, Vec3::NEG_X, 1.0), matte(Vec3::ONE)),
            (square(Vec3::new(0.0, 0.5, -0.5), Vec3::Z, 0.1), material),
        ]
    };
    let clear = Material { transmission: Vec3::ONE, ior: 1.0, ..matte(Vec3::ZERO) };
    let views = [
        (mirror(1.0), look_at(Vec3::new(0.0, 0.6, 0.2), Vec3::new(0.0, 0.5, -0.5))),
        (clear, look_at(Vec3::new(0.0, 0.6, -0.8), Vec3::new(0.0, 0.5, -0.5))),
    ];
    for (material, view) in views {
        let scene = scene(objects(material), vec![lamp(Vec3::Y * 1.2, 1.0)]);
        let (_, stats) = gathered(&scene, &view, &vpl(256));
        let turned = stats.rays.mirror + stats.rays.refraction;
        assert!(turned > 0 && stats.indirect.gathered > 0.0, "{stats:?}");
    }
}

#[test]
fn neither_engine_nor_threads_nor_batches_change_a_picture() {
    let scene = rayflock_scene::builtin::build("cornell").unwrap();
    let view = View::new(scene.cameras[0].node_from_camera, scene.cameras[0].projection);
    let settings = RenderSettings { samples_per_pixel: 1, ..vpl(48) };
    let (expected, stats) = render_with(EngineKind::Brute, &scene, &view, &settings, SIZE);
    assert_eq!(stats.trace.rays, stats.rays.total());
    assert!(stats.indirect.lights > 24 && stats.indirect.gathered > 0.0);
    for thread_count in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(thread_count).build().unwrap();
        for kind in EngineKind::ALL {
            let settings = RenderSettings { batch_rays: 40, ..settings.clone() };
            let (film, _) = pool.install(|| render_with(kind, &scene, &view, &settings, SIZE));
            assert!(film == expected, "{kind} with {thread_count} threads");
        }
    }
}

#[test]
fn scenes_with_nothing_to_gather_are_rendered_all_the_same() {
    let lit = |lights| room(lights, matte(Vec3::splat(0.5)));
    let bright = lamp(Vec3::new(-0.3, 0.7, 0.2), 1.0);
    let mut black = lit(vec![bright]);
    black.materials.iter_mut().for_each(|material| material.diffuse = Vec3::ZERO);
    let empty = Scene::default();
    let mut glowing = lit(vec![]);
    glowing.materials[1].emission = Vec3::ONE;
    let mut encased = room(vec![lamp(Vec3::new(0.3, -0.6, -0.3), 1.0)], glass(1.5));
    encased.background = None;
    let swarm = (0..3000).map(|i| lamp(Vec3::new(-0.3, 0.7, 0.2) * (i as f32 / 3e3), 1e-3));
    let cases = [
        ("no virtual lights", lit(vec![bright]), 0, false),
        ("black", black, 64, false),
        ("dark lamp", lit(vec![lamp(Vec3::ZERO, 0.0)]), 64, false),
        ("no geometry", empty, 64, false),
        ("key light outside", lit(vec![]), 64, false),
        ("emission only", glowing, 64, true),
        ("lamp inside glass", encased, 64, true),
        ("thousands of lamps", lit(swarm.collect()), 64, true),
    ];
    for (name, scene, light_count, lights) in cases {
        for visibility in [Visibility::Exact, Visibility::Spheres(SphereSettings { count: 8 })] {
            let all = VplSettings { light_count, visibility, ..VplSettings::default() };
            for indirect in
                [Indirect::Vpl(all), Indirect::Lightcuts { lights: all, error_bound: 0.02 }]
            {
                let settings = RenderSettings { indirect, ..vpl(0) };
                let stats = gathered(&scene, &in_room(), &settings).1.indirect;
                assert_eq!(stats.gathered > 0.0, lights, "{name}, {visibility:?}: {stats:?}");
            }
        }
    }
}

#[test]
fn without_visibility_light_leaks_and_no_shadow_ray_is_traced() {
    let scene = room(vec![lamp(Vec3::new(-0.3, 0.7, 0.2), 1.0)], matte(Vec3::splat(0.5)));
    let with = |visibility| {
        let vpl_settings = VplSettings { light_count: 256, visibility, ..VplSettings::default() };
        let settings = RenderSettings { indirect: Indirect::Vpl(vpl_settings), ..vpl(0) };
        gathered(&scene, &in_room(), &settings).1
    };
    let (exact, none) = (with(Visibility::Exact), with(Visibility::None));
    assert!(none.indirect.gathered > 1.02 * exact.indirect.gathered);
    assert!(none.indirect.visibility.rays == 0 && exact.indirect.visibility.rays > 0);
}
