//! Small scenes and the means to render them.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use std::sync::Arc;

use glam::{Affine3A, Vec2, Vec3};
use rayflock_engine::{EngineKind, create};
use rayflock_geom::{Mesh, Sphere};
use rayflock_render::reference;
use rayflock_render::{Film, FrameRenderer, FrameStats, RenderSettings, View, WhittedRenderer};
use rayflock_scene::{
    Background, Evaluator, Falloff, Fresnel, Light, LightKind, Material, MaterialIdx, Projection,
    Scene, SceneFrame, SceneObject, Shape, SurfaceAttributes, SurfaceMesh, Texture, TextureIdx,
};

/// A scene of fixed objects in world space, over a black background.
pub(crate) fn scene(objects: Vec<(Mesh, Material)>, lights: Vec<LightKind>) -> Scene {
    let mut scene = Scene { background: Some(Background::default()), ..Scene::default() };
    for (mesh, material) in objects {
        let material_idx = MaterialIdx(scene.materials.len() as u32);
        scene.materials.push(material);
        add_surface(&mut scene, SurfaceMesh::new(mesh, material_idx));
    }
    for kind in lights {
        scene.lights.push(Light { name: "light".to_owned(), node: None, kind });
    }
    scene
}

pub(crate) fn add_surface(scene: &mut Scene, surface: SurfaceMesh) {
    let name = format!("object {}", scene.objects.len());
    let shape = Shape::Fixed(surface);
    scene.objects.push(SceneObject { name, node: None, mask: u32::MAX, shape });
}

pub(crate) fn frame_of(scene: &Scene) -> SceneFrame {
    let mut evaluator = Evaluator::new(Arc::new(scene.clone()), None).unwrap();
    evaluator.evaluate(0.0).unwrap().clone()
}

pub(crate) fn render_with(
    kind: EngineKind,
    scene: &Scene,
    view: &View,
    settings: &RenderSettings,
    size: (usize, usize),
) -> (Film, FrameStats) {
    render_by(&mut WhittedRenderer::new(create(kind)), scene, view, settings, size)
}

pub(crate) fn render_by(
    renderer: &mut dyn FrameRenderer,
    scene: &Scene,
    view: &View,
    settings: &RenderSettings,
    (width, height): (usize, usize),
) -> (Film, FrameStats) {
    renderer.commit(scene, &frame_of(scene)).unwrap();
    let mut film = Film::new(width, height);
    let stats = renderer.render(view, settings, &mut film);
    (film, stats)
}

pub(crate) fn render(
    scene: &Scene,
    view: &View,
    settings: &RenderSettings,
    size: (usize, usize),
) -> Film {
    render_with(EngineKind::Brute, scene, view, settings, size).0
}

pub(crate) fn render_reference(
    scene: &Scene,
    view: &View,
    settings: &RenderSettings,
    (width, height): (usize, usize),
) -> Film {
    let mut film = Film::new(width, height);
    let mut engine = create(EngineKind::Brute);
    reference::render(&mut *engine, scene, &frame_of(scene), view, settings, &mut film).unwrap();
    film
}

pub(crate) fn mean(film: &Film) -> Vec3 {
    film.pixels().iter().map(|pixel| Vec3::from(*pixel)).sum::<Vec3>() / film.pixels().len() as f32
}

/// The one pixel that looks from `eye` at `target`.
pub(crate) fn radiance(scene: &Scene, eye: Vec3, target: Vec3, settings: &RenderSettings) -> Vec3 {
    Vec3::from(render(scene, &look_at(eye, target), settings, (1, 1)).pixel(0, 0))
}

pub(crate) fn look_at(eye: Vec3, target: Vec3) -> View {
    let up = if (target - eye).cross(Vec3::Y).length() < 1e-3 { Vec3::Z } else { Vec3::Y };
    let back = (eye - target).normalize();
    let right = up.cross(back).normalize();
    let columns = (right.into(), back.cross(right).into(), back.into());
    View::new(
        Affine3A::from_cols(columns.0, columns.1, columns.2, eye.into()),
        Projection::Perspective { vertical_fov: 0.7 },
    )
}

