//! Light at single points, against what the formulas say.

use std::f32::consts::PI;

use crate::common::{
    ball, emitter, frame_of, glass, lamp, look_at, matte, mirror, radiance, render, scene, square,
    sun, tessellated_ball,
};
use glam::Vec3;
use rayflock_engine::{EngineKind, create};
use rayflock_geom::Mesh;
use rayflock_render::{Film, FrameRenderer, RenderError, RenderSettings, WhittedRenderer};
use rayflock_scene::{
    Background, LightKind, Material, MaterialIdx, PrimMaterials, Scene, SurfaceAttributes,
};

/// Points are lit from just off their surface: a few parts in 100,000 nearer to a lamp.
const OFFSET: f32 = 1e-4;
const EYE: Vec3 = Vec3::new(0.5, 3.0, 1.0);

fn assert_near(found: Vec3, expected: Vec3, relative: f32) {
    let error = (found - expected).abs().max_element();
    assert!(error <= relative * expected.max_element(), "{found} instead of {expected}");
}

fn settings() -> RenderSettings {
    RenderSettings::default()
}

fn floor(material: Material) -> (Mesh, Material) {
    (square(Vec3::ZERO, Vec3::Y, 5.0), material)
}

#[test]
fn a_plate_under_the_sun_sends_back_albedo_times_irradiance_over_pi() {
    let albedo = Vec3::new(0.8, 0.5, 0.2);
    for angle in [0.0_f32, 0.5, 1.2] {
        let direction = Vec3::new(angle.sin(), -angle.cos(), 0.0);
        let scene = scene(vec![floor(matte(albedo))], vec![sun(direction, 2.0)]);
        let found = radiance(&scene, EYE, Vec3::ZERO, &settings());
        assert_near(found, albedo * 2.0 * angle.cos() / PI, 1e-5);
    }
}

#[test]
fn both_sides_of_a_plate_are_lit_alike_but_not_through_it() {
    let above = scene(vec![floor(matte(Vec3::ONE))], vec![sun(Vec3::NEG_Y, PI)]);
    let below = scene(vec![floor(matte(Vec3::ONE))], vec![sun(Vec3::Y, PI)]);
    let eye_below = EYE * Vec3::new(1.0, -1.0, 1.0);
    assert_near(radiance(&above, EYE, Vec3::ZERO, &settings()), Vec3::ONE, 1e-5);
    assert_near(radiance(&below, eye_below, Vec3::ZERO, &settings()), Vec3::ONE, 1e-5);
    assert_eq!(radiance(&above, eye_below, Vec3::ZERO, &settings()), Vec3::ZERO);
}

#[test]
fn a_point_light_falls_with_the_square_of_the_distance() {
    for height in [1.0_f32, 2.0, 4.0] {
        let light = lamp(Vec3::Y * height, 6.0);
        let scene = scene(vec![floor(matte(Vec3::ONE))], vec![light]);
        let found = radiance(&scene, EYE, Vec3::ZERO, &settings());
        assert_near(found, Vec3::splat(6.0 / (height * height) / PI), OFFSET);
    }
}

#[test]
fn ambient_light_makes_a_furnace() {
    let mut scene = scene(vec![floor(matte(Vec3::ONE))], vec![sun(Vec3::NEG_Y, 0.0)]);
    scene.ambient = Vec3::splat(0.7);
    scene.background = Some(Background::Uniform(scene.ambient));
    let film = render(&scene, &look_at(EYE, Vec3::ZERO), &settings(), (16, 12));
    assert!(film.pixels().iter().all(|pixel| Vec3::from(*pixel) == scene.ambient));
}

#[test]
fn a_lossless_glass_ball_disappears_in_a_furnace() {
    for ior in [1.0, 1.5] {
        let mut scene = scene(vec![(ball(Vec3::ZERO, 1.0), glass(ior))], vec![]);
        scene.background = Some(Background::Uniform(Vec3::ONE));
        let settings = RenderSettings { depth: 32, ..settings() };
        let film = render(&scene, &look_at(Vec3::Z * 4.0, Vec3::ZERO), &settings, (24, 24));
        for pixel in film.pixels() {
            assert!((pixel[0] - 1.0).abs() < 0.01, "{pixel:?} with index {ior}");
        }
    }
}

#[test]
fn a_ball_casts_its_shadow_and_no_more() {
    let objects = vec![floor(matte(Vec3::ONE)), (ball(Vec3::Y * 2.0, 0.5), matte(Vec3::ONE))];
    let scene = scene(objects, vec![lamp(Vec3::Y * 4.0, 10.0)]);
    let eye = Vec3::new(6.0, 3.0, 0.0);
    // The shadow's edge: a tangent from the lamp, at an angle whose sine is 0.5 / 2.
    let edge = 4.0 * (0.25_f32).asin().tan();
    for (x, is_lit) in [(0.0, false), (edge - 0.02, false), (edge + 0.02, true)] {
        let found = radiance(&scene, eye, Vec3::X * x, &settings());
        assert_eq!(found != Vec3::ZERO, is_lit, "at {x}");
    }
    let unshadowed = RenderSettings { shadows: false, ..settings() };
    assert_near(
        radiance(&scene, eye, Vec3::ZERO, &unshadowed),
        Vec3::splat(10.0 / 16.0 / PI),
        1e-4,
    );
}

