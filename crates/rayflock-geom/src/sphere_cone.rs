//! Cones that start from a sphere: the bound of a group of rays.
//!
//! ```text
//!            .-'  half angle a          A sphere (centre c, radius r) is touched by no ray of
//!        .-'                            the cone when
//!   ( o )-------------> axis                 p cos a - d sin a  >  radius of o + r
//!        '-.                            with v = c - centre of o, d = v . axis,
//!            '-.                             p = |v - d axis|; or d < -(the same sum).
//! ```
//!
//! **Source.** D. Roger, U. Assarsson, N. Holzschuch, "Whitted Ray-Tracing for Dynamic Scenes
//! using a Ray-Space Hierarchy on the GPU", EGSR 2007; the cones of L. Szecsi, "The Hierarchical
//! Ray Engine", WSCG 2006, have a point for an apex and cannot bound parallel rays.
//!
//! **Invariants.** Every ray given to a constructor starts in the sphere and deviates from the
//! axis by no more than the half angle, rounding included.

use glam::Vec3;

use crate::Sphere;

/// Rounding of an angle's sine or cosine that is measured between normalised `f32` vectors.
const ANGLE_ROUNDING: f32 = 2e-6;

/// Directions that deviate more than this cosine says are not bounded at all.
const SMALLEST_COS: f32 = 0.05;

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

impl SphereCone {
    /// The cone around one ray, given by its origin and unit direction.
    #[inline(always)]
    pub fn around_ray(origin: Vec3, direction: Vec3) -> Self {
        Self { origin: Sphere::new(origin, 0.0), axis: direction, cos: 1.0, sin: ANGLE_ROUNDING }
    }

    /// The cone around rays given by origins and unit directions, in two passes over `rays`.
    /// Without rays, a cone that starts in an empty sphere.
    pub fn around_rays(rays: impl Iterator<Item = (Vec3, Vec3)> + Clone) -> Self {
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let mut sum = Vec3::ZERO;
        for (origin, direction) in rays.clone() {
            (low, high) = (low.min(origin), high.max(origin));
            sum += direction;
        }
        let center = if low.x <= high.x { 0.5 * low + 0.5 * high } else { Vec3::ZERO };
        let axis = sum.normalize_or(Vec3::Z);

        let (mut reach_squared, mut cos, mut sin_squared) = (0.0_f32, 1.0_f32, 0.0_f32);
        for (origin, direction) in rays {
            reach_squared = reach_squared.max((origin - center).length_squared());
            let along = direction.dot(axis);
            cos = cos.min(along);
            sin_squared = sin_squared.max((direction - along * axis).length_squared());
        }
        let radius = if low == high { 0.0 } else { Sphere::enlarge(reach_squared.sqrt()) };
        Self::bounded(Sphere::new(center, radius), axis, cos, sin_squared.sqrt())
    }

    /// The cone around other cones.
    pub fn around_cones(cones: &[Self]) -> Self {
        let Some((first, rest)) = cones.split_first() else {
            return Self::around_rays(std::iter::empty());
        };
        let origin = rest.iter().fold(first.origin, |sphere, cone| sphere.union(&cone.origin));
        let axis = cones.iter().map(|cone| cone.axis).sum::<Vec3>().normalize_or(Vec3::Z);

        // The angle to a child's axis, plus the child's own half angle.
        let (mut cos, mut sin) = (1.0_f32, 0.0_f32);
        for cone in cones {
            let along = cone.axis.dot(axis);
            let across = (cone.axis - along * axis).length();
            let child_cos = along * cone.cos - across * cone.sin;
            if along < SMALLEST_COS || cone.cos == 0.0 || child_cos < SMALLEST_COS {
                return Self::unbounded(origin, axis);
            }
            cos = cos.min(child_cos);
            sin = sin.max(across * cone.cos + along * cone.sin);
        }
        Self::bounded(origin, axis, cos, sin)
    }

    /// The cone with the given extremes, enlarged for rounding, or an unbounded one.
    fn bounded(origin: Sphere, axis: Vec3, cos: f32, sin: f32) -> Self {
        let sin = sin + ANGLE_ROUNDING;
        if !(cos >= SMALLEST_COS && sin * sin < 1.0 - SMALLEST_COS * SMALLEST_COS) {
            return Self::unbounded(origin, axis);
        }
        Self { origin, axis, cos: (1.0 - sin * sin).sqrt(), sin }
    }

    /// A cone that bounds origins but no directions.
    const fn unbounded(origin: Sphere, axis: Vec3) -> Self {
        Self { origin, axis, cos: 0.0, sin: 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn vector(scale: f32) -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-1.0..1.0_f32).prop_map(move |v| scale * Vec3::from(v))
    }

    fn rays() -> impl Strategy<Value = Vec<(Vec3, Vec3)>> {
        let spread = prop_oneof![Just(0.0), Just(1e-4), Just(0.1), Just(1.0), Just(3.0)];
        (vector(1.0), spread, 0.0..100.0_f32).prop_flat_map(|(main, spread, scale)| {
            let ray = (vector(scale), vector(spread))
                .prop_map(move |(origin, noise)| (origin, (main + noise).normalize_or(Vec3::X)));
            prop::collection::vec(ray, 1..20)
        })
    }

    /// Whether the cone holds the ray, measured in `f64`.
    fn holds(cone: &SphereCone, (origin, direction): (Vec3, Vec3)) -> bool {
        let offset = origin.as_dvec3() - cone.origin.center.as_dvec3();
        let axis = cone.axis.as_dvec3().normalize();
        let direction = direction.as_dvec3().normalize();
        let cos = direction.dot(axis);
        let sin = (direction - cos * axis).length();
        let directed = cone.cos == 0.0 || (cos > 0.0 && sin <= f64::from(cone.sin));
        offset.length() <= f64::from(cone.origin.radius) && directed
    }

    proptest! {
        #[test]
        fn a_cone_holds_its_rays(rays in rays()) {
            let cone = SphereCone::around_rays(rays.iter().copied());
            for ray in rays {
                prop_assert!(holds(&cone, ray), "{ray:?} not in {cone:?}");
            }
        }

        #[test]
        fn a_cone_of_cones_holds_all_rays(groups in prop::collection::vec(rays(), 1..5)) {
            let around = |rays: &Vec<_>| SphereCone::around_rays(rays.iter().copied());
            let cones: Vec<_> = groups.iter().map(around).collect();
            let parent = SphereCone::around_cones(&cones);
            for ray in groups.into_iter().flatten() {
                prop_assert!(holds(&parent, ray), "{ray:?} not in {parent:?}");
            }
        }
    }

    proptest! {
        #[test]
        fn a_cone_of_one_ray_holds_it(origin in vector(100.0), direction in vector(1.0)) {
            let ray = (origin, direction.normalize_or(Vec3::X));
            prop_assert!(holds(&SphereCone::around_ray(ray.0, ray.1), ray));
        }
    }

    #[test]
    fn opposite_directions_are_not_bounded() {
        let rays = [(Vec3::ZERO, Vec3::X), (Vec3::ZERO, -Vec3::X)];
        let cone = SphereCone::around_rays(rays.into_iter());
        assert_eq!((cone.cos, cone.sin), (0.0, 0.0));
    }
}