/// A square of side `2 * half` in the plane at `center` with `normal`.
pub(crate) fn square(center: Vec3, normal: Vec3, half: f32) -> Mesh {
    let (side, up) = normal.any_orthonormal_pair();
    let corner = |s: f32, u: f32| center + (side * s + up * u) * half;
    let corners = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    Mesh::from_triangles(corners, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

/// A cube of side 2 around the origin, its sides wound as seen from inside.
pub(crate) fn closed_room() -> Mesh {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]);
    let sides: Vec<Mesh> = axes.map(|axis| square(axis, -axis, 1.0)).collect();
    let vertices = sides.iter().flat_map(|side| side.vertices().to_vec()).collect();
    let triangles = sides.iter().enumerate().flat_map(|(side_idx, side)| {
        let first = 4 * side_idx as u32;
        side.triangles().iter().map(move |corners| corners.map(|corner| first + corner))
    });
    Mesh::from_triangles(vertices, triangles.collect::<Vec<_>>()).unwrap()
}

pub(crate) fn ball(center: Vec3, radius: f32) -> Mesh {
    Mesh::from_spheres(vec![Sphere::new(center, radius)])
}

/// A sphere of triangles, wound outward, with its normals.
pub(crate) fn tessellated_ball(center: Vec3, radius: f32, rings: usize) -> (Mesh, Vec<Vec3>) {
    let columns = 2 * rings;
    let mut normals = Vec::new();
    for ring in 0..=rings {
        for column in 0..=columns {
            let latitude = std::f32::consts::PI * ring as f32 / rings as f32;
            let longitude = std::f32::consts::TAU * (column % columns) as f32 / columns as f32;
            let (sin, cos) = if ring == rings { (0.0, -1.0) } else { latitude.sin_cos() };
            normals.push(Vec3::new(sin * longitude.sin(), cos, sin * longitude.cos()));
        }
    }
    let idx = |ring: usize, column: usize| (ring * (columns + 1) + column) as u32;
    let mut triangles = Vec::new();
    for (ring, column) in (0..rings).flat_map(|r| (0..columns).map(move |c| (r, c))) {
        let (a, b) = (idx(ring, column), idx(ring, column + 1));
        let (c, d) = (idx(ring + 1, column), idx(ring + 1, column + 1));
        triangles.extend([[a, c, b], [b, c, d]]);
    }
    let vertices = normals.iter().map(|normal| center + radius * *normal).collect();
    (Mesh::from_triangles(vertices, triangles).unwrap(), normals)
}

pub(crate) fn matte(diffuse: Vec3) -> Material {
    Material { diffuse, ambient: diffuse, ..Material::default() }
}

pub(crate) fn mirror(share: f32) -> Material {
    let black = matte(Vec3::ZERO);
    Material { mirror: Vec3::splat(share), ..black }
}

pub(crate) fn glass(ior: f32) -> Material {
    let (transmission, fresnel) = (Vec3::ONE, Fresnel::Dielectric);
    Material { transmission, ior, fresnel, ..matte(Vec3::ZERO) }
}

pub(crate) fn emitter(radiance: Vec3) -> Material {
    Material { emission: radiance, ..matte(Vec3::ZERO) }
}

pub(crate) fn sun(direction: Vec3, irradiance: f32) -> LightKind {
    let (direction, irradiance) = (direction.normalize(), Vec3::splat(irradiance));
    LightKind::Directional { direction, irradiance }
}

pub(crate) fn lamp(position: Vec3, intensity: f32) -> LightKind {
    let (intensity, falloff) = (Vec3::splat(intensity), Falloff::InverseSquare);
    LightKind::Point { position, intensity, falloff }
}

/// A square on the floor with a checker texture and vertex colours.
pub(crate) fn textured_floor(scene: &mut Scene, half: f32) {
    let texels: Vec<[f32; 3]> = (0..16)
        .map(|i| if (i + i / 4) % 2 == 0 { [0.9, 0.8, 0.1] } else { [0.1, 0.2, 0.7] })
        .collect();
    let texture_idx = TextureIdx(scene.textures.len() as u32);
    let name = "checker".to_owned();
    scene.textures.push(Texture { name, width: 4, height: 4, texels: texels.into() });
    let material_idx = MaterialIdx(scene.materials.len() as u32);
    let white = matte(Vec3::ONE);
    scene.materials.push(Material { diffuse_texture: Some(texture_idx), ..white });
    let mut surface = SurfaceMesh::new(square(Vec3::ZERO, Vec3::Y, half), material_idx);
    surface.attributes = Arc::new(SurfaceAttributes {
        uvs: vec![Vec2::ZERO, Vec2::new(2.0, 0.0), Vec2::new(2.0, 2.0), Vec2::new(0.0, 2.0)],
        colors: vec![Vec3::ONE, Vec3::ONE, Vec3::new(1.0, 0.5, 0.5), Vec3::ONE],
        materials: surface.attributes.materials.clone(),
    });
    add_surface(scene, surface);
}
