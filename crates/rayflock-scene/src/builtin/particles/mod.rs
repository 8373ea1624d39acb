//! `particles`: a fountain of 100,000 drops, each a sphere on a path of its own.
//!
//! Jets around a ring throw drops inward and upward; they fall on a stone floor, bounce and begin
//! again. Spheres only, all of which move in every frame: what particle systems, sprays and
//! granular simulations are made of.
//!
//! **Invariants.** The number of spheres stays, and so does the material of each; no drop is
//! below the floor; the animation repeats.

mod drops;

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Affine3A, Vec2, Vec3};

use super::keyed_path::{self, key_times};
use super::surface_builder::SurfaceBuilder;
use super::{matte, node, object, polished};
use crate::{
    Background, Camera, Clip, Falloff, Light, LightKind, Material, MaterialIdx, NodeIdx,
    Projection, Scene, SceneObject, Shape, SurfaceMesh,
};

/// Frames of the animation.
pub(super) const FRAME_COUNT: usize = 240;
const FRAME_RATE: f32 = 24.0;
/// Length of the animation in seconds.
const DURATION: f32 = FRAME_COUNT as f32 / FRAME_RATE;

/// Number of drops.
const DROPS: usize = 100_000;
/// Number of jets, each with a material of its own.
const JETS: usize = 6;

const STONE: MaterialIdx = MaterialIdx(JETS as u32);

/// The scene.
pub(super) fn build() -> Scene {
    let camera_node = NodeIdx(0);
    let drops = SceneObject {
        name: "drops".to_owned(),
        node: None,
        mask: u32::MAX,
        shape: Shape::Animated(Arc::new(drops::Drops::new())),
    };
    Scene {
        name: "particles".to_owned(),
        nodes: vec![node("camera", None, Vec3::ZERO)],
        objects: vec![object("floor", None, floor()), drops],
        materials: materials(),
        lights: lights(),
        cameras: vec![Camera {
            name: "camera".to_owned(),
            node: Some(camera_node),
            node_from_camera: Affine3A::IDENTITY,
            projection: Projection::Perspective { vertical_fov: 36.0_f32.to_radians() },
        }],
        clips: vec![orbit(camera_node)],
        ambient: Vec3::new(0.20, 0.22, 0.26),
        background: Some(Background::Gradient {
            zenith: Vec3::new(0.03, 0.05, 0.10),
            horizon: Vec3::new(0.16, 0.18, 0.24),
            ground: Vec3::splat(0.05),
        }),
        frame_rate: Some(f64::from(FRAME_RATE)),
        ..Scene::default()
    }
}

/// A colour a jet, around the wheel, and stone.
fn materials() -> Vec<Material> {
    let drop = |jet: usize| {
        let channel = |offset: f32| 0.42 + 0.38 * (TAU * (jet as f32 / JETS as f32 + offset)).cos();
        let color = Vec3::new(channel(0.0), channel(1.0 / 3.0), channel(2.0 / 3.0));
        Material { specular: Vec3::splat(0.3), shininess: 40.0, ..matte("drop", color) }
    };
    let mut materials: Vec<Material> = (0..JETS).map(drop).collect();
    materials.push(polished("stone", Vec3::new(0.13, 0.13, 0.15), 0.10));
    materials
}

/// A round floor with a low rim.
fn floor() -> SurfaceMesh {
    // From the rim down to the middle: the surface faces the drops.
    let profile = [(9.0, 0.0), (3.3, 0.0), (3.3, 0.18), (3.1, 0.18), (3.1, 0.0), (0.0, 0.0)];
    let mut builder = SurfaceBuilder::default();
    let profile = profile.map(|(radius, height)| Vec2::new(radius, height));
    builder.lathe(&profile, 96, &Affine3A::IDENTITY, STONE);
    builder.build()
}

fn lights() -> Vec<Light> {
    let light = |name: &str, position: Vec3, intensity: Vec3| Light {
        name: name.to_owned(),
        node: None,
        kind: LightKind::Point { position, intensity, falloff: Falloff::InverseSquare },
    };
    vec![
        light("key", Vec3::new(-4.0, 7.0, 5.0), Vec3::new(210.0, 195.0, 170.0)),
        light("rim", Vec3::new(5.0, 4.0, -5.0), Vec3::new(70.0, 85.0, 120.0)),
    ]
}

/// Once around in the course of the animation.
fn orbit(node: NodeIdx) -> Clip {
    let times = key_times(DURATION, FRAME_COUNT);
    let eye = |time: f32| {
        let (sin, cos) = (TAU * time / DURATION).sin_cos();
        Vec3::new(7.2 * sin, 2.9, 7.2 * cos)
    };
    let channels = keyed_path::camera_channels(node, &times, eye, |_| Vec3::new(0.0, 1.05, 0.0));
    Clip { name: "orbit".to_owned(), channels }
}
