//! Where the knot breaks: a round studio whose floor runs up into its wall, a warm lamp, two cool
//! ones, and a camera that sways a little.

use std::f32::consts::{FRAC_PI_2, TAU};

use glam::{Affine3A, Vec2, Vec3};

use super::{DURATION, STAGE};
use crate::builtin::keyed_path;
use crate::builtin::surface_builder::SurfaceBuilder;
use crate::{
    Background, Camera, Channel, Falloff, Light, LightKind, NodeIdx, Projection, SurfaceMesh,
};

/// Radius up to which the floor is flat.
pub(super) const FLOOR_RADIUS: f32 = 9.0;
/// Radius of the bend between floor and wall.
const BEND: f32 = 4.0;
const WALL_HEIGHT: f32 = 12.0;

/// The studio.
pub(super) fn surface() -> SurfaceMesh {
    const BEND_PIECES: u32 = 10;
    const SEGMENTS: u32 = 72;
    // From the wall down to the middle of the floor: the surface faces the knot.
    let mut profile = vec![Vec2::new(FLOOR_RADIUS + BEND, WALL_HEIGHT)];
    for piece in 0..=BEND_PIECES {
        let (sin, cos) = (FRAC_PI_2 * piece as f32 / BEND_PIECES as f32).sin_cos();
        let height = if piece == BEND_PIECES { 0.0 } else { BEND * (1.0 - sin) };
        profile.push(Vec2::new(FLOOR_RADIUS + BEND * cos, height));
    }
    profile.extend([7.0, 5.5, 4.0, 2.5, 1.0, 0.0].map(|radius| Vec2::new(radius, 0.0)));
    let mut builder = SurfaceBuilder::default();
    builder.lathe(&profile, SEGMENTS, &Affine3A::IDENTITY, STAGE);
    builder.build()
}

/// Above the wall it is dusk.
pub(super) fn background() -> Background {
    Background::Gradient {
        zenith: Vec3::new(0.10, 0.13, 0.20),
        horizon: Vec3::new(0.30, 0.32, 0.38),
        ground: Vec3::splat(0.1),
    }
}

/// Key, rim and fill.
pub(super) fn lights() -> Vec<Light> {
    let light = |name: &str, kind| Light { name: name.to_owned(), node: None, kind };
    let falloff = Falloff::InverseSquare;
    let key = Vec3::new(4.0, 7.5, 5.0);
    vec![
        light(
            "warm key",
            LightKind::Spot {
                position: key,
                direction: (Vec3::new(0.0, 1.0, 0.0) - key).normalize_or(Vec3::NEG_Y),
                intensity: Vec3::new(250.0, 205.0, 150.0),
                cos_inner: 0.95,
                cos_outer: 0.72,
            },
        ),
        light(
            "cool rim",
            LightKind::Point {
                position: Vec3::new(-5.5, 4.5, -4.5),
                intensity: Vec3::new(45.0, 70.0, 120.0),
                falloff,
            },
        ),
        light(
            "fill",
            LightKind::Point {
                position: Vec3::new(-6.0, 6.0, 6.0),
                intensity: Vec3::new(26.0, 30.0, 36.0),
                falloff,
            },
        ),
    ]
}

/// The camera on its node.
pub(super) fn camera(node: NodeIdx) -> Camera {
    Camera {
        name: "camera".to_owned(),
        node: Some(node),
        node_from_camera: Affine3A::IDENTITY,
        projection: Projection::Perspective { vertical_fov: 40.0_f32.to_radians() },
    }
}

/// The camera's sway: there and back again in one round of the animation.
pub(super) fn camera_channels(node: NodeIdx, times: &[f32]) -> Vec<Channel> {
    let eye = |time: f32| {
        let (sway, cos) = (TAU * time / DURATION).sin_cos();
        let (sin_turn, cos_turn) = (0.35 * sway).sin_cos();
        let distance = 6.7 - 0.3 * cos;
        Vec3::new(distance * sin_turn, 2.1 + 0.25 * cos, distance * cos_turn)
    };
    keyed_path::camera_channels(node, times, eye, |_| Vec3::new(0.0, 1.45, 0.0))
}
