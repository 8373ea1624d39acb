//! What scan conversion finds is what tracing finds.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use rayflock_geom::{Mesh, Sphere};
use rayflock_render::prepared::PreparedFrame;
use rayflock_render::{FrameRenderer, RenderSettings, View};
use rayflock_scene::{
    Evaluator, Material, MaterialIdx, Projection, Scene, SceneObject, Shape, SurfaceMesh,
};
use rayflock_testkit::Rng;
use rayflock_testkit::scenes::{SoupKind, spheres, triangle_soup};

use super::*;
use crate::frame::GpuRenderer;
use crate::frame::picture::{Band, Picture};
use crate::layout::DeviceHit;
use crate::testing::{contexts, read};

/// Columns, and the rows of a band that begins and ends within the picture.
const WIDTH: usize = 75;
const ROWS: std::ops::Range<usize> = 8..57;

/// Around the camera: much of it beside it or behind it, some crosses the plane of its pinhole, and
/// it is within a sphere and before a floor that goes on behind it.
fn surrounding() -> Scene {
    let mut rng = Rng::new(91);
    let mut meshes = vec![
        triangle_soup(&mut rng, SoupKind::Plain, 1500, Vec3::ZERO, 6.0),
        triangle_soup(&mut rng, SoupKind::Needles, 300, Vec3::ZERO, 5.0),
        triangle_soup(&mut rng, SoupKind::MixedSizes, 60, Vec3::ZERO, 2.0),
        Mesh::from_spheres(spheres(&mut rng, 60, Vec3::ZERO, 6.0)),
        Mesh::from_spheres(vec![Sphere::new(Vec3::ZERO, 20.0)]),
    ];
    let floor = [[-30.0, -30.0], [30.0, -30.0], [30.0, 30.0], [-30.0, 30.0]];
    let floor = floor.map(|[x, z]| Vec3::new(x, -1.5, z)).to_vec();
    meshes.push(Mesh::from_triangles(floor, vec![[0, 1, 2], [0, 2, 3]]).unwrap());
    let object = |mesh| {
        let shape = Shape::Fixed(SurfaceMesh::new(mesh, MaterialIdx(0)));
        SceneObject { name: String::new(), node: None, mask: u32::MAX, shape }
    };
    let objects = meshes.into_iter().map(object).collect();
    Scene { materials: vec![Material::default()], objects, ..Scene::default() }
}

fn views() -> Vec<View> {
    let turned = Affine3A::from_rotation_y(0.7) * Affine3A::from_rotation_x(-0.3);
    let far = Affine3A::from_translation(Vec3::new(0.3, 0.2, 12.0));
    let parallel = Projection::Orthographic { height: 7.0 };
    let perspective = |vertical_fov| Projection::Perspective { vertical_fov };
    vec![
        View::new(turned, perspective(0.9)),
        View::new(turned, perspective(2.8)),
        View::new(far, perspective(0.02)),
        View::new(far, parallel),
        View::new(turned, parallel),
        // Not only turned but sheared and mirrored.
        View::new(far * Affine3A::from_scale(Vec3::new(-1.0, 0.5, 2.0)) * turned, perspective(0.6)),
    ]
}

/// Hits of the rays from the camera, by slot.
fn hits_by(
    renderer: &mut GpuRenderer,
    context: &GpuContext,
    picture: &Picture<'_>,
    band: &Band,
    sample_idx: u32,
    primary: PrimaryVisibility,
) -> Vec<DeviceHit> {
    let device = &mut renderer.device;
    device.primary = primary;
    let slot_count = band.slot_count();
    device.buffers.reserve(context, slot_count, band.pixel_count());
    let params = FrameParams { slot_count: slot_count as u32, ..picture.params(band, sample_idx) };
    device.buffers.params.write(context, &[params]);
    device.log.begin(context, 1);
    device.begin_wave(context, 0, &params);
    let is_scanned = device.find_primary(context, &params);
    assert_eq!(is_scanned, primary == PrimaryVisibility::ScanConverted);
    read(context, device.buffers.hits.buffer(), slot_count)
}

#[test]
fn rays_from_the_camera_hit_what_tracing_finds() {
    let scene = Arc::new(surrounding());
    let mut evaluator = Evaluator::new(Arc::clone(&scene), None).unwrap();
    let frame = evaluator.evaluate(0.0).unwrap();
    let prepared = PreparedFrame::new(&scene, frame).unwrap();
    let band = Band { rows: ROWS, width: WIDTH, height: 60 };
    for context in contexts() {
        let mut renderer = GpuRenderer::new(context).unwrap();
        renderer.commit(&scene, frame).unwrap();
        for (view_idx, view) in views().iter().enumerate() {
            let picture = Picture::new(&prepared, view, RenderSettings::default());
            for sample_idx in [0, 5] {
                let mut hits =
                    |primary| hits_by(&mut renderer, context, &picture, &band, sample_idx, primary);
                let traced = hits(PrimaryVisibility::Traced);
                let scanned = hits(PrimaryVisibility::ScanConverted);
                check(&scanned, &traced, view_idx);
            }
        }
    }
}

/// Distances agree but for rounding, and primitives too unless two are hit there.
fn check(scanned: &[DeviceHit], traced: &[DeviceHit], view_idx: usize) {
    let hit_count = traced.iter().filter(|hit| hit.rank != NO_RANK).count();
    assert!(hit_count > 1000, "view {view_idx} sees hardly anything");
    let mut other_count = 0;
    for (slot, (found, expected)) in scanned.iter().zip(traced).enumerate() {
        let apart = (found.t - expected.t).abs() > 2e-6 * expected.t;
        assert!(!apart, "view {view_idx}, slot {slot}: {found:?}, not {expected:?}");
        other_count += usize::from(found.rank != expected.rank);
    }
    assert!(other_count <= 3, "view {view_idx}: {other_count} other primitives");
}

#[test]
fn a_camera_without_width_is_not_scanned_and_neither_are_very_long_rows() {
    let frame = FrameParams {
        top_left: [-1.0, 1.0, -1.0],
        right: [0.1, 0.0, 0.0],
        down: [0.0, -0.1, 0.0],
        width: 20,
        row_count: 20,
        ..FrameParams::default()
    };
    let params = scan_params(&frame).unwrap();
    // What lies two ahead, a quarter of the picture to the right and three down.
    let [column, row, depth] = [params.column, params.row, params.depth].map(Vec3::from);
    let point = Vec3::new(-1.0, -1.0, -2.0);
    let place = [column, row].map(|axis| axis.dot(point) / depth.dot(point));
    assert!((place[0] - 5.0).abs() < 1e-5 && (place[1] - 15.0).abs() < 1e-5, "{place:?}");
    assert_eq!(depth.dot(point), 2.0);
    assert_eq!(scan_params(&FrameParams { right: [0.0; 3], ..frame }), None);
    assert_eq!(scan_params(&FrameParams { width: 8200, ..frame }), None);
}
