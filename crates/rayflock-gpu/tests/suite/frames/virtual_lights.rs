//! Light of virtual lights, gathered by the device.

use std::sync::Arc;

use rayflock_engine::Clock;
use rayflock_gpu::{GpuContext, GpuRenderer};
use rayflock_render::occluders::SphereSettings;
use rayflock_render::vpl::{Visibility, VplSettings};
use rayflock_render::{Film, FrameRenderer, FrameStats, Indirect, IndirectStats, RenderSettings};
use rayflock_scene::{Scene, builtin};

use super::{MEAN_DIFFERENCE, MEAN_FLIP, difference, on_cpu, render_by};
use crate::device::contexts;

/// The same for pictures of which points on the CPU share what they see: mean difference, FLIP.
const SHARED_DIFFERENCE: f64 = 1.5;
const SHARED_FLIP: f32 = 0.04;

const SPHERES: Visibility = Visibility::Spheres(SphereSettings { count: 512 });

fn render(
    renderer: &mut dyn FrameRenderer,
    scene: &Arc<Scene>,
    time: f64,
    indirect: Indirect,
) -> (Film, FrameStats) {
    let settings = RenderSettings { indirect, ..RenderSettings::default() };
    render_by(renderer, scene, &[time], &settings).remove(0)
}

/// A renderer on each device, for all pictures of a test.
fn renderers() -> Vec<(&'static GpuContext, GpuRenderer)> {
    contexts().iter().map(|context| (&**context, GpuRenderer::new(context).unwrap())).collect()
}

/// Lamps and mirrors; an emitter, mirror and glass; the sky over figures. Where each point asks for
/// itself on the CPU as well, pictures are the same: without visibility, and by clusters of a light
/// each. Points that share a lookout see something else, in the second picture of the CPU.
#[test]
fn pictures_lit_by_virtual_lights_are_those_of_the_cpu() {
    let mut renderers = renderers();
    // Spheres are those of renderers that have seen the same frames before.
    let [mut each_alone, mut by_lookouts] = [on_cpu(), on_cpu()];
    let pictures = [
        // More lights than one dispatch takes.
        ("museum5", 1.2, 128, SPHERES),
        ("cornell", 0.4, 64, SPHERES),
        ("cornell", 0.4, 64, Visibility::None),
        ("crowd", 0.5, 64, SPHERES),
    ];
    for (name, time, light_count, visibility) in pictures {
        let scene = Arc::new(builtin::build(name).unwrap());
        let lights = VplSettings { light_count, visibility, ..VplSettings::default() };
        let alone = Indirect::Lightcuts { lights, error_bound: 0.0 };
        let (alone, _) = render(&mut each_alone, &scene, time, alone);
        let (shared, expected) = render(&mut by_lookouts, &scene, time, Indirect::Vpl(lights));
        for (context, renderer) in &mut renderers {
            let (found, stats) = render(renderer, &scene, time, Indirect::Vpl(lights));
            let name = format!("{name}, {visibility:?} on {}", context.adapter().name);
            assert_eq!(renderer.notice(), None, "{name}");
            assert_near(&found, &alone, (MEAN_DIFFERENCE, MEAN_FLIP), &name);
            assert_near(&found, &shared, (SHARED_DIFFERENCE, SHARED_FLIP), &name);
            check_stats(&stats, &expected, &name);
            let is_timed = renderer.budget().clock == Clock::Timestamps;
            assert_eq!(stats.indirect.gather_seconds > 0.0, is_timed, "{name}");
        }
    }
    // Ambient light is back where there is none of theirs.
    let scene = Arc::new(builtin::build("cornell").unwrap());
    let (expected, _) = render(&mut on_cpu(), &scene, 0.4, Indirect::Off);
    for (context, renderer) in &mut renderers {
        let (found, stats) = render(renderer, &scene, 0.4, Indirect::Off);
        assert_near(&found, &expected, (MEAN_DIFFERENCE, MEAN_FLIP), &context.adapter().name);
        assert_eq!(stats.indirect, IndirectStats::default());
    }
}

fn assert_near(found: &Film, expected: &Film, (most, most_flip): (f64, f32), name: &str) {
    let (mean, flip) = difference(found, expected);
    println!("{name}: mean difference {mean:.3} of 255, FLIP {flip:.4}");
    assert!(mean <= most && flip <= most_flip, "{name}: {mean}, FLIP {flip}");
}

/// Counts are the same, and sums nearly.
fn check_stats(found: &FrameStats, expected: &FrameStats, name: &str) {
    let rays = found.rays.indirect;
    let (found, expected) = (&found.indirect, &expected.indirect);
    println!("{name}: {:?}, {:?} on the CPU", found.visibility, expected.visibility);
    assert_eq!((found.lights, found.spheres), (expected.lights, expected.spheres), "{name}");
    assert!(found.lights > 0 && rays > 0 && found.shoot_seconds > 0.0, "{name}");
    let sums =
        |stats: &IndirectStats| [stats.gathered, stats.clamped, stats.visibility.pairs as f64];
    for (found, expected) in sums(found).into_iter().zip(sums(expected)) {
        assert!((found / expected - 1.0).abs() < 0.02, "{name}: {found}, not {expected}");
    }
    let has_tests = expected.visibility.tests > 0;
    assert_eq!((found.visibility.tests > 0, found.visibility.rays), (has_tests, 0), "{name}");
}
