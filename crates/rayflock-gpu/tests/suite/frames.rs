//! Whole frames by the device against those by the CPU.

mod virtual_lights;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{Affine3A, Vec3};
use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool, flip};
use rayflock_engine::{EngineKind, create};
use rayflock_geom::{Mesh, Sphere};
use rayflock_gpu::{GpuRenderer, PrimaryVisibility};
use rayflock_import::Reporter;
use rayflock_render::caustics::CausticSettings;
use rayflock_render::tonemap::{ToneMap, to_srgb8};
use rayflock_render::vpl::VplSettings;
use rayflock_render::{
    Film, FrameRenderer, FrameStats, Indirect, RenderSettings, View, WhittedRenderer,
};
use rayflock_scene::{
    Background, Evaluator, Falloff, Fresnel, Light, LightKind, Material, MaterialIdx, Projection,
    Scene, SceneObject, Shape, SurfaceMesh, builtin, frame_bounds,
};

use crate::device::{contexts, open_all};

const SIZE: [usize; 2] = [64, 48];

/// The largest mean difference of a channel, of 255, and the largest mean of FLIP.
const MEAN_DIFFERENCE: f64 = 0.5;
const MEAN_FLIP: f32 = 0.02;

/// Frames of a scene, rendered in turn.
fn render(renderer: &mut dyn FrameRenderer, scene: &Arc<Scene>, times: &[f64]) -> Vec<Film> {
    let frames = render_by(renderer, scene, times, &RenderSettings::default());
    frames.into_iter().map(|(film, _)| film).collect()
}

/// The same by `settings`, and what frames took.
fn render_by(
    renderer: &mut dyn FrameRenderer,
    scene: &Arc<Scene>,
    times: &[f64],
    settings: &RenderSettings,
) -> Vec<(Film, FrameStats)> {
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
        let stats = renderer.render(&view, settings, &mut film);
        assert_eq!(stats.rays.primary, (width * height) as u64);
        (film, stats)
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

/// A ball of glass and a mirror on a rough floor, lit by every kind of light.
fn throwing() -> Scene {
    let mut scene = Scene { background: Some(Background::default()), ..Scene::default() };
    let floor = [[-3.0, -3.0], [3.0, -3.0], [3.0, 3.0], [-3.0, 3.0]];
    let floor = floor.map(|[x, z]| Vec3::new(x, -0.8, z)).to_vec();
    let wall = [[-3.0, -0.8], [3.0, -0.8], [3.0, 3.0], [-3.0, 3.0]];
    let wall = wall.map(|[x, y]| Vec3::new(x, y, -2.0)).to_vec();
    let square = |corners| Mesh::from_triangles(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let ball = |x: f32| Mesh::from_spheres(vec![Sphere::new(Vec3::new(x, 0.0, 0.0), 0.7)]);
    let rough = Material { diffuse: Vec3::new(0.7, 0.6, 0.5), ..Material::default() };
    let black = Material { diffuse: Vec3::ZERO, ..Material::default() };
    let (transmission, fresnel) = (Vec3::ONE, Fresnel::Dielectric);
    let absorption = Vec3::new(0.5, 0.1, 0.0);
    let glass = Material { transmission, fresnel, ior: 1.5, absorption, ..black.clone() };
    let mirror = Material { mirror: Vec3::new(0.9, 0.8, 0.6), ..black };
    let objects = [(square(floor), 0), (square(wall), 0), (ball(-0.9), 1), (ball(0.9), 2)];
    scene.materials = vec![rough, glass, mirror];
    for (mesh, material) in objects {
        let shape = Shape::Fixed(SurfaceMesh::new(mesh, MaterialIdx(material)));
        scene.objects.push(SceneObject { name: String::new(), node: None, mask: u32::MAX, shape });
    }
    let position = Vec3::new(-2.0, 2.5, 1.5);
    let (direction, intensity) = (-position.normalize(), Vec3::new(9.0, 8.0, 7.0));
    let kinds = [
        LightKind::Point { position: Vec3::Y * 3.0, intensity, falloff: Falloff::InverseSquare },
        // Among what mirrors.
        LightKind::Point {
            position: Vec3::Y * 0.2,
            intensity: Vec3::ONE,
            falloff: Falloff::Constant,
        },
        LightKind::Spot { position, direction, intensity, cos_inner: 0.95, cos_outer: 0.8 },
        LightKind::Directional { direction: Vec3::new(0.6, -0.8, 0.0), irradiance: Vec3::ONE },
    ];
    let named = |kind| Light { name: "light".to_owned(), node: None, kind };
    scene.lights = kinds.map(named).to_vec();
    scene.name = "a ball of glass and a mirror".to_owned();
    scene
}

/// From each kind of light.
#[test]
fn light_thrown_by_mirrors_and_glass_is_that_of_the_cpu() {
    let scene = Arc::new(throwing());
    let mut evaluator = Evaluator::new(Arc::clone(&scene), None).unwrap();
    let frame = evaluator.evaluate(0.0).unwrap();
    let world_from_camera =
        Affine3A::from_translation(Vec3::new(0.0, 2.0, 4.5)) * Affine3A::from_rotation_x(-0.45);
    let view = View::new(world_from_camera, Projection::Perspective { vertical_fov: 0.8 });
    let caustics = Some(CausticSettings { photons: 1 << 12, radius: 0.02 });
    let thrown = RenderSettings { caustics, depth: 4, ..RenderSettings::default() };
    let picture = |renderer: &mut dyn FrameRenderer, settings: &RenderSettings| {
        renderer.commit(&scene, frame).unwrap();
        let mut film = Film::new(SIZE[0], SIZE[1]);
        let stats = renderer.render(&view, settings, &mut film);
        (film, stats)
    };
    let (expected, counted) = picture(&mut on_cpu(), &thrown);
    let (without, _) = picture(&mut on_cpu(), &RenderSettings { caustics: None, ..thrown.clone() });
    assert!(difference(&without, &expected).0 > 1.0, "nothing is thrown");
    for context in contexts() {
        let mut renderer = GpuRenderer::new(context).unwrap();
        let (found, stats) = picture(&mut renderer, &thrown);
        assert_eq!(renderer.notice(), None);
        let (mean, flip) = difference(&found, &expected);
        let [photons, of_cpu] = [&stats, &counted].map(|stats| stats.caustics.photons);
        let name = &context.adapter().name;
        println!("{name}: mean difference {mean:.3}, FLIP {flip:.4}, {photons} photons");
        // Most of the picture gets none of that light.
        assert!(mean <= 0.05 && flip <= 0.005, "{name}: {mean}, FLIP {flip}");
        assert!(photons.abs_diff(of_cpu) <= of_cpu / 100, "{photons}, not {of_cpu}");
        assert!(stats.rays.indirect >= photons && stats.stages.indirect.trace.rays > 0);
    }
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
