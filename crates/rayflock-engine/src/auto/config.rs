//! Settings of the choosing engine.

use rayflock_geom::simd::SimdLevel;

/// Settings of [`AutoEngine`](super::AutoEngine).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Config {
    /// Instruction set of all members; the widest of the machine by default.
    pub simd: SimdLevel,
}
