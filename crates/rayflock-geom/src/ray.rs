//! One ray, as scalar code sees it.

use glam::Vec3;

/// A ray with its interval and visibility mask.
///
/// Points on the ray are `origin + t * direction` for `t` in the closed interval
/// `t_min..=t_max`; the direction need not have unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Start, in world space.
    pub origin: Vec3,
    /// Direction, in world space; any length but zero.
    pub direction: Vec3,
    /// Smallest accepted `t`.
    pub t_min: f32,
    /// Largest accepted `t`; may be infinite.
    pub t_max: f32,
    /// A primitive can be hit only if `mask & object.mask != 0`.
    pub mask: u32,
}

/// Whether a ray can hit anything at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayState {
    /// The ray is traced.
    Active,
    /// The interval is empty (`t_max < t_min`): the caller switched the ray off.
    Inactive,
    /// A NaN, an infinite origin or direction, or a zero direction: a counted miss.
    Invalid,
}

impl Ray {
    /// A ray from `origin` along `direction`, with the interval `0..=infinity`, seeing all objects.
    pub const fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, t_min: 0.0, t_max: f32::INFINITY, mask: u32::MAX }
    }

    /// The point at parameter `t`.
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + t * self.direction
    }

    /// Whether the ray is traced, switched off or invalid.
    pub fn state(&self) -> RayState {
        let finite = self.origin.is_finite() && self.direction.is_finite();
        if !finite || self.direction == Vec3::ZERO || self.t_min.is_nan() || self.t_max.is_nan() {
            RayState::Invalid
        } else if self.t_min <= self.t_max {
            RayState::Active
        } else {
            RayState::Inactive
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn state_tells_active_inactive_and_invalid_apart() {
        let ray = Ray::new(Vec3::ZERO, Vec3::X);
        assert_eq!(ray.state(), RayState::Active);
        assert_eq!(Ray { t_min: 1.0, t_max: 1.0, ..ray }.state(), RayState::Active);
        assert_eq!(Ray { t_min: 2.0, t_max: 1.0, ..ray }.state(), RayState::Inactive);
        assert_eq!(Ray { t_min: f32::NAN, ..ray }.state(), RayState::Invalid);
        assert_eq!(Ray { direction: Vec3::ZERO, ..ray }.state(), RayState::Invalid);
        assert_eq!(Ray { origin: Vec3::INFINITY, ..ray }.state(), RayState::Invalid);
    }
}
