//! Light that is thrown, against what it must be.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::Vec3;
use rayflock_engine::{EngineKind, create};
use rayflock_geom::{FrameChanges, Mesh, Sphere};
use rayflock_scene::{
    Evaluator, Falloff, Fresnel, LightKind, Material, MaterialIdx, Scene, SceneObject, Shape,
    SurfaceMesh,
};

use super::photon_map::Photon;
use super::*;

const MATTE: Vec3 = Vec3::splat(0.6);

/// A scene of these objects, each with a material of its own.
fn scene(objects: Vec<(Mesh, Material)>) -> Scene {
    let mut scene = Scene::default();
    for (mesh, material) in objects {
        let shape = Shape::Fixed(SurfaceMesh::new(mesh, MaterialIdx(scene.materials.len() as u32)));
        scene.objects.push(SceneObject { name: String::new(), node: None, mask: u32::MAX, shape });
        scene.materials.push(material);
    }
    scene
}

fn matte() -> Material {
    Material { diffuse: MATTE, ..Material::default() }
}

fn black() -> Material {
    Material { diffuse: Vec3::ZERO, ..Material::default() }
}

fn mirror(share: f32) -> Material {
    Material { mirror: Vec3::splat(share), ..black() }
}

fn glass() -> Material {
    let fresnel = Fresnel::Dielectric;
    Material { transmission: Vec3::ONE, ior: 1.5, fresnel, ..black() }
}

fn ball(center: Vec3, radius: f32) -> Mesh {
    Mesh::from_spheres(vec![Sphere::new(center, radius)])
}

