//! Writes bounding spheres, for those engines that ask for them.
//!
//! Those of spheres and user primitives are written at commit. Those of triangles follow from
//! their corners, and those of blocks from their members.
//!
//! **Cost.** One pass over the groups of sixteen blocks in which anything was written since the
//! last call.

use rayflock_geom::simd::cone_sphere::SphereBlock;
use rayflock_geom::simd::ray_triangle::TriangleBlock;
use rayflock_geom::simd::sphere_blocks::around_blocks;
use rayflock_geom::simd::triangle_lanes::TriangleLanes;
use rayflock_geom::simd::{LANES, Simd, dispatch};
use rayon::prelude::*;
use tracing::debug_span;

use super::plan::Work;
use super::table::PrimitiveTable;

/// Groups of sixteen blocks that one task bounds at least.
const GROUPS_PER_TASK: usize = 4;

impl PrimitiveTable {
    /// Makes [`Self::bounds`] and [`Self::block_bounds`] those of the committed frame, and
    /// triangles as well.
    pub(crate) fn write_bounds(&mut self) {
        self.write_triangles();
        if !self.bounds_are_stale {
            return;
        }
        self.bounds_are_stale = false;
        let _span = debug_span!("write_bounds").entered();
        let (simd, corners) = (self.simd, &self.corners);
        let groups = self.bounds.par_chunks_mut(LANES).zip(&mut self.block_bounds);
        let groups = groups.zip(&mut self.stale_groups).enumerate();
        groups.with_min_len(GROUPS_PER_TASK).for_each(|(group_idx, ((bounds, around), stale))| {
            if std::mem::take(stale) {
                let first_block = (group_idx * LANES).min(corners.len());
                let triangles = &corners[first_block..];
                dispatch!(simd.level(), simd => bound_group(simd, triangles, bounds, around));
            }
        });
    }

    /// Remembers in which groups of blocks something is about to be written.
    pub(super) fn mark_stale_bounds(&mut self) {
        for (span, work) in self.layout.spans.iter().zip(&self.plan) {
            if *work == Work::Nothing {
                continue;
            }
            for slots in [span.triangle_slots(), span.sphere_slots(), span.user_slots()] {
                let groups = slots.start / (LANES * LANES)..slots.end.div_ceil(LANES * LANES);
                self.bounds_are_stale |= !slots.is_empty();
                self.stale_groups[groups].fill(true);
            }
        }
    }
}

/// Bounds the triangles of a group, then each of its blocks.
#[inline(always)]
fn bound_group<S: Simd>(
    simd: S,
    triangles: &[TriangleBlock],
    bounds: &mut [SphereBlock],
    around: &mut SphereBlock,
) {
    for (triangles, bounds) in triangles.iter().zip(bounds.iter_mut()) {
        TriangleLanes::load(simd, triangles).spheres(simd).store(bounds);
    }
    around_blocks(simd, bounds).store(around);
}
