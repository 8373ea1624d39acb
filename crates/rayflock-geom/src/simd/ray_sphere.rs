//! The one accepting ray-sphere test.
//!
//! The quadratic is solved in the form that keeps its digits when the sphere is small or far:
//! the discriminant from the distance between the centre and the ray, the roots from the one
//! that suffers no cancellation.
//!
//! ```text
//!   f = origin - centre     a = d.d     b = -(f.d)     l = f + (b/a) d      (the ray's point
//!   disc = r^2 - l.l        q = b + sign(b) sqrt(a disc)                     nearest the centre)
//!   roots: (f.f - r^2) / q  and  q / a; the smaller one within the interval is the hit
//! ```
//!
//! **Source.** E. Haines, J. Guenther, T. Akenine-Moeller, "Precision Improvements for Ray/Sphere
//! Intersection", Ray Tracing Gems, 2019, chapter 7.
//!
//! **Departures.** The direction is first divided by its largest coordinate, so that tiny and
//! huge directions neither underflow nor overflow; the roots are divided by it at the end.
//!
//! **Invariants.** One sequence of IEEE operations without FMA. A sphere that is accepted lies
//! within `radius` plus eight rounding units of `|f|` of the ray, less than
//! [`PERTURBATION`](super::ray_triangle::PERTURBATION). Squares are formed in `f32`: a sphere with
//! a radius below 1e-19, or farther away than 1e18, is out of range and missed.

use super::axes::{dot, load_axes, splat_axes, subtract};
use super::{Lanes, Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16};
use crate::{Ray, Sphere};

/// Sixteen rays as columns, for spheres.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct SphereRays {
    origin: [Lanes; 3],
    /// Directions divided by `size`.
    direction: [Lanes; 3],
    /// The largest coordinate of each direction, without its sign.
    size: Lanes,
    t_min: Lanes,
    t_max: Lanes,
}

impl SphereRays {
    /// Sixteen rays with empty intervals, which hit nothing.
    pub const EMPTY: Self = Self {
        origin: [[0.0; 16]; 3],
        direction: [[1.0; 16]; 3],
        size: [1.0; 16],
        t_min: [f32::INFINITY; 16],
        t_max: [f32::NEG_INFINITY; 16],
    };

    /// Writes an active ray into one lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, ray: &Ray) {
        let size = ray.direction.abs().max_element();
        for axis in 0..3 {
            self.origin[axis][lane] = ray.origin[axis];
            self.direction[axis][lane] = ray.direction[axis] / size;
        }
        self.size[lane] = size;
        self.t_min[lane] = ray.t_min;
        self.t_max[lane] = ray.t_max;
    }
}

/// Sixteen rays against one sphere: which of the `active` lanes hit it, and where.
#[inline(always)]
pub fn intersect_sphere<S: Simd>(
    simd: S,
    rays: &SphereRays,
    sphere: &Sphere,
    active: mask32x16<S>,
) -> (mask32x16<S>, f32x16<S>) {
    let d = load_axes(simd, &rays.direction);
    let f = subtract(load_axes(simd, &rays.origin), splat_axes(simd, sphere.center));
    let radius = f32x16::splat(simd, sphere.radius);
    let radius_squared = radius * radius;
    let a = dot(d, d);
    let b = -dot(f, d);

    // The discriminant, from the ray's point nearest the centre.
    let nearest = b / a;
    let l = [f[0] + nearest * d[0], f[1] + nearest * d[1], f[2] + nearest * d[2]];
    let discriminant = radius_squared - dot(l, l);
    let zero = f32x16::splat(simd, 0.0);
    let touched = active & discriminant.simd_ge(zero);
    if !touched.any_true() {
        // Roots cost more than all the rest.
        return (touched, zero);
    }

    // Both roots, in order, in multiples of the direction as given.
    let q = b + (a * discriminant).sqrt().copysign(b);
    let size = f32x16::from_slice(simd, &rays.size);
    let (first, second) = ((dot(f, f) - radius_squared) / q / size, q / a / size);
    let ordered = first.simd_le(second);
    let (lower, upper) = (ordered.select(first, second), ordered.select(second, first));
    let lower_accepted = touched & is_within(simd, lower, rays);
    let upper_accepted = touched & is_within(simd, upper, rays);
    (lower_accepted | upper_accepted, lower_accepted.select(lower, upper))
}