/// A square across `normal` with this half side.
fn square(center: Vec3, normal: Vec3, half: f32) -> Mesh {
    let (side, up) = normal.any_orthonormal_pair();
    let corner = |x: f32, y: f32| center + half * (x * side + y * up);
    let corners = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    Mesh::from_triangles(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

fn sun(irradiance: f32) -> LightKind {
    LightKind::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::splat(irradiance) }
}

fn lamp(position: Vec3, intensity: f32, falloff: Falloff) -> LightKind {
    LightKind::Point { position, intensity: Vec3::splat(intensity), falloff }
}

struct Shot {
    caustics: Caustics,
    stats: FrameStats,
}

impl Shot {
    fn flux(&self) -> f32 {
        self.caustics.map.photons().iter().map(|photon| f64::from(photon.flux.x)).sum::<f64>()
            as f32
    }

    fn irradiance(&self, position: Vec3, normal: Vec3) -> f32 {
        self.caustics.map.irradiance(position, normal).x
    }
}

fn shoot_with(
    kind: EngineKind,
    scene: &Scene,
    light: LightKind,
    settings: CausticSettings,
    batch_rays: usize,
) -> Shot {
    let mut evaluator = Evaluator::new(Arc::new(scene.clone()), None).unwrap();
    let frame = evaluator.evaluate(0.0).unwrap();
    let shading = FrameShading::new(scene, frame).unwrap();
    let mut engine = create(kind);
    engine.commit(&frame.geometry, &FrameChanges::all()).unwrap();
    let bounds = frame.geometry.bounds();
    let (lights, frame) = ([light], &shading);
    let (bounds, depth) = (&bounds, 12);
    let shooting =
        Shooting { frame, lights: &lights, bounds, settings, conserves: false, depth, batch_rays };
    let mut shot = Shot { caustics: Caustics::default(), stats: FrameStats::default() };
    shot.caustics.shoot(&mut *engine, &shooting, &mut shot.stats);
    shot
}

fn shoot(scene: &Scene, light: LightKind, settings: CausticSettings) -> Shot {
    shoot_with(EngineKind::Hierarchy, scene, light, settings, 1 << 19)
}

#[test]
fn a_flat_mirror_throws_what_its_image_of_the_light_would_send() {
    let scene = scene(vec![
        (square(Vec3::ZERO, Vec3::Y, 1.0), mirror(0.8)),
        (square(Vec3::new(2.0, 2.0, 0.0), Vec3::NEG_X, 4.0), matte()),
    ]);
    let direction = Vec3::new(1.0, -1.0, 0.0).normalize();
    let (position, intensity) = (Vec3::new(-1.0, 1.0, 0.0), Vec3::splat(5.0));
    let spot = LightKind::Spot { position, direction, intensity, cos_inner: 0.95, cos_outer: 0.9 };
    let shot = shoot(&scene, spot, CausticSettings::default());
    // What the lamp in the mirror, at (-1, -1, 0), sends to the wall at x = 2.
    for (y, z) in [(2.0, 0.0), (1.7, 0.2), (2.3, -0.2)] {
        let place = Vec3::new(2.0, y, z);
        let offset = place - Vec3::new(-1.0, -1.0, 0.0);
        let cos = offset.x / offset.length();
        let expected = 0.8 * 5.0 * cos / offset.length_squared();
        let found = shot.irradiance(place, Vec3::NEG_X);
        assert!((found / expected - 1.0).abs() < 0.01, "{found} instead of {expected}");
    }
    // The wall's other side gets nothing, nor what lies outside the reflected cone.
    assert_eq!(shot.irradiance(Vec3::new(2.0, 2.0, 0.0), Vec3::X), 0.0);
    assert_eq!(shot.irradiance(Vec3::new(2.0, -1.5, 0.0), Vec3::NEG_X), 0.0);
}

#[test]
fn a_lens_gathers_the_light_of_the_sun() {
    let floor = square(Vec3::NEG_Y * 1.5, Vec3::Y, 6.0);
    let scene = scene(vec![(ball(Vec3::ZERO, 1.0), glass()), (floor, matte())]);
    let shot = shoot(&scene, sun(2.0), CausticSettings::default());
    let below = |x: f32| shot.irradiance(Vec3::new(x, -1.5, 0.0), Vec3::Y);
    // The paraxial focus lies 1.5 radii below the middle.
    assert!(below(0.0) > 20.0 * 2.0, "{}", below(0.0));
    // Beside the focus, still below the ball, there is next to nothing.
    assert!(below(0.8) < 0.1 * below(0.0), "{} and {}", below(0.8), below(0.0));
    assert!(shot.stats.caustics.photons > 10_000);
}

#[test]
fn what_glass_and_mirrors_throw_is_what_they_get() {
    // Within a ball of walls, all of it arrives.
    let room = (ball(Vec3::ZERO, 5.0), matte());
    for material in [glass(), mirror(1.0)] {
        let thing = (ball(Vec3::X * 2.0, 1.0), material);
        let scene = scene(vec![room.clone(), thing]);
        let lit = lamp(Vec3::NEG_X * 2.0, 3.0, Falloff::InverseSquare);
        // Of the solid angle that a ball of radius 1 fills at distance 4.
        let expected = 3.0 * 2.0 * PI * (1.0 - (15.0_f32 / 16.0).sqrt());
        let found = shoot(&scene, lit, CausticSettings::default()).flux();
        assert!((found / expected - 1.0).abs() < 0.01, "{found} instead of {expected}");
    }
}

#[test]
fn the_flux_of_a_light_that_does_not_fall_grows_up_to_the_first_hit() {
    let thing = (square(Vec3::ZERO, Vec3::Y, 1.0), mirror(1.0));
    let scene = scene(vec![thing, (square(Vec3::Y * 9.0, Vec3::Y, 9.0), matte())]);
    let lit = lamp(Vec3::Y * 3.0, 2.0, Falloff::Constant);
    let found = shoot(&scene, lit, CausticSettings::default()).flux();
    // The irradiance, times the cosine, summed over the mirror.
    let cell = |idx: u32| {
        let [x, z] = [idx % 64, idx / 64].map(|place| (place as f32 + 0.5) / 32.0 - 1.0);
        2.0 * 3.0 / (x * x + z * z + 9.0).sqrt() / (32.0 * 32.0)
    };
    let expected: f32 = (0..64 * 64).map(cell).sum();
    assert!((found / expected - 1.0).abs() < 0.02, "{found} instead of {expected}");
}

#[test]
fn engines_threads_and_batches_leave_the_same_photons() {
    let floor = square(Vec3::NEG_Y * 1.5, Vec3::Y, 2.0);
    let tinted = Material { absorption: Vec3::new(0.1, 0.5, 0.9), ..glass() };
    let shiny = Material { mirror: Vec3::splat(0.3), fresnel: Fresnel::Schlick, ..matte() };
    let balls = vec![Sphere::new(Vec3::X, 0.8), Sphere::new(Vec3::new(-0.7, 0.2, 0.4), 0.7)];
    let scene = scene(vec![(Mesh::from_spheres(balls), tinted), (floor, shiny)]);
    let lit = lamp(Vec3::new(0.5, 6.0, 0.2), 3.0, Falloff::InverseSquare);
    let settings = CausticSettings { photons: 4096, ..CausticSettings::default() };
    let expected = shoot_with(EngineKind::Brute, &scene, lit, settings, 1 << 19);
    let photons = expected.caustics.map.photons();
    // Rays that turned, and some that came down to the floor.
    assert!(expected.stats.rays.indirect > 6000 && photons.len() > 100, "{:?}", expected.stats);
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        for (kind, batch_rays) in
            [(EngineKind::Brute, 1), (EngineKind::Hierarchy, 100), (EngineKind::Bvh, 777)]
        {
            let found = pool.install(|| shoot_with(kind, &scene, lit, settings, batch_rays));
            assert!(found.caustics.map.photons() == photons, "{kind}, {threads}, {batch_rays}");
            assert_eq!(found.stats.rays, expected.stats.rays);
        }
    }
}

