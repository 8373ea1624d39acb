//! Axis-aligned boxes.

use glam::{Affine3A, Vec3};

/// A box between two corners; empty when `min > max` in some axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Smallest corner.
    pub min: Vec3,
    /// Largest corner.
    pub max: Vec3,
}

impl Aabb {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// Whether the box holds no point.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// The smallest box around the finite ones among `points`.
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Self {
        let finite = points.into_iter().filter(|point| point.is_finite());
        finite.fold(Self::EMPTY, |aabb, point| aabb.including(point))
    }

    /// This box, grown to hold `point`.
    pub fn including(&self, point: Vec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box around both.
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The middle.
    pub fn center(&self) -> Vec3 {
        0.5 * self.min + 0.5 * self.max
    }

    /// The edge lengths; zero for an empty box.
    pub fn size(&self) -> Vec3 {
        if self.is_empty() { Vec3::ZERO } else { self.max - self.min }
    }

    /// The box around this box's image under `transform`.
    pub fn transformed(&self, transform: &Affine3A) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let corner = |bits: u8| {
            let pick = |axis: usize| {
                if bits & (1 << axis) == 0 { self.min[axis] } else { self.max[axis] }
            };
            transform.transform_point3(Vec3::new(pick(0), pick(1), pick(2)))
        };
        Self::around((0..8).map(corner))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn around_skips_points_that_are_not_finite() {
        let aabb = Aabb::around([Vec3::ONE, Vec3::NAN, Vec3::INFINITY, -Vec3::ONE]);
        assert_eq!(aabb, Aabb { min: -Vec3::ONE, max: Vec3::ONE });
        assert!(Aabb::around([]).is_empty());
    }

    #[test]
    fn a_transformed_box_holds_the_transformed_corners() {
        let turn = Affine3A::from_rotation_y(std::f32::consts::FRAC_PI_4);
        let aabb = Aabb { min: -Vec3::ONE, max: Vec3::ONE }.transformed(&turn);
        assert!((aabb.max.x - 2.0_f32.sqrt()).abs() < 1e-6);
        assert!(Aabb::EMPTY.transformed(&turn).is_empty());
    }
}
