//! Whole pictures, whose mirrored rays and shadow rays come from hits of the device.

use std::sync::Arc;

use rayflock_engine::{EngineKind, RayEngine, create};
use rayflock_gpu::{GpuEngine, GpuEngineKind};
use rayflock_render::tonemap::{ToneMap, to_srgb8};
use rayflock_render::{Film, FrameRenderer, FrameStats, RenderSettings, View, WhittedRenderer};
use rayflock_scene::{Evaluator, builtin};

use crate::device::contexts;

/// The largest mean difference of a channel, of 255.
const MEAN_DIFFERENCE: f64 = 0.5;

/// A frame of a built-in scene as a picture.
fn render(
    name: &str,
    [width, height]: [usize; 2],
    settings: &RenderSettings,
    engine: Box<dyn RayEngine>,
) -> (Vec<u8>, FrameStats, usize) {
    let scene = Arc::new(builtin::build(name).unwrap());
    let mut evaluator = Evaluator::new(Arc::clone(&scene), None).unwrap();
    let frame = evaluator.evaluate(2.5).unwrap();
    let mut renderer = WhittedRenderer::new(engine);
    let committed = renderer.commit(&scene, frame).unwrap();
    let view = View::new(frame.cameras[0], scene.cameras[0].projection);
    let mut film = Film::new(width, height);
    let stats = renderer.render(&view, settings, &mut film);
    assert_eq!(renderer.notice(), None);
    (to_srgb8(&film, 0.0, ToneMap::Srgb), stats, committed.prim_count)
}

#[test]
fn pictures_are_those_of_the_cpu() {
    use GpuEngineKind::{Compute, Raster, Subfields};
    let (size, settings) = ([48, 36], RenderSettings::default());
    // Software drivers take long to draw many triangles.
    for (name, kinds) in [
        ("cornell", &[Raster, Compute, Subfields][..]),
        ("museum5", &[Compute, Subfields]),
        ("crowd", &[Compute, Subfields]),
    ] {
        let (expected, ..) = render(name, size, &settings, create(EngineKind::Auto));
        for context in contexts() {
            for &kind in kinds {
                let engine = Box::new(GpuEngine::new(kind, context).unwrap());
                let (found, ..) = render(name, size, &settings, engine);
                let pairs = found.iter().zip(&expected);
                let sum: u32 = pairs.map(|(&a, &b)| u32::from(a.abs_diff(b))).sum();
                let mean = f64::from(sum) / found.len() as f64;
                let adapter = context.adapter();
                assert!(mean <= MEAN_DIFFERENCE, "{name}, {kind} on {adapter}: {mean}");
            }
        }
    }
}

/// Tests of rays from the camera: tiles are drawn only where their cones touch. `gpu:brute` tests
/// each ray against every primitive.
#[test]
fn cones_spare_most_tests_of_coherent_rays() {
    // No rays but these.
    let settings = RenderSettings { depth: 0, shadows: false, ..RenderSettings::default() };
    for context in contexts() {
        for kind in [GpuEngineKind::Raster, GpuEngineKind::Compute] {
            let engine = Box::new(GpuEngine::new(kind, context).unwrap());
            let (_, stats, prim_count) = render("museum3", [64, 48], &settings, engine);
            let primary = stats.stages.primary.trace;
            let per_ray = primary.triangle_tests / primary.rays;
            assert!(20 * per_ray <= prim_count as u64, "{kind}: {per_ray} of {prim_count}");
        }
    }
}
