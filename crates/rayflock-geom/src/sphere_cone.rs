//! Cones that start from a sphere: the bound of a group of rays.

use glam::Vec3;

use crate::Sphere;

/// All rays that start in the sphere `origin` and deviate from `axis` by at most an angle below
/// 90 degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereCone {
    /// Holds the origins.
    pub origin: Sphere,
    /// The middle direction, of unit length.
    pub axis: Vec3,
    /// Cosine of the half angle; 0, together with a sine of 0, when nothing bounds the directions.
    pub cos: f32,
    /// Sine of the half angle.
    pub sin: f32,
}
