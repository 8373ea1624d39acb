//! Settings of the hierarchical ray engine.

use rayflock_geom::simd::SimdLevel;

/// Settings of [`HierarchyEngine`](super::HierarchyEngine).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Config {
    /// Instruction set; the widest of the machine by default.
    pub simd: SimdLevel,
}
