//! The wavefront renderer against the reference, and against itself under other circumstances.

use crate::common::{
    ball, emitter, frame_of, glass, lamp, look_at, matte, mirror, render_reference, render_with,
    scene, square, sun, tessellated_ball, textured_floor,
};
use glam::{Affine3A, Quat, Vec3};
use rayflock_engine::{EngineKind, create};
use rayflock_render::{Film, FrameRenderer, RenderSettings, View, WhittedRenderer};
use rayflock_scene::{
    Evaluator, Fresnel, LightKind, LocalTransform, Material, Node, NodeIdx, Projection, Scene,
    Shape, builtin,
};

const SIZE: (usize, usize) = (40, 30);

/// Pixels may differ by this, absolutely and relative to the pixel.
const TOLERANCE: f32 = 2e-3;
/// This share of the pixels may differ by more: those cut by the edge of a shadow, a mirror or a
/// refraction, where the last bit of a ray decides what it hits.
const EDGE_SHARE: f32 = 0.01;

fn view() -> View {
    look_at(Vec3::new(1.5, 2.5, 6.0), Vec3::new(0.0, 0.8, 0.0))
}

fn assert_agrees(name: &str, scene: &Scene, view: &View, settings: &RenderSettings) {
    let (film, stats) = render_with(EngineKind::Brute, scene, view, settings, SIZE);
    let expected = render_reference(scene, view, settings, SIZE);
    assert_eq!(stats.dropped, 0, "{name}");
    let differs = |(a, b): &(&[f32; 3], &[f32; 3])| {
        a.iter().zip(b.iter()).any(|(a, b)| (a - b).abs() > TOLERANCE * (1.0 + b.abs()))
    };
    let pairs = film.pixels().iter().zip(expected.pixels());
    let differing = pairs.filter(differs).count();
    let most = (EDGE_SHARE * film.pixels().len() as f32) as usize;
    assert!(differing <= most, "{name}: {differing} pixels differ, at most {most} may");
    let brightest = film.pixels().iter().flatten().fold(0.0_f32, |most, value| most.max(*value));
    assert!(brightest > 0.1, "{name}: nothing to see");
}

/// Balls of glass, metal and varnish over a textured floor.
fn balls(lights: Vec<LightKind>) -> Scene {
    let varnished = Material {
        mirror: Vec3::splat(0.05),
        fresnel: Fresnel::Schlick,
        specular: Vec3::splat(0.8),
        shininess: 60.0,
        ..matte(Vec3::new(0.7, 0.1, 0.1))
    };
    let absorption = Vec3::new(1.0, 0.2, 0.4);
    let (mesh, normals) = tessellated_ball(Vec3::new(-1.6, 0.8, 0.5), 0.8, 8);
    let objects = vec![
        (mesh, varnished),
        (ball(Vec3::new(0.0, 1.0, 0.0), 0.9), mirror(0.8)),
        (ball(Vec3::new(1.3, 0.7, 1.2), 0.7), Material { absorption, ..glass(1.5) }),
    ];
    let mut scene = scene(objects, lights);
    let Shape::Fixed(surface) = &mut scene.objects[0].shape else { panic!() };
    surface.normals = normals.into();
    textured_floor(&mut scene, 4.0);
    scene.ambient = Vec3::splat(0.1);
    scene
}

#[test]
fn balls_under_every_kind_of_light() {
    let spot = LightKind::Spot {
        position: Vec3::new(-2.0, 5.0, 2.0),
        direction: Vec3::new(0.3, -1.0, -0.3).normalize(),
        intensity: Vec3::new(40.0, 30.0, 20.0),
        cos_inner: 0.95,
        cos_outer: 0.8,
    };
    let sun = sun(Vec3::new(-1.0, -2.0, -1.0), 2.0);
    let lamp = lamp(Vec3::new(2.0, 4.0, 3.0), 30.0);
    for (name, lights) in [("spot", vec![spot]), ("sun", vec![sun]), ("all", vec![spot, sun, lamp])]
    {
        assert_agrees(name, &balls(lights), &view(), &RenderSettings::default());
    }
}

#[test]
fn balls_under_default_lights_with_several_samples() {
    let mut scene = balls(vec![]);
    scene.background = None;
    let settings = RenderSettings { samples_per_pixel: 3, depth: 8, ..RenderSettings::default() };
    assert_agrees("default lights", &scene, &view(), &settings);
}

#[test]
fn an_emitting_panel_and_an_emitting_ball() {
    let mut scene = balls(vec![]);
    let extra = crate::common::scene(
        vec![
            (square(Vec3::new(0.0, 4.0, 0.0), Vec3::NEG_Y, 1.0), emitter(Vec3::splat(4.0))),
            (ball(Vec3::new(-2.5, 1.0, 2.0), 0.3), emitter(Vec3::new(8.0, 4.0, 1.0))),
        ],
        vec![],
    );
    for (object, material) in extra.objects.into_iter().zip(extra.materials) {
        let Shape::Fixed(mut surface) = object.shape else { panic!() };
        let material_idx = rayflock_scene::MaterialIdx(scene.materials.len() as u32);
        scene.materials.push(material);
        surface = rayflock_scene::SurfaceMesh::new(surface.mesh, material_idx);
        crate::common::add_surface(&mut scene, surface);
    }
    let settings = RenderSettings { samples_per_pixel: 2, ..RenderSettings::default() };
    assert_agrees("emitters", &scene, &view(), &settings);
}

