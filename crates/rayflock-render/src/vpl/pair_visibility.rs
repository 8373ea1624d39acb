//! The question of what points see of virtual lights, asked about many pairs at once.

use std::fmt::Debug;
use std::ops::Range;

use glam::Vec3;

use super::VirtualLights;

/// Points and lights that are asked about together, each of one with each of the other.
#[derive(Clone, Debug)]
pub struct PairTile<'a> {
    /// Where ways start: points of surfaces, moved off them by more than rounding. Neighbours
    /// are close in the picture as a rule.
    pub points: &'a [Vec3],
    /// Normals of the surfaces there, of unit length, on the side that is seen; as many.
    pub normals: &'a [Vec3],
    /// All lights.
    pub lights: &'a VirtualLights,
    /// Which of them are asked about.
    pub range: Range<usize>,
}

/// Tells what points see of virtual lights: exactly, or nearly.
///
/// Work runs on the current rayon thread pool; the answer depends neither on the number of
/// threads nor on how points and lights are cut into tiles.
pub trait PairVisibility: Debug + Send {
    /// Multiplies `shares[l * points.len() + p]` by the share of light `range.start + l` that
    /// point `p` sees, in `0..=1`. Entries that are 0 are not asked about and stay 0.
    ///
    /// # Panics
    /// When `shares.len() != tile.points.len() * tile.range.len()`.
    fn multiply(&mut self, tile: &PairTile<'_>, shares: &mut [f32]) -> VisibilityStats;
}

impl PairTile<'_> {
    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.points.len() * self.range.len()
    }

    /// Whether there is no pair.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// What visibility took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VisibilityStats {
    /// Pairs that were asked about.
    pub pairs: u64,
    /// Rays that were traced for them.
    pub rays: u64,
    /// Occluder tests, in SIMD lanes; 0 where rays are traced.
    pub tests: u64,
}

impl std::ops::AddAssign for VisibilityStats {
    fn add_assign(&mut self, other: Self) {
        self.pairs += other.pairs;
        self.rays += other.rays;
        self.tests += other.tests;
    }
}
