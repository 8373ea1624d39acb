//! Whole frames by the device against those by the CPU.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool, flip};
use rayflock_engine::{EngineKind, create};
use rayflock_gpu::{GpuRenderer, PrimaryVisibility};
use rayflock_import::Reporter;
use rayflock_render::tonemap::{ToneMap, to_srgb8};
use rayflock_render::vpl::VplSettings;
use rayflock_render::{Film, FrameRenderer, Indirect, RenderSettings, View, WhittedRenderer};
use rayflock_scene::{Evaluator, Scene, builtin, frame_bounds};

use crate::device::{contexts, open_all};

const SIZE: [usize; 2] = [64, 48];

/// The largest mean difference of a channel, of 255, and the largest mean of FLIP.
const MEAN_DIFFERENCE: f64 = 0.5;
const MEAN_FLIP: f32 = 0.02;

/// Frames of a scene, rendered in turn.
fn render(renderer: &mut dyn FrameRenderer, scene: &Arc<Scene>, times: &[f64]) -> Vec<Film> {
    let mut evaluator = Evaluator::new(Arc::clone(scene), None).unwrap();
    let bounds = evaluator.bounds_over_clip().unwrap();
    let [width, height] = SIZE;
    let render = |&time: &f64| {
        let frame = evaluator.evaluate(time).unwrap();
        let (world_from_camera, projection) = match scene.cameras.first() {
            Some(camera) => (frame.cameras[0], camera.projection),
            None => frame_bounds(&bounds, width as f32 / height as f32),
        };
        renderer.commit(scene, frame).unwrap();
        let mut film = Film::new(width, height);
        let view = View::new(world_from_camera, projection);
        let stats = renderer.render(&view, &RenderSettings::default(), &mut film);
        assert_eq!(stats.rays.primary, (width * height) as u64);
        film
    };
    times.iter().map(render).collect()
}

fn on_cpu() -> WhittedRenderer {
    WhittedRenderer::new(create(EngineKind::Auto))
}

/// Mean difference of a channel, of 255, and mean of FLIP.
fn difference(found: &Film, expected: &Film) -> (f64, f32) {
    let bytes = [found, expected].map(|film| to_srgb8(film, 0.0, ToneMap::Srgb));
    let [found, expected] = &bytes;
    let sum: u64 = found.iter().zip(expected).map(|(&a, &b)| u64::from(a.abs_diff(b))).sum();
    let [width, height] = SIZE.map(|side| side as u32);
    let [found, expected] =
        bytes.each_ref().map(|bytes| FlipImageRgb8::with_data(width, height, bytes));
    let map = flip(expected, found, DEFAULT_PIXELS_PER_DEGREE);
    (sum as f64 / bytes[0].len() as f64, FlipPool::from_image(&map).mean())
}

fn assert_same_pictures(scene: Scene, times: &[f64]) {
    let scene = Arc::new(scene);
    let expected = render(&mut on_cpu(), &scene, times);
    for context in contexts() {
        let mut renderer = GpuRenderer::new(context).unwrap();
        let found = render(&mut renderer, &scene, times);
        assert_eq!(renderer.notice(), None);
        for (found, expected) in found.iter().zip(&expected) {
            let (mean, flip) = difference(found, expected);
            let name = format!("{} on {}", scene.name, context.adapter().name);
            println!("{name}: mean difference {mean:.3} of 255, FLIP {flip:.4}");
            assert!(mean <= MEAN_DIFFERENCE && flip <= MEAN_FLIP, "{name}: {mean}, FLIP {flip}");
        }
    }
}

/// Lamps, mirrors and smooth normals; an emitter, mirror and glass; the key light and the sky.
#[test]
fn pictures_of_built_in_scenes_are_those_of_the_cpu() {
    for (name, times) in [("museum5", &[1.2, 3.5][..]), ("cornell", &[0.4]), ("crowd", &[0.0, 1.3])]
    {
        assert_same_pictures(builtin::build(name).unwrap(), times);
    }
}