#[test]
fn objects_under_transforms_that_mirror_and_stretch() {
    let mut scene = balls(vec![lamp(Vec3::new(2.0, 4.0, 3.0), 30.0)]);
    let rest = LocalTransform::Parts {
        translation: Vec3::new(0.3, 0.2, -0.4),
        rotation: Quat::from_rotation_y(0.8),
        scale: Vec3::new(-1.2, 0.8, 1.1),
    };
    let name = "stretched".to_owned();
    scene.nodes.push(Node { name, parent: None, rest, rest_weights: vec![] });
    for object_idx in [0, 3] {
        scene.objects[object_idx].node = Some(NodeIdx(0));
    }
    let projection = Projection::Orthographic { height: 5.0 };
    let orthographic = View { projection, ..view() };
    assert_agrees("perspective", &scene, &view(), &RenderSettings::default());
    assert_agrees("orthographic", &scene, &orthographic, &RenderSettings::default());
}

#[test]
fn the_cornell_box() {
    let scene = builtin::build("cornell").unwrap();
    let view = View::new(scene.cameras[0].node_from_camera, scene.cameras[0].projection);
    assert_agrees("cornell", &scene, &view, &RenderSettings::default());
}

#[test]
fn threads_batches_and_engines_change_nothing() {
    let scene = balls(vec![lamp(Vec3::new(2.0, 4.0, 3.0), 30.0), sun(Vec3::NEG_Y, 0.5)]);
    let settings = RenderSettings { samples_per_pixel: 2, ..RenderSettings::default() };
    let (expected, stats) = render_with(EngineKind::Brute, &scene, &view(), &settings, SIZE);
    let counted = stats.rays;
    assert!(counted.mirror > 0 && counted.refraction > 0 && counted.shadow > 0);
    assert_eq!(stats.trace.rays, counted.total());

    for batch_rays in [1, 100, 333, 1000] {
        let settings = RenderSettings { batch_rays, ..settings.clone() };
        let (film, stats) = render_with(EngineKind::Brute, &scene, &view(), &settings, SIZE);
        assert!(film == expected, "batches of {batch_rays}");
        assert_eq!(stats.rays, counted, "batches of {batch_rays}");
    }
    for thread_count in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(thread_count).build().unwrap();
        for kind in EngineKind::ALL {
            let (film, _) = pool.install(|| render_with(kind, &scene, &view(), &settings, SIZE));
            assert!(film == expected, "{kind} with {thread_count} threads");
        }
    }
}

#[test]
fn a_frame_does_not_depend_on_the_ones_before() {
    let scene = builtin::build("cornell").unwrap();
    let view = View::new(scene.cameras[0].node_from_camera, scene.cameras[0].projection);
    let mut evaluator = Evaluator::new(scene.clone().into(), None).unwrap();
    let mut renderer = WhittedRenderer::new(create(EngineKind::Hierarchy));
    let settings = RenderSettings::default();
    let mut film = Film::new(SIZE.0, SIZE.1);
    for time in [0.0, 1.0, 2.0] {
        renderer.commit(&scene, evaluator.evaluate(time).unwrap()).unwrap();
        renderer.render(&view, &settings, &mut film);
    }
    let mut fresh = WhittedRenderer::new(create(EngineKind::Hierarchy));
    let mut evaluator = Evaluator::new(scene.clone().into(), None).unwrap();
    fresh.commit(&scene, evaluator.evaluate(2.0).unwrap()).unwrap();
    let mut alone = Film::new(SIZE.0, SIZE.1);
    fresh.render(&view, &settings, &mut alone);
    assert!(film == alone);
}

#[test]
fn a_far_away_world_looks_the_same() {
    let offset = Vec3::new(512.0, 0.0, -256.0);
    let near = balls(vec![sun(Vec3::new(-1.0, -2.0, -1.0), 2.0)]);
    let mut far = near.clone();
    let rest = LocalTransform::Matrix(Affine3A::from_translation(offset));
    far.nodes.push(Node { name: "far".to_owned(), parent: None, rest, rest_weights: vec![] });
    far.objects.iter_mut().for_each(|object| object.node = Some(NodeIdx(0)));
    let moved =
        View::new(Affine3A::from_translation(offset) * view().world_from_camera, view().projection);
    assert_eq!(frame_of(&far).geometry.objects().len(), 4);
    let settings = RenderSettings::default();
    let (here, _) = render_with(EngineKind::Brute, &near, &view(), &settings, SIZE);
    let (there, _) = render_with(EngineKind::Brute, &far, &moved, &settings, SIZE);
    let pairs = here.pixels().iter().zip(there.pixels());
    let differing = pairs.filter(|(a, b)| (a[0] - b[0]).abs() > 0.02 * (1.0 + a[0])).count();
    assert!(differing <= 24, "{differing} of 1200 pixels differ");
}