#[test]
fn a_photon_counts_once_and_all_of_it() {
    let mut map = PhotonMap::default();
    let flux = Vec3::new(1.0, 2.0, 3.0);
    let (normal, direction) = (Vec3::Y, Vec3::new(0.6, -0.8, 0.0));
    let position = Vec3::new(0.31, 0.0, -0.17);
    // Others far away, so that the place lies anywhere in its cell.
    for position in [position, Vec3::splat(-3.217), Vec3::splat(5.0)] {
        map.photons_mut().push(Photon { position, texel: 0, flux, normal, direction });
    }
    map.sort(0.25);
    let step = 0.01;
    let mut sum = Vec3::ZERO;
    for (x, z) in (-50..50).flat_map(|x| (-50..50).map(move |z| (x, z))) {
        let place = position + Vec3::new(x as f32, 0.0, z as f32) * step;
        sum += map.irradiance(place, Vec3::Y) * (step * step);
    }
    assert!((sum - flux).abs().max_element() < 0.01, "{sum}");
    assert_eq!(map.irradiance(position, Vec3::NEG_Y), Vec3::ZERO);
    assert_eq!(map.irradiance(position, Vec3::X), Vec3::ZERO);
}

#[test]
fn without_mirrors_or_without_extent_nothing_is_shot() {
    let lit = lamp(Vec3::Y, 1.0, Falloff::InverseSquare);
    for objects in [vec![(ball(Vec3::ZERO, 0.5), matte())], vec![]] {
        let shot = shoot(&scene(objects), lit, CausticSettings::default());
        assert_eq!((shot.stats.rays.indirect, shot.stats.caustics.photons), (0, 0));
        assert_eq!(shot.irradiance(Vec3::ZERO, Vec3::Y), 0.0);
    }
    let wrong = CausticSettings { photons: 0, radius: f32::NAN }.clamped();
    assert_eq!(wrong, CausticSettings { photons: 64, radius: 0.01 });
}
