//! Points of scenes and lights on their surfaces, and what is exactly in the way.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use std::sync::Arc;

use glam::Vec3;
use rayflock_engine::{EngineKind, RayEngine, create};
use rayflock_geom::{FrameChanges, Geometry, Hit, HitBuffer, PrimKind, RayBatch, transform_point};
use rayflock_render::occluders::{PointTile, SceneSpheres, SeenLight, SphereSettings, TileSight};
use rayflock_scene::{Evaluator, Projection, SceneFrame, builtin};

/// How far points lie off their surfaces, relative to the scene.
const OFFSET: f32 = 1e-4;

/// A point of a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfacePoint {
    pub(crate) position: Vec3,
    pub(crate) normal: Vec3,
}

/// Numbers from 0 to 1, always the same.
#[derive(Debug)]
pub(crate) struct Random(u64);

impl Random {
    pub(crate) const fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn next(&mut self) -> f32 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1_u32 << 24) as f32
    }

    fn direction(&mut self) -> Vec3 {
        let (z, turn) = (2.0 * self.next() - 1.0, std::f32::consts::TAU * self.next());
        let across = (1.0 - z * z).sqrt();
        Vec3::new(across * turn.cos(), across * turn.sin(), z)
    }
}

pub(crate) fn frame(scene: &str, time: f64) -> SceneFrame {
    let scene = Arc::new(builtin::build(scene).unwrap());
    Evaluator::new(scene, None).unwrap().evaluate(time).unwrap().clone()
}

/// What the camera sees through a grid of so many columns and rows, by rows of 4 x 4 tiles.
pub(crate) fn seen_points(
    scene: &str,
    frame: &SceneFrame,
    engine: &mut dyn RayEngine,
    side: usize,
) -> Vec<SurfacePoint> {
    let projection = builtin::build(scene).unwrap().cameras[0].projection;
    let Projection::Perspective { vertical_fov } = projection else { panic!("no pinhole") };
    let half = (0.5 * vertical_fov).tan();
    let camera = frame.cameras[0];
    let tiles = side / 4;
    let direction = |idx: usize| {
        let (tile, within) = (idx / 16, idx % 16);
        let (x, y) = (tile % tiles * 4 + within % 4, tile / tiles * 4 + within / 4);
        let at = |i: usize| (2.0 * (i as f32 + 0.5) / side as f32 - 1.0) * half;
        camera.transform_vector3(Vec3::new(at(x), -at(y), -1.0))
    };
    let directions: Vec<_> = (0..side * side).map(direction).collect();
    let origins = vec![Vec3::from(camera.translation); directions.len()];
    hit_points(frame, engine, &origins, &directions)
}

/// Lights on surfaces that are lit by what is seen: hits of random rays from there.
pub(crate) fn lights_on_surfaces(
    frame: &SceneFrame,
    engine: &mut dyn RayEngine,
    points: &[SurfacePoint],
    count: usize,
) -> Vec<SurfacePoint> {
    let mut random = Random::new(7);
    let mut lights = Vec::new();
    while lights.len() < count {
        let from: Vec<_> = (0..count)
            .map(|_| points[(random.next() * points.len() as f32) as usize % points.len()])
            .collect();
        let origins: Vec<_> = from.iter().map(|point| point.position).collect();
        let directions: Vec<_> =
            from.iter().map(|point| random.direction() + point.normal).collect();
        lights.extend(hit_points(frame, engine, &origins, &directions));
    }
    lights.truncate(count);
    lights
}

fn hit_points(
    frame: &SceneFrame,
    engine: &mut dyn RayEngine,
    origins: &[Vec3],
    directions: &[Vec3],
) -> Vec<SurfacePoint> {
    engine.commit(&frame.geometry, &FrameChanges::all()).unwrap();
    let mut hits = HitBuffer::new(origins.len());
    engine.closest_hit(&RayBatch::new(origins, directions).unwrap(), &mut hits.as_hits());
    let offset = OFFSET * frame.geometry.bounds().size().length();
    let point = |idx: usize| {
        let hit = hits.get(idx);
        let position = origins[idx] + hit.t * directions[idx];
        let normal = normal(&frame.geometry, &hit, position)?;
        let normal = if normal.dot(directions[idx]) > 0.0 { -normal } else { normal };
        Some(SurfacePoint { position: position + offset * normal, normal })
    };
    (0..origins.len()).filter_map(point).collect()
}

