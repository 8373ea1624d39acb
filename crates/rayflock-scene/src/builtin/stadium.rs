//! `stadium`: a teapot of a hundred thousand triangles turns in the middle of an arena one
//! kilometer wide, while balls fly over the field far away. `teapot`: the same teapot alone, to see
//! what the arena costs.
//!
//! The proverbial case for nested structures: what is fine for the arena is coarse for the teapot.
//! P. Khanna, J. Mortensen, I. Yu and M. Slater name it as future work ("Fast Ray Tracing of Scenes
//! With Unstructured Motion", SIGGRAPH 2004 posters). All motion is rigid.

use std::f32::consts::{FRAC_PI_2, TAU};

use glam::{Affine3A, Quat, Vec2, Vec3};

use super::keyed_path::{camera_channels, key_times, rotation_channel, translation_channel};
use super::surface_builder::SurfaceBuilder;
use super::{matte, node, object, polished};
use crate::{
    Background, Camera, Clip, Light, LightKind, Material, MaterialIdx, NodeIdx, Projection, Scene,
    SurfaceMesh,
};

/// Frames of one turn of the teapot.
pub(super) const FRAME_COUNT: usize = 240;
const FRAME_RATE: f32 = 24.0;

/// Where the field ends and the stands begin, and where these end, in meters from the middle.
const FIELD: f32 = 300.0;
const OUTSIDE: f32 = 500.0;
const STEPS: u32 = 40;

/// Height of the teapot over the field at rest.
const HOVER: f32 = 0.5;

const BALL_COUNT: u32 = 4;
const BALL_RADIUS: f32 = 1.2;

const GRASS: MaterialIdx = MaterialIdx(0);
const CONCRETE: MaterialIdx = MaterialIdx(1);
const PORCELAIN: MaterialIdx = MaterialIdx(2);
const LEATHER: MaterialIdx = MaterialIdx(3);

const TEAPOT: NodeIdx = NodeIdx(0);
const CAMERA: NodeIdx = NodeIdx(1);

/// The teapot in the arena.
pub(super) fn build() -> Scene {
    let mut scene = build_teapot();
    scene.name = "stadium".to_owned();
    scene.objects.insert(0, object("arena", None, arena()));
    let (ball, times) = (ball(), times());
    for idx in 0..BALL_COUNT {
        let ball_node = NodeIdx(scene.nodes.len() as u32);
        scene.nodes.push(node("ball", None, ball_center(idx, 0.0)));
        scene.objects.push(object("ball", Some(ball_node), ball.clone()));
        let channel = translation_channel(ball_node, &times, |time| ball_center(idx, turn(time)));
        scene.clips[0].channels.push(channel);
    }
    scene
}

/// The teapot alone.
pub(super) fn build_teapot() -> Scene {
    Scene {
        name: "teapot".to_owned(),
        nodes: vec![node("teapot", None, HOVER * Vec3::Y), node("camera", None, Vec3::ZERO)],
        objects: vec![object("teapot", Some(TEAPOT), teapot())],
        materials: materials(),
        lights: vec![Light {
            name: "sun".to_owned(),
            node: None,
            kind: LightKind::Directional {
                direction: Vec3::new(-0.5, -0.8, -0.35).normalize(),
                irradiance: Vec3::new(2.6, 2.5, 2.3),
            },
        }],
        cameras: vec![camera()],
        clips: vec![motion()],
        ambient: Vec3::new(0.25, 0.27, 0.32),
        background: Some(Background::Gradient {
            zenith: Vec3::new(0.25, 0.45, 0.9),
            horizon: Vec3::new(0.7, 0.8, 0.95),
            ground: Vec3::new(0.3, 0.3, 0.3),
        }),
        frame_rate: Some(f64::from(FRAME_RATE)),
        ..Scene::default()
    }
}

fn materials() -> Vec<Material> {
    vec![
        matte("grass", Vec3::new(0.15, 0.38, 0.10)),
        matte("concrete", Vec3::new(0.55, 0.54, 0.52)),
        polished("porcelain", Vec3::new(0.80, 0.78, 0.74), 0.08),
        polished("leather", Vec3::new(0.75, 0.25, 0.12), 0.04),
    ]
}

/// The field, and stands that rise around it in steps.
fn arena() -> SurfaceMesh {
    let mut surface = SurfaceBuilder::default();
    let corner = |x: f32, z: f32| Vec3::new(x * OUTSIDE, 0.0, z * OUTSIDE);
    let field = [corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)];
    surface.patch(field, [32, 32], GRASS);

    // From the outer edge inward, so that the seen side is that of the field.
    let tread = (OUTSIDE - FIELD) / STEPS as f32;
    let mut profile = Vec::new();
    for step in (0..STEPS).rev() {
        let (inner, top) = (FIELD + tread * step as f32, 1.5 * (step + 1) as f32);
        profile.push(Vec2::new(inner + tread, top));
        profile.push(Vec2::new(inner, top));
    }
    profile.push(Vec2::new(FIELD, 0.0));
    surface.lathe(&profile, 240, &Affine3A::IDENTITY, CONCRETE);
    surface.build()
}

