//! Photons are sorted, and none is lost where there is no room at first, be it for photons or for
//! rays.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use rayflock_engine::{EngineKind, create};
use rayflock_geom::{Mesh, Sphere};
use rayflock_render::caustics::CausticSettings;
use rayflock_render::{Film, FrameRenderer, FrameStats, RenderSettings, View, WhittedRenderer};
use rayflock_scene::{
    Evaluator, Fresnel, Light, LightKind, Material, MaterialIdx, Projection, Scene, SceneObject,
    Shape, SurfaceMesh,
};

use super::*;
use crate::frame::GpuRenderer;
use crate::layout::DeviceRay;
use crate::testing::{contexts, read};

/// Position, flux, normal and direction, each with a word that is not used.
type Words = [u32; PHOTON_BYTES / 4];

/// Four balls of glass within each other above a floor, in the sun: most rays go on in two
/// directions, several times.
fn glass_in_glass() -> Arc<Scene> {
    let black = Material { diffuse: Vec3::ZERO, ..Material::default() };
    let (transmission, fresnel) = (Vec3::splat(0.9), Fresnel::Constant);
    let mirror = Vec3::splat(0.5);
    let glass = Material { transmission, mirror, fresnel, ior: 1.2, ..black };
    let balls = [1.0, 0.8, 0.6, 0.4].map(|radius| Sphere::new(Vec3::ZERO, radius));
    let corners = [[-4.0, -4.0], [4.0, -4.0], [4.0, 4.0], [-4.0, 4.0]];
    let corners = corners.map(|[x, z]| Vec3::new(x, -1.5, z)).to_vec();
    let floor = Mesh::from_triangles(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let object = |(mesh, material)| {
        let shape = Shape::Fixed(SurfaceMesh::new(mesh, MaterialIdx(material)));
        SceneObject { name: String::new(), node: None, mask: u32::MAX, shape }
    };
    let sun = LightKind::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::ONE };
    Arc::new(Scene {
        materials: vec![Material::default(), glass],
        objects: [(floor, 0), (Mesh::from_spheres(balls.to_vec()), 1)].map(object).to_vec(),
        lights: vec![Light { name: "sun".to_owned(), node: None, kind: sun }],
        ..Scene::default()
    })
}

fn render(renderer: &mut dyn FrameRenderer, scene: &Arc<Scene>) -> (Film, FrameStats) {
    let mut evaluator = Evaluator::new(Arc::clone(scene), None).unwrap();
    let frame = evaluator.evaluate(0.0).unwrap();
    renderer.commit(scene, frame).unwrap();
    let world_from_camera = Affine3A::from_translation(Vec3::new(0.0, 0.0, 6.0));
    let view = View::new(world_from_camera, Projection::Perspective { vertical_fov: 0.9 });
    let mut film = Film::new(8, 8);
    let caustics = Some(CausticSettings { photons: 256, radius: 0.05 });
    let settings = RenderSettings { caustics, depth: 5, ..RenderSettings::default() };
    let stats = renderer.render(&view, &settings, &mut film);
    assert_eq!(renderer.notice(), None);
    (film, stats)
}

#[test]
fn each_photon_is_found_once_and_those_without_room_are_left_anew() {
    let scene = glass_in_glass();
    let mut on_cpu = WhittedRenderer::new(create(EngineKind::Brute));
    let of_cpu = render(&mut on_cpu, &scene).1.caustics.photons;
    for context in contexts() {
        let mut renderer = GpuRenderer::new(context).unwrap();
        renderer.device.photons.capacity = 16;
        let (found, stats) = render(&mut renderer, &scene);
        let photons = &renderer.device.photons;
        let count = photons.count;
        assert_eq!(count as u64, stats.caustics.photons);
        assert!(stats.caustics.photons.abs_diff(of_cpu) <= of_cpu / 100, "{count}, not {of_cpu}");
        assert!((count..FIRST_CAPACITY).contains(&photons.capacity), "{}", photons.capacity);
        check_sorted(context, photons);
        // Two halves of waves that are more than twice as long as the rays that leave the sun.
        let first_rays = (2 * 2 * 256 * size_of::<DeviceRay>()) as u64;
        let rays = renderer.device.buffers.rays.size();
        assert!(rays > 2 * first_rays, "waves had room for all at first: {rays}");

        // Now there is room for all; sums may be in another order.
        let (expected, counted) = render(&mut renderer, &scene);
        assert_eq!((counted.rays, counted.caustics.photons), (stats.rays, count as u64));
        let apart = |(a, b): (&[f32; 3], &[f32; 3])| {
            a.iter().zip(b).any(|(a, b)| (a - b).abs() > 1e-3 * (1.0 + b.abs()))
        };
        assert_eq!(found.pixels().iter().zip(expected.pixels()).filter(|&p| apart(p)).count(), 0);
    }
}

/// What is sorted is what was left, and buckets take all places, each one once.
fn check_sorted(context: &GpuContext, photons: &Photons) {
    let count = photons.count;
    let header = PHOTONS_OFFSET / size_of::<u32>();
    let store: Vec<u32> = read(context, photons.store.buffer(), store_bytes(count) / 4);
    assert_eq!(store[..2], [count as u32; 2]);
    let mut left: Vec<Words> = bytemuck::pod_collect_to_vec(&store[header..]);
    let mut sorted: Vec<Words> = read(context, photons.sorted.buffer(), count);
    left.sort_unstable();
    sorted.sort_unstable();
    assert!(left == sorted);

    let mut buckets: Vec<[u32; 3]> =
        read(context, photons.buckets.buffer(), count.next_power_of_two());
    buckets.sort_unstable();
    let end = buckets.iter().fold(0, |end, &[first, count, filled]| {
        assert_eq!((first, filled), (end, count));
        end + count
    });
    assert_eq!(end as usize, count);
}