/// A skinned animal with a texture.
#[test]
fn pictures_of_the_fox_are_those_of_the_cpu() {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let folder = std::env::var_os("RAYFLOCK_DATA").map_or(beside, PathBuf::from);
    let path = folder.join("fox/Fox.glb");
    if !path.exists() {
        println!(
            "skipped: {} is not there; RAYFLOCK_DATA says where real scenes are",
            path.display()
        );
        return;
    }
    let scene = rayflock_import::load(&path, &mut Reporter::default()).unwrap();
    assert_same_pictures(scene, &[0.1, 0.6]);
}

#[test]
fn what_the_device_cannot_render_the_cpu_does_and_says_so() {
    let scene = Arc::new(builtin::build("cornell").unwrap());
    let mut evaluator = Evaluator::new(Arc::clone(&scene), None).unwrap();
    let frame = evaluator.evaluate(0.5).unwrap();
    let view = View::new(frame.cameras[0], scene.cameras[0].projection);
    let lights = VplSettings { light_count: 8, ..VplSettings::default() };
    let settings = RenderSettings { indirect: Indirect::Vpl(lights), ..RenderSettings::default() };
    let picture = |renderer: &mut dyn FrameRenderer| {
        renderer.commit(&scene, frame).unwrap();
        let mut film = Film::new(16, 12);
        renderer.render(&view, &settings, &mut film);
        film
    };
    let expected = picture(&mut on_cpu());
    for context in contexts() {
        let mut renderer = GpuRenderer::new(context).unwrap();
        assert_eq!(picture(&mut renderer), expected);
        let notice = renderer.notice().unwrap_or_default();
        assert!(notice.contains("cannot render light from virtual lights"), "{notice}");
    }
}

/// A frame is under way when the device is lost, and another follows.
#[test]
fn frames_go_on_when_the_device_is_lost() {
    let scene = Arc::new(builtin::build("museum3").unwrap());
    let expected = render(&mut on_cpu(), &scene, &[1.0, 2.0]);
    for own in open_all() {
        let mut renderer = GpuRenderer::new(&own).unwrap();
        render(&mut renderer, &scene, &[0.5]);
        own.destroy();
        assert_eq!(render(&mut renderer, &scene, &[1.0, 2.0]), expected);
        let notice = renderer.notice().unwrap_or_default();
        assert!(notice.contains(" was lost: ") && notice.contains("goes on"), "{notice}");
    }
}

/// What a frame took is told, stage by stage.
#[test]
fn rays_and_stages_are_counted() {
    let scene = Arc::new(builtin::build("museum3").unwrap());
    let mut evaluator = Evaluator::new(Arc::clone(&scene), None).unwrap();
    let frame = evaluator.evaluate(1.0).unwrap();
    let view = View::new(frame.cameras[0], scene.cameras[0].projection);
    let count = |renderer: &mut dyn FrameRenderer| {
        renderer.commit(&scene, frame).unwrap();
        renderer.render(&view, &RenderSettings::default(), &mut Film::new(32, 24))
    };
    let expected = count(&mut on_cpu()).rays;
    let pixel_count = 32 * 24;
    for context in contexts() {
        let mut traced = GpuRenderer::new(context).unwrap().with_primary(PrimaryVisibility::Traced);
        let of_tracing = count(&mut traced);
        let mut renderer = GpuRenderer::new(context).unwrap();
        let stats = count(&mut renderer);
        let near = |a: u64, b: u64| a.abs_diff(b) <= 2 + b / 100;
        assert!(near(stats.rays.mirror, expected.mirror), "{:?}, {expected:?}", stats.rays);
        assert!(near(stats.rays.shadow, expected.shadow), "{:?}, {expected:?}", stats.rays);
        let primary = [&stats, &of_tracing].map(|stats| stats.stages.primary.trace);
        assert_eq!(primary.map(|trace| trace.rays), [pixel_count; 2]);
        assert_eq!((stats.scanned, of_tracing.scanned), (pixel_count, 0));
        let [scanned_tests, traced_tests] = primary.map(|trace| trace.triangle_tests);
        assert!((pixel_count / 2..traced_tests).contains(&scanned_tests), "{primary:?}");
        assert_eq!(primary.map(|trace| trace.cone_tests > 0), [false, true]);
        assert!(stats.stages.secondary.trace.triangle_tests > 0);
        assert!(!renderer.budget().stages.is_empty() && renderer.memory_usage() > 0);
    }
}