#[test]
fn a_spot_lights_only_its_cone() {
    let light = LightKind::Spot {
        position: Vec3::Y * 2.0,
        direction: Vec3::NEG_Y,
        intensity: Vec3::splat(4.0),
        cos_inner: 0.2_f32.cos(),
        cos_outer: 0.3_f32.cos(),
    };
    let scene = scene(vec![floor(matte(Vec3::ONE))], vec![light]);
    assert_near(radiance(&scene, EYE, Vec3::ZERO, &settings()), Vec3::splat(1.0 / PI), OFFSET);
    assert_eq!(radiance(&scene, EYE, Vec3::X, &settings()), Vec3::ZERO);
}

#[test]
fn a_glowing_square_lights_as_its_form_factor_says() {
    let panel = (square(Vec3::Y, Vec3::NEG_Y, 1.0), emitter(Vec3::splat(3.0)));
    let scene = scene(vec![floor(matte(Vec3::ONE)), panel], vec![]);
    let settings = RenderSettings { light_samples: 1024, ..settings() };
    let found = radiance(&scene, Vec3::new(3.0, 0.5, 0.2), Vec3::ZERO, &settings);
    let s = 0.5_f32.sqrt();
    assert_near(found, Vec3::splat(3.0 * 4.0 / PI * s * s.atan()), 0.01);
    // Seen itself, it shows its radiance, from both sides.
    assert_eq!(radiance(&scene, EYE - 2.9 * Vec3::Y, Vec3::Y, &settings), Vec3::splat(3.0));
    assert_eq!(radiance(&scene, EYE, Vec3::Y, &settings), Vec3::splat(3.0));
}

#[test]
fn a_mirror_shows_what_is_in_front_of_it() {
    let wall = (square(Vec3::X * 4.0, Vec3::NEG_X, 1.0), emitter(Vec3::new(1.0, 0.5, 0.25)));
    let scene = scene(vec![floor(mirror(0.5)), wall], vec![]);
    // The wall's middle is 4 to the right; the eye sees it mirrored in the middle between.
    let eye = Vec3::new(-4.0, 0.6, 0.0);
    let found = radiance(&scene, eye, Vec3::new(0.0, 0.0, 0.0), &settings());
    assert_near(found, 0.5 * Vec3::new(1.0, 0.5, 0.25), 1e-6);
    let shallow = RenderSettings { depth: 0, ..settings() };
    assert_eq!(radiance(&scene, eye, Vec3::ZERO, &shallow), Vec3::ZERO);
}

#[test]
fn facing_mirrors_end_at_the_depth() {
    let objects = [Vec3::X, Vec3::NEG_X]
        .map(|side| {
            let glowing = Material { emission: Vec3::ONE, ..mirror(1.0) };
            (square(side, -side, 3.0), glowing)
        })
        .to_vec();
    let scene = scene(objects, vec![]);
    for depth in [0, 1, 7] {
        let settings = RenderSettings { depth, ..settings() };
        let found = radiance(&scene, Vec3::ZERO, Vec3::X, &settings);
        assert_eq!(found, Vec3::splat(1.0 + depth as f32));
    }
}

#[test]
fn a_glass_ball_turns_the_world_upside_down() {
    let ground = (square(Vec3::NEG_Y * 3.0, Vec3::Y, 60.0), emitter(Vec3::X));
    let mut scene = scene(vec![(ball(Vec3::ZERO, 1.0), glass(1.5)), ground], vec![]);
    scene.background = Some(Background::Uniform(Vec3::Z));
    let eye = Vec3::Z * 5.0;
    let seen = |y: f32| radiance(&scene, eye, Vec3::new(0.0, y, 0.5), &settings());
    let (upper, lower) = (seen(0.4), seen(-0.4));
    assert!(upper.x > 0.8 && upper.z < 0.2, "{upper}");
    assert!(lower.z > 0.8 && lower.x < 0.2, "{lower}");
}

#[test]
fn glass_absorbs_along_the_way_inside() {
    let absorption = Vec3::new(0.1, 0.5, 2.0);
    let clear = Material { fresnel: rayflock_scene::Fresnel::Constant, ..glass(1.0) };
    let tinted = Material { absorption, ..clear };
    let (mesh, _) = tessellated_ball(Vec3::ZERO, 1.0, 24);
    for mesh in [ball(Vec3::ZERO, 1.0), mesh] {
        let mut scene = scene(vec![(mesh, tinted.clone())], vec![]);
        scene.background = Some(Background::Uniform(Vec3::ONE));
        let found = radiance(&scene, Vec3::new(0.1, 0.05, 5.0), Vec3::ZERO, &settings());
        assert_near(found, (-2.0 * absorption).exp(), 0.02);
    }
}

