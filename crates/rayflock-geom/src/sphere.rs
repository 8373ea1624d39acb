//! Spheres: a primitive, and the bound of every other primitive.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::Aabb;

/// Unit roundoff of `f32` arithmetic, `2^-24`.
const UNIT_ROUNDOFF: f32 = f32::EPSILON / 2.0;

/// Enlarges a computed radius for the rounding of distances.
pub(crate) const RADIUS_FACTOR: f32 = 1.0 + 8.0 * UNIT_ROUNDOFF;

/// More than the length that a squared `f32` length can lose to underflow.
pub(crate) const UNDERFLOW: f32 = 1e-22;

/// A sphere. As a bound it holds all points within `radius` of `center`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Sphere {
    /// Centre.
    pub center: Vec3,
    /// Radius, in the same space as the centre.
    pub radius: f32,
}

impl Sphere {
    /// A sphere from its centre and radius.
    pub const fn new(center: Vec3, radius: f32) -> Self {
        Self { center, radius }
    }

    /// Whether the sphere can be hit: finite, with a positive radius.
    pub fn is_valid(&self) -> bool {
        self.center.is_finite() && self.radius.is_finite() && self.radius > 0.0
    }

    /// A sphere around a triangle.
    ///
    /// The centre is that of the bounding box; the radius is the largest distance to a vertex,
    /// enlarged so that the sphere holds the vertices in spite of rounding (relative error of
    /// the distance below 4 units, of the centre below 2).
    #[inline(always)]
    pub fn around_triangle(v0: Vec3, v1: Vec3, v2: Vec3) -> Self {
        let center = 0.5 * v0.min(v1).min(v2) + 0.5 * v0.max(v1).max(v2);
        let squared = |vertex: Vec3| (vertex - center).length_squared();
        let radius = squared(v0).max(squared(v1)).max(squared(v2)).sqrt();
        Self { center, radius: Self::enlarge(radius) }
    }

    /// A computed radius enlarged for the rounding of distances and for underflow.
    #[inline(always)]
    pub(crate) fn enlarge(radius: f32) -> f32 {
        radius * RADIUS_FACTOR + UNDERFLOW
    }

    /// A sphere around spheres, about the centre of the box around their centres. `None` without
    /// spheres. Iterates twice.
    pub fn around_spheres(spheres: impl Iterator<Item = Self> + Clone) -> Option<Self> {
        let center = Aabb::around(spheres.clone().map(|sphere| sphere.center)).center();
        let reach = |sphere: Self| (sphere.center - center).length() + sphere.radius;
        let radius = spheres.map(reach).reduce(f32::max)?;
        Some(Self { center, radius: Self::enlarge(radius) })
    }

    /// A sphere around both spheres.
    pub fn union(&self, other: &Self) -> Self {
        let offset = other.center - self.center;
        let distance = offset.length();
        if distance + other.radius <= self.radius {
            return *self;
        }
        if distance + self.radius <= other.radius {
            return *other;
        }
        let radius = 0.5 * (distance + self.radius + other.radius);
        let center = self.center + offset * ((radius - self.radius) / distance);
        // The centre is rounded, so measure again from where it came to lie.
        let reach = |sphere: &Self| (sphere.center - center).length() + sphere.radius;
        Self { center, radius: Self::enlarge(reach(self).max(reach(other))) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Vec3> {
        let exponent = prop_oneof![4 => -3..6_i32, 1 => -30..-18_i32];
        (prop::array::uniform3(-1.0..1.0_f32), exponent)
            .prop_map(|(p, e)| Vec3::from(p) * 10.0_f32.powi(e))
    }

    fn holds(sphere: &Sphere, p: Vec3) -> bool {
        (p.as_dvec3() - sphere.center.as_dvec3()).length() <= f64::from(sphere.radius)
    }

    proptest! {
        #[test]
        fn a_triangle_lies_in_its_sphere(a in point(), b in point(), c in point()) {
            let sphere = Sphere::around_triangle(a, b, c);
            for vertex in [a, b, c] {
                prop_assert!(holds(&sphere, vertex), "{vertex} not in {sphere:?}");
            }
        }

        #[test]
        fn spheres_lie_in_the_sphere_around_them(
            spheres in prop::collection::vec((point(), 0.0..10.0_f32), 1..17),
        ) {
            let spheres = spheres.iter().map(|&(center, radius)| Sphere::new(center, radius));
            let around = Sphere::around_spheres(spheres.clone()).unwrap();
            for sphere in spheres {
                let reach = (sphere.center.as_dvec3() - around.center.as_dvec3()).length();
                prop_assert!(reach + f64::from(sphere.radius) <= f64::from(around.radius));
            }
        }

        #[test]
        fn both_spheres_lie_in_their_union(
            a in point(), b in point(), ra in 0.0..10.0_f32, rb in 0.0..10.0_f32,
        ) {
            let union = Sphere::new(a, ra).union(&Sphere::new(b, rb));
            for (center, radius) in [(a, ra), (b, rb)] {
                let reach = (center.as_dvec3() - union.center.as_dvec3()).length();
                prop_assert!(reach + f64::from(radius) <= f64::from(union.radius));
            }
        }
    }
}
