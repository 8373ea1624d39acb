//! Settings of the engine.

use rayflock_geom::simd::SimdLevel;

/// Settings of [`BvhEngine`](super::BvhEngine).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Config {
    /// Instruction set; the widest of the machine by default.
    pub simd: SimdLevel,
}