fn normal(geometry: &Geometry, hit: &Hit, position: Vec3) -> Option<Vec3> {
    let object = geometry.object(hit.object_id)?;
    let in_world = |v| object.world_from_object.map_or(v, |m| transform_point(&m, v));
    match object.shape.prim_kind(hit.prim_id) {
        PrimKind::Triangle(idx) => {
            let [a, b, c] = object.shape.corners(idx).map(in_world);
            (b - a).cross(c - a).try_normalize()
        }
        PrimKind::Sphere(idx) => {
            (position - in_world(object.shape.spheres()[idx].center)).try_normalize()
        }
        PrimKind::User(_) => None,
    }
}

/// What each point gets of each light, `[light * points.len() + point]`: exactly.
pub(crate) fn exact(
    points: &[SurfacePoint],
    lights: &[SurfacePoint],
    frame: &SceneFrame,
) -> Vec<f32> {
    let mut engine = create(EngineKind::Auto);
    engine.commit(&frame.geometry, &FrameChanges::all()).unwrap();
    let mut shares = Vec::new();
    for light in lights {
        let directions: Vec<_> =
            points.iter().map(|point| point.position - light.position).collect();
        let batch = RayBatch::new(light.position, &directions[..])
            .unwrap()
            .with_interval(0.0, 1.0)
            .unwrap();
        let mut occluded = vec![false; points.len()];
        engine.occluded(&batch, &mut occluded);
        shares.extend(occluded.iter().map(|&occluded| f32::from(u8::from(!occluded))));
    }
    shares
}

/// The same past spheres.
pub(crate) fn past_spheres(
    points: &[SurfacePoint],
    lights: &[SurfacePoint],
    spheres: &SceneSpheres,
    points_per_tile: usize,
) -> Vec<f32> {
    let lights: Vec<_> = lights
        .iter()
        .map(|light| SeenLight { position: light.position, normal: light.normal })
        .collect();
    let mut shares = vec![0.0; lights.len() * points.len()];
    let (mut tile, mut sight) = (PointTile::default(), TileSight::default());
    for (tile_idx, tile_points) in points.chunks(points_per_tile).enumerate() {
        let column = |of: fn(&SurfacePoint) -> Vec3| tile_points.iter().map(of).collect::<Vec<_>>();
        tile.assign(&column(|point| point.position), &column(|point| point.normal));
        for (group_idx, group) in lights.chunks(16).enumerate() {
            sight.see(spheres.tree(), &tile, group, |light_idx, block_idx, through| {
                let first = block_idx * 16;
                let count = (tile_points.len() - first).min(16);
                let start = (group_idx * 16 + light_idx) * points.len()
                    + tile_idx * points_per_tile
                    + first;
                shares[start..start + count].copy_from_slice(&through[..count]);
            });
        }
    }
    shares
}

/// The irradiance of each point if every light is matte and has the same power, distances below
/// a tenth of the scene counted as that.
pub(crate) fn irradiances(
    points: &[SurfacePoint],
    lights: &[SurfacePoint],
    shares: &[f32],
    size: f32,
) -> Vec<f32> {
    let least = (0.1 * size).powi(2);
    let from_light = |point: &SurfacePoint, light: &SurfacePoint| {
        let offset = light.position - point.position;
        let squared = offset.length_squared();
        let direction = offset / squared.sqrt().max(1e-12);
        point.normal.dot(direction).max(0.0) * light.normal.dot(-direction).max(0.0)
            / squared.max(least)
    };
    let of_point = |(idx, point): (usize, &SurfacePoint)| {
        let lights = lights.iter().enumerate();
        lights
            .map(|(light_idx, light)| {
                from_light(point, light) * shares[light_idx * points.len() + idx]
            })
            .sum()
    };
    points.iter().enumerate().map(of_point).collect()
}

pub(crate) fn spheres_of(frame: &SceneFrame, count: usize) -> SceneSpheres {
    let mut spheres = SceneSpheres::new(SphereSettings { count });
    spheres.commit(&frame.geometry);
    spheres
}
