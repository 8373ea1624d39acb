//! Counts of primitives that are left out.

use std::ops::{Add, AddAssign};
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::Vec3;
use rayflock_geom::Sphere;

/// Primitives that were left out, and why.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Ignored {
    pub(super) non_finite: usize,
    pub(super) degenerate: usize,
}

/// Counts to which tasks add in any order.
#[derive(Debug, Default)]
pub(super) struct IgnoredCounter {
    non_finite: AtomicUsize,
    degenerate: AtomicUsize,
}

impl Ignored {
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

impl IgnoredCounter {
    /// Adds to the counts; most often there is nothing to add.
    pub(super) fn add(&self, ignored: Ignored) {
        if ignored != Ignored::default() {
            self.non_finite.fetch_add(ignored.non_finite, Ordering::Relaxed);
            self.degenerate.fetch_add(ignored.degenerate, Ordering::Relaxed);
        }
    }

    /// What was counted.
    pub(super) fn get(&self) -> Ignored {
        Ignored {
            non_finite: self.non_finite.load(Ordering::Relaxed),
            degenerate: self.degenerate.load(Ordering::Relaxed),
        }
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
