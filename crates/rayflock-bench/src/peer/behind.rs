//! Rays that begin behind their origin, which other libraries do not know.
//!
//! Such a ray is moved back to where it begins, at most by the extent of the frame, and its hits
//! are moved forward again.

use glam::Vec3;
use rayflock::geom::Ray;

/// How far the origin of `ray` is moved along its direction, in multiples of the direction: 0, or
/// less for a ray that begins behind its origin. `lower` and `upper` are corners of a box around
/// everything that can be hit.
pub(super) fn shift(ray: &Ray, lower: Vec3, upper: Vec3) -> f32 {
    if ray.t_min >= 0.0 {
        return 0.0;
    }
    let farthest = (lower - ray.origin).abs().max((upper - ray.origin).abs());
    let reach = farthest.length() / ray.direction.length();
    if reach.is_finite() { ray.t_min.max(-reach) } else { 0.0 }
}

/// The ray that begins at `t_min - shift`, its origin moved along its direction by `shift`.
pub(super) fn moved(ray: &Ray, shift: f32) -> Ray {
    if shift == 0.0 {
        return *ray;
    }
    Ray { origin: ray.at(shift), t_min: 0.0, t_max: ray.t_max - shift, ..*ray }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_rays_that_begin_behind_are_moved_and_no_further_than_needed() {
        let ray = Ray::new(Vec3::new(1.0, 0.0, 0.0), 2.0 * Vec3::X);
        let shift_from = |t_min| shift(&Ray { t_min, ..ray }, -Vec3::X, Vec3::X);
        assert_eq!(shift_from(0.5), 0.0);
        assert_eq!(shift_from(-0.75), -0.75);
        assert_eq!(shift_from(f32::NEG_INFINITY), -1.0);

        let ray = Ray { t_min: -0.5, t_max: 4.0, ..ray };
        let moved = moved(&ray, -0.5);
        assert_eq!((moved.origin, moved.t_min, moved.t_max), (Vec3::ZERO, 0.0, 4.5));
    }
}