/// Body with lid, handle and spout.
fn teapot() -> SurfaceMesh {
    let mut surface = SurfaceBuilder::default();
    let body: Vec<Vec2> = (0..=100).map(|ring| body_profile(ring as f32 / 100.0)).collect();
    surface.lathe(&body, 400, &Affine3A::IDENTITY, PORCELAIN);

    // A ring that stands upright.
    let circle = |radius: f32, thickness: f32, rings: u32| -> Vec<Vec2> {
        let around = |ring| Vec2::from_angle(TAU * ring as f32 / rings as f32);
        (0..=rings).map(|ring| Vec2::new(radius, 0.0) + thickness * around(ring)).collect()
    };
    let place = |turn: Quat, at: Vec3| Affine3A::from_rotation_translation(turn, at);
    let upright = place(Quat::from_rotation_x(FRAC_PI_2), Vec3::new(-0.5, 0.42, 0.0));
    surface.lathe(&circle(0.22, 0.045, 48), 128, &upright, PORCELAIN);

    let spout: Vec<Vec2> = (0..=32)
        .map(|ring| ring as f32 / 32.0)
        .map(|along| Vec2::new(0.13 - 0.09 * along.sqrt(), 0.55 * along))
        .collect();
    let tilted = place(Quat::from_rotation_z(-0.9), Vec3::new(0.38, 0.28, 0.0));
    surface.lathe(&spout, 96, &tilted, PORCELAIN);
    surface.build()
}

/// The outline of the body, from the middle of the bottom to the top of the knob on the lid.
fn body_profile(along: f32) -> Vec2 {
    const OUTLINE: [[f32; 2]; 12] = [
        [0.0, 0.0],
        [0.28, 0.0],
        [0.40, 0.08],
        [0.50, 0.25],
        [0.50, 0.45],
        [0.42, 0.62],
        [0.34, 0.70],
        [0.30, 0.72],
        [0.12, 0.79],
        [0.05, 0.82],
        [0.08, 0.90],
        [0.0, 0.95],
    ];
    let place = along * (OUTLINE.len() - 1) as f32;
    let idx = (place as usize).min(OUTLINE.len() - 2);
    Vec2::from(OUTLINE[idx]).lerp(Vec2::from(OUTLINE[idx + 1]), place - idx as f32)
}

/// A ball around the origin.
fn ball() -> SurfaceMesh {
    let mut surface = SurfaceBuilder::default();
    let profile: Vec<Vec2> = (0..=32)
        .map(|ring| {
            let (sin, cos) = (0.5 * TAU * ring as f32 / 32.0).sin_cos();
            BALL_RADIUS * Vec2::new(if ring % 32 == 0 { 0.0 } else { sin }, -cos)
        })
        .collect();
    surface.lathe(&profile, 80, &Affine3A::IDENTITY, LEATHER);
    surface.build()
}

/// Where a ball is after `turn` rounds, from 0 to 1: on its own arc over the field.
fn ball_center(idx: u32, turn: f32) -> Vec3 {
    let start = idx as f32 / BALL_COUNT as f32;
    let (sin, cos) = (TAU * (turn + start)).sin_cos();
    let reach = 120.0 + 50.0 * idx as f32;
    Vec3::new(reach * cos, 15.0 + 12.0 * (2.0 * TAU * turn + start).cos(), reach * sin)
}

fn camera() -> Camera {
    Camera {
        name: "camera".to_owned(),
        node: Some(CAMERA),
        node_from_camera: Affine3A::IDENTITY,
        projection: Projection::Perspective { vertical_fov: 38.0_f32.to_radians() },
    }
}

const DURATION: f32 = FRAME_COUNT as f32 / FRAME_RATE;

/// The times of all keys.
fn times() -> Vec<f32> {
    key_times(DURATION, FRAME_COUNT)
}

/// Rounds until a time, from 0 to 1.
fn turn(time: f32) -> f32 {
    time / DURATION
}

/// The teapot turns and bobs, the camera goes around it.
fn motion() -> Clip {
    let times = times();
    let bob = |time: f32| (HOVER + 0.2 * (2.0 * TAU * turn(time)).sin()) * Vec3::Y;
    let spin = |time: f32| {
        Quat::from_rotation_y(TAU * turn(time))
            * Quat::from_rotation_z(0.25 * (TAU * turn(time)).sin())
    };
    let eye = |time: f32| {
        let (sin, cos) = (0.4 * (TAU * turn(time)).sin()).sin_cos();
        Vec3::new(2.6 * sin, 1.5, 2.6 * cos)
    };
    let mut channels = vec![rotation_channel(TEAPOT, &times, spin)];
    channels.push(translation_channel(TEAPOT, &times, bob));
    channels.extend(camera_channels(CAMERA, &times, eye, |_| 0.85 * Vec3::Y));
    Clip { name: "motion".to_owned(), channels }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_teapot_has_a_hundred_thousand_triangles_and_the_arena_a_kilometer() {
        let teapot = teapot();
        assert!((90_000..110_000).contains(&teapot.mesh.triangles().len()));
        assert!(teapot.mesh.bounds().size().max_element() < 2.0);
        let arena = arena();
        assert_eq!(arena.mesh.bounds().size().max_element(), 2.0 * OUTSIDE);
    }

    #[test]
    fn balls_stay_over_the_field() {
        for (idx, frame) in (0..BALL_COUNT).flat_map(|idx| (0..48).map(move |frame| (idx, frame))) {
            let center = ball_center(idx, frame as f32 / 48.0);
            assert!(center.y > BALL_RADIUS && center.with_y(0.0).length() < FIELD, "{center}");
        }
    }
}
