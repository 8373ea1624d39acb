//! Sixteen triangles in world space, as columns: what single rays meet.

use rayflock_geom::simd::LANES;
use rayflock_geom::simd::ray_triangle::TriangleBlock;

/// Sixteen triangles, with all that a test reads.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct TriangleLeaf {
    /// Corners in world space.
    pub(crate) triangles: TriangleBlock,
    /// Object masks; 0 for lanes without a triangle.
    pub(crate) masks: [u32; LANES],
    /// Ranks.
    pub(crate) ranks: [u32; LANES],
}

impl TriangleLeaf {
    /// A leaf without triangles.
    pub(crate) const EMPTY: Self =
        Self { triangles: TriangleBlock::EMPTY, masks: [0; LANES], ranks: [u32::MAX; LANES] };
}