#[test]
fn closed_meshes_do_not_shade_themselves() {
    for center in [Vec3::ZERO, Vec3::new(1000.0, -500.0, 300.0)] {
        let (mesh, normals) = tessellated_ball(center, 1.0, 12);
        let mut scene = scene(vec![(mesh, matte(Vec3::ONE))], vec![sun(Vec3::NEG_Z, PI)]);
        let rayflock_scene::Shape::Fixed(surface) = &mut scene.objects[0].shape else { panic!() };
        surface.normals = normals.into();
        let film = render(&scene, &look_at(center + 4.0 * Vec3::Z, center), &settings(), (64, 64));
        for (pixel_idx, pixel) in film.pixels().iter().enumerate() {
            // Where the picture shows the ball, the sun behind the viewer lights it.
            let x = (pixel_idx % 64) as f32 - 31.5;
            let y = (pixel_idx / 64) as f32 - 31.5;
            if x.hypot(y) < 20.0 {
                assert!(pixel[0] > 0.1, "pixel {pixel_idx} at {center} is black");
            }
        }
    }
}

#[test]
fn an_empty_scene_shows_its_background() {
    let background = Background::Gradient {
        zenith: Vec3::new(0.0, 0.0, 1.0),
        horizon: Vec3::ONE,
        ground: Vec3::new(0.5, 0.2, 0.1),
    };
    let scene = Scene { background: Some(background), ..Scene::default() };
    let up = radiance(&scene, Vec3::ZERO, Vec3::Y, &settings());
    assert_near(up, Vec3::Z, 1e-4);
    let white = Some(Background::Uniform(Vec3::ONE));
    let overridden = RenderSettings { background: white, ..settings() };
    assert_eq!(radiance(&scene, Vec3::ZERO, Vec3::Y, &overridden), Vec3::ONE);

    // Nothing committed: background too. No pixels: no work.
    let mut renderer = WhittedRenderer::new(create(EngineKind::Brute));
    let mut film = Film::new(3, 2);
    renderer.render(&look_at(Vec3::ZERO, Vec3::Y), &overridden, &mut film);
    assert_eq!(film.pixels(), [[1.0; 3]; 6]);
    renderer.commit(&scene, &frame_of(&scene)).unwrap();
    let stats = renderer.render(&look_at(Vec3::ZERO, Vec3::Y), &settings(), &mut Film::new(0, 7));
    assert_eq!(stats.rays.total(), 0);
}

#[test]
fn a_scene_without_lights_has_default_ones() {
    let mut scene = scene(vec![(ball(Vec3::ZERO, 1.0), Material::default())], vec![]);
    scene.background = None;
    let film = render(&scene, &look_at(Vec3::Z * 4.0, Vec3::ZERO), &settings(), (32, 32));
    let at = |x: usize, y: usize| Vec3::from(film.pixel(x, y)).max_element();
    assert!(at(12, 10) > 1.5 * at(20, 22), "lit from the upper left");
    assert!(at(20, 22) > 0.1, "and not black below");
}

#[test]
fn extreme_values_never_make_a_pixel_that_is_not_finite() {
    let wild = Material {
        specular: Vec3::splat(f32::MAX),
        shininess: -5.0,
        mirror: Vec3::splat(f32::NAN),
        transmission: Vec3::ONE,
        ior: f32::NAN,
        absorption: Vec3::splat(f32::NEG_INFINITY),
        ..Material::default()
    };
    let lights = vec![lamp(Vec3::Y, f32::MAX), sun(Vec3::NEG_Y, f32::INFINITY)];
    let scene = scene(vec![floor(wild), (ball(Vec3::Y, 0.5), glass(0.0))], lights);
    let film = render(&scene, &look_at(EYE, Vec3::ZERO), &settings(), (16, 16));
    assert!(film.pixels().iter().flatten().all(|value| value.is_finite()));
}

#[test]
fn parts_that_do_not_fit_are_errors_that_say_what() {
    let good = scene(vec![floor(matte(Vec3::ONE))], vec![]);
    let commit = |scene: &Scene, change: &dyn Fn(&mut rayflock_scene::SceneFrame)| {
        let mut frame = frame_of(&good);
        change(&mut frame);
        WhittedRenderer::new(create(EngineKind::Brute)).commit(scene, &frame).unwrap_err()
    };
    let no_materials = Scene { materials: vec![], ..good.clone() };
    let expected = RenderError::Material { object_id: 0, found: 0, material_count: 0 };
    assert_eq!(commit(&no_materials, &|_| {}), expected);
    let error = commit(&good, &|frame| frame.surfaces.clear());
    assert_eq!(error.to_string(), "object 0 has no surface: the frame has 0");
    let error = commit(&good, &|frame| frame.surfaces[0].normals = vec![Vec3::Y; 3].into());
    assert_eq!(error.to_string(), "object 0: 3 normals, expected 4");
    let error = commit(&good, &|frame| {
        let materials = PrimMaterials::PerPrim(vec![MaterialIdx(0)]);
        let attributes = SurfaceAttributes { materials, ..SurfaceAttributes::default() };
        frame.surfaces[0].attributes = attributes.into();
    });
    assert_eq!(error.to_string(), "object 0: 1 materials, expected 2");
}