/// Where `t` is finite and in the interval of its ray.
#[inline(always)]
fn is_within<S: Simd>(simd: S, t: f32x16<S>, rays: &SphereRays) -> mask32x16<S> {
    t.simd_ge(f32x16::from_slice(simd, &rays.t_min))
        & t.simd_le(f32x16::from_slice(simd, &rays.t_max))
        & t.abs().simd_lt(f32x16::splat(simd, f32::INFINITY))
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use proptest::prelude::*;

    use super::super::{SimdLevel, dispatch};
    use super::*;

    /// The answer for one ray in lane 5, at every level; they must agree.
    fn hit(ray: &Ray, sphere: &Sphere) -> Option<f32> {
        let mut rays = SphereRays::EMPTY;
        rays.set(5, ray);
        let at_level = |level: SimdLevel| {
            dispatch!(level.level(), simd => {
                let active = mask32x16::splat(simd, true);
                let (accepted, t) = intersect_sphere(simd, &rays, sphere, active);
                assert_eq!(accepted.to_bitmask() & !(1 << 5), 0, "empty lanes hit nothing");
                accepted.test(5).then(|| t[5].to_bits())
            })
        };
        let answers: Vec<_> = SimdLevel::available().into_iter().map(at_level).collect();
        assert!(answers.windows(2).all(|pair| pair[0] == pair[1]), "{answers:?}");
        answers[0].map(f32::from_bits)
    }

    #[test]
    fn the_nearer_root_within_the_interval_is_taken() {
        let sphere = Sphere::new(Vec3::new(0.0, 0.0, 10.0), 2.0);
        let ray = Ray::new(Vec3::ZERO, 2.0 * Vec3::Z);
        assert_eq!(hit(&ray, &sphere), Some(4.0));
        assert_eq!(hit(&Ray { t_min: 4.5, ..ray }, &sphere), Some(6.0));
        assert_eq!(hit(&Ray { t_max: 4.0, ..ray }, &sphere), Some(4.0));
        assert_eq!(hit(&Ray { t_max: 3.9, ..ray }, &sphere), None);
        assert_eq!(hit(&Ray { t_min: 6.1, ..ray }, &sphere), None);
        assert_eq!(hit(&Ray::new(sphere.center, Vec3::X), &sphere), Some(2.0));
        assert_eq!(hit(&Ray::new(Vec3::ZERO, -Vec3::Z), &sphere), None);
        assert_eq!(hit(&Ray::new(Vec3::ZERO, Vec3::X), &sphere), None);
    }

    #[test]
    fn a_small_far_sphere_keeps_its_size() {
        let sphere = Sphere::new(Vec3::new(0.0, 0.0, 1e4), 0.05);
        let ray = |x: f32| Ray::new(Vec3::new(x, 0.0, 0.0), Vec3::Z);
        assert!(hit(&ray(0.049), &sphere).is_some());
        assert!(hit(&ray(0.051), &sphere).is_none());
    }

    proptest! {
        /// A ray at the outline that is accepted passes within eight rounding units of `|f|`.
        #[test]
        fn accepted_rays_pass_near_the_sphere(
            origin in prop::array::uniform3(-2.0..2.0_f32),
            center in prop::array::uniform3(-1.0..1.0_f32),
            aside in prop::array::uniform3(-1.0..1.0_f32),
            exponent in -6.0..0.0_f32,
            miss in -1e-6..1e-6_f32,
        ) {
            let (origin, center) = (Vec3::from(origin), Vec3::from(center));
            let radius = 10.0_f32.powf(exponent);
            let f = (origin - center).as_dvec3();
            let aside = f.cross(Vec3::from(aside).as_dvec3());
            prop_assume!(aside.length() > 1e-2 && f.length() > f64::from(radius));
            let target = center.as_dvec3() + f64::from(radius + miss) * aside.normalize();
            let ray = Ray::new(origin, (target - origin.as_dvec3()).as_vec3());
            if hit(&ray, &Sphere::new(center, radius)).is_some() {
                let along = f.project_onto(ray.direction.as_dvec3());
                let excess = (f - along).length() - f64::from(radius);
                let unit = f64::from(f32::EPSILON) / 2.0;
                prop_assert!(excess <= 8.0 * unit * f.length(), "{excess}");
            }
        }
    }

    #[test]
    fn the_length_of_the_direction_does_not_matter() {
        let sphere = Sphere::new(Vec3::new(0.0, 0.0, 10.0), 2.0);
        for length in [1e-36, 1e-20, 1.0, 1e20, 1e36] {
            let t = hit(&Ray::new(Vec3::ZERO, length * Vec3::Z), &sphere).unwrap();
            assert!((t * length / 8.0 - 1.0).abs() < 1e-6, "length {length}: {t}");
        }
    }
}
