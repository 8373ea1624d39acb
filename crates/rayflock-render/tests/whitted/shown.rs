//! Pictures of what lies behind light.

use crate::common::{ball, lamp, look_at, matte, mean, render_with, scene, square};
use glam::Vec3;
use rayflock_engine::EngineKind;
use rayflock_render::vpl::VplSettings;
use rayflock_render::{Film, FrameStats, Indirect, RenderSettings, Shown};

/// A ball over a floor, seen from above: its top is in the middle, 3 away.
fn film_of(shown: Shown) -> (Film, FrameStats) {
    let objects = vec![
        (square(Vec3::ZERO, Vec3::Y, 2.0), matte(Vec3::splat(0.8))),
        (ball(Vec3::Y, 0.5), matte(Vec3::splat(0.5))),
    ];
    let scene = scene(objects, vec![lamp(Vec3::new(1.0, 4.0, 0.0), 10.0)]);
    let view = look_at(Vec3::Y * 4.5, Vec3::ZERO);
    let vpl = VplSettings { light_count: 1024, ..VplSettings::default() };
    let settings =
        RenderSettings { shown, indirect: Indirect::Vpl(vpl), ..RenderSettings::default() };
    render_with(EngineKind::Bvh, &scene, &view, &settings, (21, 21))
}

fn middle(film: &Film) -> Vec3 {
    Vec3::from(film.pixel(10, 10))
}

#[test]
fn normals_and_distances_are_those_of_what_is_seen_first() {
    let normal = middle(&film_of(Shown::Normals).0);
    assert!((normal - Vec3::new(0.5, 1.0, 0.5)).length() < 0.05, "{normal}");
    // From the floor's lowest corner to the ball's top, twice 2 wide and 1.5 high.
    let diagonal = (16.0_f32 + 16.0 + 2.25).sqrt();
    let distance = middle(&film_of(Shown::Depth).0).x * diagonal;
    assert!((distance - 3.0).abs() < 0.01, "{distance}");
}

#[test]
fn the_cost_is_the_number_of_rays() {
    let (film, stats) = film_of(Shown::Cost);
    let shown: f32 = film.pixels().iter().map(|pixel| pixel[0]).sum();
    let rays = stats.rays.primary + stats.rays.shadow - stats.indirect.visibility.rays;
    assert_eq!((shown * Shown::COST_OF_WHITE as f32).round() as u64, rays);
}

#[test]
fn indirect_light_is_a_part_of_all_light() {
    let ((part, _), (all, _)) = (film_of(Shown::Indirect), film_of(Shown::Light));
    assert!(mean(&part).x > 0.0 && mean(&part).x < 0.5 * mean(&all).x);
}

#[test]
fn there_is_a_dot_where_a_virtual_light_is_seen() {
    let (film, stats) = film_of(Shown::Vpls);
    let dotted = film.pixels().iter().filter(|pixel| **pixel == [1.0; 3]).count();
    assert!(dotted > 9 && stats.indirect.lights > 10, "{dotted} pixels");
}
