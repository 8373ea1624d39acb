//! Settings of the engine of parallel subfields.

use rayflock_geom::simd::SimdLevel;

use super::direction_set::DirectionLayout;

/// Settings of [`SubfieldsEngine`](super::SubfieldsEngine).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Instruction set; the widest of the machine by default.
    pub simd: SimdLevel,
    /// How directions are spread over the hemisphere.
    pub layout: DirectionLayout,
    /// How many directions there are for rays that do not share one; `None`, the default, follows
    /// from the numbers of rays and primitives. More than 4096 are taken as 4096.
    pub direction_count: Option<usize>,
    /// Bytes that all grids together may take; those not used for longest are given up first. One
    /// direction is always kept.
    pub budget: usize,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            simd: SimdLevel::default(),
            layout: DirectionLayout::default(),
            direction_count: None,
            budget: 1 << 30,
        }
    }
}
