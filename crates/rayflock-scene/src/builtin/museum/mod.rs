//! `museum3` ... `museum8`: a sculpture of `4^n` triangles that gather, swarm and take shape in a
//! mirrored hall.
//!
//! **Source.** J. Lext, U. Assarsson, T. Moller, "BART: A Benchmark for Animated Ray Tracing",
//! Chalmers, 2000: the scene `museum`. The sculpture's keys 2 to 4, the interval, the lights, the
//! lens and the mirrored shares are BART's.
//!
//! **Departures.** Keys 0 and 1 are regenerated (BART's are random and partly lost). The hall and
//! the camera's path are of our own design, in BART's spirit: about as many static triangles, a
//! mirrored floor, a pedestal, frames with pictures. A soft ambient light is added; triangles of
//! the sculpture are flat.
//!
//! **Time.** BART gives an interval of animation time, `first..last`, and 300 frames. Second `s`
//! of the scene is animation time `first + s`, and the frame rate is `300 / (last - first)`, so
//! that frame `f` shows animation time `first + f * (last - first) / 300`.
//!
//! **Invariants.** The sculpture is the only object that changes; it keeps its triangles.

mod camera_path;
mod dome;
mod furniture;
mod hall;
mod materials;
mod paintings;
mod sculpture;
mod sculpture_keys;

use std::sync::Arc;

use glam::Vec3;

use super::{nff_irradiance, object};
use crate::{Background, Falloff, Light, LightKind, Scene, SceneObject, Shape};

pub use sculpture_keys::{KEY_TIMES, sculpture_keys};

/// Frames of the animation.
pub(super) const FRAME_COUNT: usize = 300;

/// The animation time that the 300 frames span: BART's command `a`.
#[derive(Clone, Copy, Debug)]
struct Interval {
    first: f64,
    last: f64,
}

impl Interval {
    fn of_museum(n: u32) -> Self {
        let first = if n == 5 { -1.0 } else { -2.0 };
        Self { first, last: 5.0 }
    }

    fn duration(self) -> f64 {
        self.last - self.first
    }
}

/// The scene `museum<n>`; `None` unless `n` is from 3 to 8.
pub(super) fn build(n: u32) -> Option<Scene> {
    let interval = Interval::of_museum(n);
    let sculpture = sculpture::build(n, interval)?;
    let dynamic = SceneObject {
        name: "sculpture".to_owned(),
        node: None,
        mask: u32::MAX,
        shape: Shape::Animated(Arc::new(sculpture)),
    };
    let (node, camera, clip) = camera_path::build(interval.duration() as f32);
    Some(Scene {
        name: format!("museum{n}"),
        nodes: vec![node],
        objects: vec![object("hall", None, hall::surface()), dynamic],
        materials: materials::materials(),
        textures: paintings::textures(),
        lights: [-4.0, 4.0].map(|x| lamp(Vec3::new(x, 4.5, 0.0))).to_vec(),
        cameras: vec![camera],
        clips: vec![clip],
        ambient: Vec3::new(0.26, 0.27, 0.30),
        background: Some(Background::Gradient {
            zenith: Vec3::new(0.35, 0.55, 0.95),
            horizon: Vec3::new(0.75, 0.85, 1.0),
            ground: Vec3::new(0.3, 0.3, 0.3),
        }),
        frame_rate: Some(FRAME_COUNT as f64 / interval.duration()),
        ..Scene::default()
    })
}

fn lamp(position: Vec3) -> Light {
    let intensity = nff_irradiance(0.5);
    let kind = LightKind::Point { position, intensity, falloff: Falloff::Constant };
    Light { name: "lamp".to_owned(), node: None, kind }
}
