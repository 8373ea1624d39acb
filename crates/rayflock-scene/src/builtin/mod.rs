//! Scenes that need no file: each is made by a program from the same nouns as a file would be.
//!
//! | Scene | What moves | Use it when |
//! |---|---|---|
//! | `cornell` | one sphere, rigidly | you check mirrors, glass and true spheres |
//! | `museum3` ... `museum8` | `4^n` triangles, each on its own | you compare with the papers |
//! | `shatter` | every triangle of a solid, from whole to rubble | no hierarchy could be refitted |
//! | `crowd` | twelve skinned figures | you want animation as productions have it |
//! | `fluid` | the surface of a liquid, of another topology in every frame | you want what simulations hand out |
//! | `particles` | 100,000 spheres, each on its own | there are no triangles at all |
//! | `stadium` | a teapot and four balls, rigidly, in an arena | sizes differ by a thousand |
//! | `teapot` | the same teapot alone | you want to know what the arena costs |
//!
//! **Invariants.** A scene depends on nothing but its name: two builds are equal (other machines
//! may round sines differently). Each has a camera, lights and at least 240 frames at its own
//! frame rate.

mod cornell;
mod crowd;
mod fluid;
mod keyed_path;
pub mod museum;
mod particles;
mod random;
mod shatter;
mod stadium;
mod surface_builder;
#[cfg(test)]
mod tests;

use std::f32::consts::PI;

use glam::{Quat, Vec3};

use crate::{
    Fresnel, LocalTransform, Material, Node, NodeIdx, Scene, SceneObject, Shape, SurfaceMesh,
};

/// A scene that needs no file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Builtin {
    /// What it is called by.
    pub name: &'static str,
    /// What it shows, in one line for the user.
    pub about: &'static str,
    /// How many frames it has at its own frame rate.
    pub frame_count: usize,
}

const fn museum(name: &'static str, about: &'static str) -> Builtin {
    Builtin { name, about, frame_count: museum::FRAME_COUNT }
}

const BUILTINS: &[Builtin] = &[
    Builtin {
        name: "cornell",
        about: "a glass sphere circles a mirror sphere in a box with coloured walls",
        frame_count: cornell::FRAME_COUNT,
    },
    Builtin {
        name: "crowd",
        about: "twelve skinned figures stroll around a fountain",
        frame_count: crowd::FRAME_COUNT,
    },
    Builtin {
        name: "fluid",
        about: "a liquid sloshes and splashes in a glass tank, with new triangles in every frame",
        frame_count: fluid::FRAME_COUNT,
    },
    Builtin {
        name: "particles",
        about: "a fountain of 100,000 drops, each a sphere on its own path",
        frame_count: particles::FRAME_COUNT,
    },
    Builtin {
        name: "shatter",
        about: "a porcelain knot is struck and its 23,040 triangles fly off one by one",
        frame_count: shatter::FRAME_COUNT,
    },
    Builtin {
        name: "stadium",
        about: "a teapot of 100,000 triangles turns in an arena one kilometer wide",
        frame_count: stadium::FRAME_COUNT,
    },
    Builtin {
        name: "teapot",
        about: "the teapot of the stadium alone",
        frame_count: stadium::FRAME_COUNT,
    },
    museum("museum3", "64 triangles swarm and take shape in a mirrored hall"),
    museum("museum4", "256 triangles swarm and take shape in a mirrored hall"),
    museum("museum5", "1,024 triangles swarm and take shape in a mirrored hall"),
    museum("museum6", "4,096 triangles swarm and take shape in a mirrored hall"),
    museum("museum7", "16,384 triangles swarm and take shape in a mirrored hall"),
    museum("museum8", "65,536 triangles swarm and take shape in a mirrored hall"),
];

/// All built-in scenes, each under its own name.
pub fn all() -> &'static [Builtin] {
    BUILTINS
}

/// The built-in scene of this name; `None` when there is none.
pub fn build(name: &str) -> Option<Scene> {
    all().iter().find(|builtin| builtin.name == name)?;
    match name {
        "cornell" => Some(cornell::build()),
        "crowd" => Some(crowd::build()),
        "fluid" => Some(fluid::build()),
        "particles" => Some(particles::build()),
        "shatter" => Some(shatter::build()),
        "stadium" => Some(stadium::build()),
        "teapot" => Some(stadium::build_teapot()),
        _ => museum::build(name.strip_prefix("museum")?.parse().ok()?),
    }
}

/// A node that clips can move, at `translation` at rest.
fn node(name: &str, parent: Option<NodeIdx>, translation: Vec3) -> Node {
    let rest = LocalTransform::Parts { translation, rotation: Quat::IDENTITY, scale: Vec3::ONE };
    Node { name: name.to_owned(), parent, rest, rest_weights: Vec::new() }
}

/// An object that all rays see and that moves with its node at most.
fn object(name: &str, node: Option<NodeIdx>, surface: SurfaceMesh) -> SceneObject {
    SceneObject { name: name.to_owned(), node, mask: u32::MAX, shape: Shape::Fixed(surface) }
}

/// A matte material whose ambient and diffuse shares are `color`.
fn matte(name: &str, color: Vec3) -> Material {
    Material { name: name.to_owned(), ambient: color, diffuse: color, ..Material::default() }
}

/// A polished material: matte, with a highlight and a mirrored share that grows at grazing angles.
fn polished(name: &str, color: Vec3, mirror: f32) -> Material {
    Material {
        mirror: Vec3::splat(mirror),
        specular: Vec3::splat(mirror.max(0.2)),
        shininess: 60.0,
        fresnel: Fresnel::Schlick,
        ..matte(name, color)
    }
}

/// The irradiance that a classic light of `grey` stands for: NFF multiplies the light's colour,
/// the diffuse share and the cosine, where this crate also divides by pi.
fn nff_irradiance(grey: f32) -> Vec3 {
    Vec3::splat(grey * PI)
}
