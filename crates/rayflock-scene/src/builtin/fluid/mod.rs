//! `fluid`: a liquid sloshes in an open glass tank and throws drops that fall back into it.
//!
//! Its surface is taken from a field in each frame, so no two frames have the same triangles, and
//! drops part from the surface and join it again: what simulations of fluids hand out.
//!
//! **Source.** S. Gibson, "Constrained Elastic Surface Nets", MICCAI 1998, without the relaxation
//! (the crate `fast-surface-nets`), over a field of standing waves and balls joined smoothly
//! (J. Blinn, "A Generalization of Algebraic Surface Drawing", ACM TOG 1982, in spirit).
//!
//! **Departures.** Nothing is simulated: waves and drops are closed forms of time that repeat with
//! the animation. The glass has no thickness, so that a ray has bounces left for the liquid.
//!
//! **Invariants.** The surface is closed at all times and stays inside the tank.

mod field;
mod liquid;
mod splash;
mod studio;

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Affine3A, Vec3};

use super::keyed_path::{self, key_times};
use super::{matte, node, object, polished};
use crate::{
    Camera, Clip, Fresnel, Material, MaterialIdx, NodeIdx, Projection, Scene, SceneObject, Shape,
};

/// Frames of the animation.
pub(super) const FRAME_COUNT: usize = 240;
const FRAME_RATE: f32 = 24.0;
/// Length of the animation in seconds.
const DURATION: f32 = FRAME_COUNT as f32 / FRAME_RATE;

/// Half of the tank's width and depth, and its height; it stands on the plane `y == 0`.
const TANK: Vec3 = Vec3::new(1.0, 1.25, 0.5);

const LIQUID: MaterialIdx = MaterialIdx(0);
const GLASS: MaterialIdx = MaterialIdx(1);
const METAL: MaterialIdx = MaterialIdx(2);
const LIGHT_TILE: MaterialIdx = MaterialIdx(3);
const DARK_TILE: MaterialIdx = MaterialIdx(4);

/// The scene.
pub(super) fn build() -> Scene {
    let camera_node = NodeIdx(0);
    let liquid = SceneObject {
        name: "liquid".to_owned(),
        node: None,
        mask: u32::MAX,
        shape: Shape::Animated(Arc::new(liquid::Liquid::new())),
    };
    Scene {
        name: "fluid".to_owned(),
        nodes: vec![node("camera", None, Vec3::ZERO)],
        objects: vec![
            object("floor", None, studio::floor()),
            object("frame", None, studio::frame()),
            object("tank", None, studio::panes()),
            liquid,
        ],
        materials: materials(),
        lights: studio::lights(),
        cameras: vec![Camera {
            name: "camera".to_owned(),
            node: Some(camera_node),
            node_from_camera: Affine3A::IDENTITY,
            projection: Projection::Perspective { vertical_fov: 34.0_f32.to_radians() },
        }],
        clips: vec![sway(camera_node)],
        ambient: Vec3::new(0.34, 0.36, 0.40),
        background: Some(studio::background()),
        frame_rate: Some(f64::from(FRAME_RATE)),
        ..Scene::default()
    }
}

fn materials() -> Vec<Material> {
    vec![
        Material {
            transmission: Vec3::ONE,
            specular: Vec3::splat(0.6),
            shininess: 250.0,
            ior: 1.33,
            absorption: Vec3::new(0.85, 0.22, 0.10),
            fresnel: Fresnel::Dielectric,
            ..matte("liquid", Vec3::ZERO)
        },
        Material {
            transmission: Vec3::new(0.93, 0.97, 0.95),
            mirror: Vec3::splat(0.04),
            ior: 1.0,
            fresnel: Fresnel::Schlick,
            ..matte("glass", Vec3::ZERO)
        },
        polished("metal", Vec3::new(0.10, 0.10, 0.11), 0.35),
        matte("light tile", Vec3::new(0.78, 0.74, 0.66)),
        matte("dark tile", Vec3::new(0.30, 0.24, 0.19)),
    ]
}

/// The camera's sway: there and back again in one round of the animation.
fn sway(node: NodeIdx) -> Clip {
    let times = key_times(DURATION, FRAME_COUNT);
    let eye = |time: f32| {
        let (sway, cos) = (TAU * time / DURATION).sin_cos();
        let (sin_turn, cos_turn) = (0.45 * sway).sin_cos();
        Vec3::new(3.9 * sin_turn, 1.45 + 0.2 * cos, 3.9 * cos_turn)
    };
    let channels = keyed_path::camera_channels(node, &times, eye, |_| Vec3::new(0.0, 0.5, 0.0));
    Clip { name: "slosh".to_owned(), channels }
}
