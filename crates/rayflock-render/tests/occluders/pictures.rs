//! Pictures lit past spheres, and by cuts, are nearly those lit exactly.
#![expect(clippy::unwrap_used, reason = "tests fail by panicking")]

use std::sync::Arc;

use rayflock_engine::{EngineKind, create};
use rayflock_render::occluders::SphereSettings;
use rayflock_render::vpl::{LookoutSettings, Visibility, VplSettings};
use rayflock_render::{
    Film, FrameRenderer, FrameStats, Indirect, RenderSettings, View, WhittedRenderer,
};
use rayflock_scene::{Evaluator, builtin};

fn lights(visibility: Visibility) -> VplSettings {
    VplSettings { light_count: 256, visibility, ..VplSettings::default() }
}

/// Two frames of a built-in scene, of which the second counts.
fn picture(scene: &str, indirect: Indirect) -> (Film, FrameStats) {
    let scene = Arc::new(builtin::build(scene).unwrap());
    let mut evaluator = Evaluator::new(Arc::clone(&scene), None).unwrap();
    let mut renderer = WhittedRenderer::new(create(EngineKind::Auto));
    let settings = RenderSettings { indirect, ..RenderSettings::default() };
    let mut film = Film::new(64, 48);
    let mut stats = FrameStats::default();
    for time in [0.5, 1.0] {
        let frame = evaluator.evaluate(time).unwrap();
        renderer.commit(&scene, frame).unwrap();
        let view = View::new(frame.cameras[0], scene.cameras[0].projection);
        stats = renderer.render(&view, &settings, &mut film);
    }
    (film, stats)
}

/// Relative root mean squared error.
fn error(found: &Film, expected: &Film) -> f32 {
    let pairs = || found.pixels().as_flattened().iter().zip(expected.pixels().as_flattened());
    let squared: f32 = pairs().map(|(a, b)| (a - b) * (a - b)).sum();
    (squared / pairs().map(|(_, b)| b * b).sum::<f32>()).sqrt()
}

#[test]
fn spheres_and_cuts_come_near_to_all_lights_seen_exactly() {
    let spheres = Visibility::Spheres(SphereSettings { count: 64 });
    let (exact, exact_stats) = picture("cornell", Indirect::Vpl(lights(Visibility::Exact)));
    let (open, _) = picture("cornell", Indirect::Vpl(lights(Visibility::None)));
    let (nearly, stats) = picture("cornell", Indirect::Vpl(lights(spheres)));
    let (without, with) = (error(&open, &exact), error(&nearly, &exact));
    assert!(with < 0.03 && with < 0.5 * without, "{with} of {without}");
    assert!(stats.indirect.spheres > 20 && stats.indirect.spheres <= 70);
    assert_eq!(stats.indirect.visibility.rays, 0);
    let clamped = |stats: FrameStats| stats.indirect.clamped_share();
    let (found, expected) = (clamped(stats), clamped(exact_stats));
    assert!((found - expected).abs() < 0.01, "{found} of the light is clamped, not {expected}");

    for (visibility, expected) in [(Visibility::Exact, &exact), (spheres, &nearly)] {
        let lights = lights(visibility);
        let (cut, stats) = picture("cornell", Indirect::Lightcuts { lights, error_bound: 0.02 });
        let error = error(&cut, expected);
        assert!(error < 0.02, "{error}");
        let cuts = stats.indirect.cuts;
        assert!(cuts.clusters < 200 * cuts.points, "{cuts:?}");
        assert_eq!(stats.trace.rays, stats.rays.total());
        let is_exact = visibility == Visibility::Exact;
        assert_eq!((cuts.visibility.rays > 0, cuts.visibility.tests > 0), (is_exact, !is_exact));
    }
}

#[test]
fn fewer_points_a_lookout_come_nearer_to_what_each_sees() {
    // Were it the same point of each lookout that looks at all lights, errors would be 0.0188, 0.080
    // and 0.061.
    for (scene, most) in [("cornell", 0.015), ("crowd", 0.077), ("museum5", 0.055)] {
        let (exact, exact_stats) = picture(scene, Indirect::Vpl(lights(Visibility::Exact)));
        let (mut before, mut rays) = (f32::INFINITY, 0);
        for points in [64, 16, 1] {
            let lookouts = Visibility::Lookouts(LookoutSettings { points });
            let (nearly, stats) = picture(scene, Indirect::Vpl(lights(lookouts)));
            let error = error(&nearly, &exact);
            assert!(error < before.min(most), "{scene}, {points}: {error} after {before}");
            let traced = stats.indirect.visibility.rays;
            assert!(traced > rays, "{scene}, {points}: {traced} rays after {rays}");
            assert_eq!(stats.trace.rays, stats.rays.total());
            (before, rays) = (error, traced);
        }
        // Each point looks for itself.
        assert!(before < 0.002, "{scene}: {before}");
        let ratio = rays as f64 / exact_stats.indirect.visibility.rays as f64;
        assert!((ratio - 1.0).abs() < 0.01, "{scene}: {ratio}");
    }
}

#[test]
fn the_sky_does_not_shine_through_the_ground() {
    // The ground is a plane of the hull, for which there are no spheres.
    let (exact, _) = picture("crowd", Indirect::Vpl(lights(Visibility::Exact)));
    let spheres = Visibility::Spheres(SphereSettings { count: 256 });
    let (nearly, _) = picture("crowd", Indirect::Vpl(lights(spheres)));
    let error = error(&nearly, &exact);
    assert!(error < 0.1, "{error}");
}
