//! Lights.

use glam::{Affine3A, Vec3};

use crate::NodeIdx;

/// A light in its node's space.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Name in the file, for messages.
    pub name: String,
    /// The node that carries it; `None` for the world.
    pub node: Option<NodeIdx>,
    /// What it sends where.
    pub kind: LightKind,
}

/// Kinds of light, besides surfaces that emit (see [`Material::emission`](crate::Material)).
///
/// A surface of diffuse reflectance `k` that faces a light squarely sends back `k * E / pi`,
/// where `E` is the irradiance: `intensity / distance^2`, or `irradiance` itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// From a point, evenly.
    Point {
        /// Position.
        position: Vec3,
        /// Radiant intensity.
        intensity: Vec3,
        /// Whether irradiance falls with the square of the distance; BART's lights do not fall.
        falloff: Falloff,
    },
    /// From very far away.
    Directional {
        /// Where the light travels, of unit length.
        direction: Vec3,
        /// Irradiance of a surface that faces the light.
        irradiance: Vec3,
    },
    /// From a point into a cone.
    Spot {
        /// Position.
        position: Vec3,
        /// Axis of the cone, of unit length.
        direction: Vec3,
        /// Radiant intensity on the axis.
        intensity: Vec3,
        /// Cosine of the half angle up to which the intensity is full.
        cos_inner: f32,
        /// Cosine of the half angle from which on there is no light.
        cos_outer: f32,
    },
}

/// How the irradiance of a point light depends on distance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Falloff {
    /// With the inverse square, as in nature.
    #[default]
    InverseSquare,
    /// Not at all, as in NFF and BART scenes: `intensity` is the irradiance at any distance.
    Constant,
}

impl LightKind {
    /// The same light seen from the space that `transform` leads to.
    pub fn transformed(&self, transform: &Affine3A) -> Self {
        let point = |p: Vec3| transform.transform_point3(p);
        let axis = |d: Vec3| transform.transform_vector3(d).normalize_or(d);
        let mut moved = *self;
        match &mut moved {
            Self::Point { position, .. } => *position = point(*position),
            Self::Directional { direction, .. } => *direction = axis(*direction),
            Self::Spot { position, direction, .. } => {
                (*position, *direction) = (point(*position), axis(*direction));
            }
        }
        moved
    }
}
