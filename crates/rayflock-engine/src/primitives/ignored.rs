//! Primitives that are left out: how many, and why.

use std::ops::{Add, AddAssign};

use glam::Vec3;
use rayflock_geom::simd::SimdLevel;
use rayflock_geom::{FrameChanges, Geometry, Sphere};

use super::table::PrimitiveTable;

/// Primitives of a geometry that no ray hits, and why.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ignored {
    /// A coordinate of theirs is not finite.
    pub non_finite: usize,
    /// They have no area, or a radius that is not positive.
    pub degenerate: usize,
}

impl Ignored {
    /// All of them.
    pub const fn count(&self) -> usize {
        self.non_finite + self.degenerate
    }

    /// A triangle that is ignored.
    pub(super) fn of_triangle(corners: [Vec3; 3]) -> Self {
        Self::one(corners.iter().all(|corner| corner.is_finite()))
    }

    /// A sphere, or a bounding one, that is ignored.
    pub(super) fn of_sphere(sphere: &Sphere) -> Self {
        Self::one(sphere.center.is_finite() && sphere.radius.is_finite())
    }

    fn one(finite: bool) -> Self {
        Self { non_finite: usize::from(!finite), degenerate: usize::from(finite) }
    }
}

impl Add for Ignored {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            non_finite: self.non_finite + other.non_finite,
            degenerate: self.degenerate + other.degenerate,
        }
    }
}

impl AddAssign for Ignored {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

/// Counts the primitives that engines ignore: they keep their ids, but no ray hits them.
///
/// **Cost.** One pass over the primitives, in parallel, and 24 bytes for each of them until then;
/// engines do not look at all of them.
pub fn count_ignored(geometry: &Geometry) -> Ignored {
    let mut table = PrimitiveTable::new(SimdLevel::best());
    table.commit(geometry, &FrameChanges::all());
    table.count_ignored()
}
