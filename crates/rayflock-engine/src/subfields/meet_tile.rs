//! One ray against the primitives of a tile.

use glam::Vec3;
use rayflock_geom::simd::ray_triangle::{AlignedBlock, intersect_aligned};
use rayflock_geom::simd::{LANES, Simd, SimdBase, SimdMask, mask32x16, u32x16};

use super::asked::Asked;
use super::tile_grid::TileBlock;
use crate::TraceStats;
use crate::packet::{Nearest, Question};
use crate::primitives::TRIANGLE_BYTES;
use crate::triangle_leaf::TriangleLeaf;

/// One ray at work.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileRay {
    /// The axes kx, ky, kz of the accepting test.
    pub(super) axes: [usize; 3],
    /// In the order of the axes.
    pub(super) origin: Vec3,
    /// sx, sy and `d[kz]`.
    pub(super) shear: [f32; 3],
    pub(super) t_min: f32,
    /// The nearest hit so far; minus infinity when the ray looks nowhere any more.
    pub(super) t_max: f32,
    /// Which objects the ray sees.
    pub(super) mask: u32,
    pub(super) nearest: Nearest,
}

impl TileRay {
    /// Whether the ray looks nowhere any more.
    #[inline(always)]
    pub(super) fn is_done(&self) -> bool {
        self.t_max == f32::NEG_INFINITY
    }
}

/// How deep a ray is in a tile.
#[derive(Clone, Copy, Debug)]
pub(super) struct DepthRange {
    /// The least and the largest nearness of what the ray may hit.
    pub(super) least: f32,
    pub(super) most: f32,
    /// The ray's depth at `t = 0` and for each unit of `t`.
    pub(super) start: f32,
    pub(super) pace: f32,
    /// By how much a depth may be off.
    pub(super) slack: f32,
}

impl DepthRange {
    /// Leaves out what lies behind a hit.
    #[inline(always)]
    fn shorten(&mut self, t: f32) {
        let nearness = -(self.start + self.pace * t);
        if self.pace >= 0.0 {
            self.least = self.least.max(nearness - self.slack);
        } else {
            self.most = self.most.min(nearness + self.slack);
        }
    }
}

/// What comes of rays that meet tiles.
pub(super) struct Meeting<'a> {
    pub(super) asked: &'a Asked<'a>,
    /// Slots of other primitives in the tiles that were visited.
    pub(super) others: &'a mut Vec<u32>,
    pub(super) stats: &'a mut TraceStats,
}

impl Meeting<'_> {
    /// A ray against what lies in a tile.
    #[inline(always)]
    pub(super) fn meet_tile<S: Simd>(
        &mut self,
        simd: S,
        block: &TileBlock,
        tile_idx: usize,
        mut depths: DepthRange,
        ray: &mut TileRay,
    ) {
        self.stats.tiles += 1;
        for leaf_idx in block.leaves_of(tile_idx) {
            let [nearest, farthest] = block.depths[leaf_idx];
            if nearest < depths.least {
                break;
            }
            if farthest > depths.most {
                continue;
            }
            if self.meet_leaf(simd, &block.leaves[leaf_idx], ray) {
                if ray.is_done() {
                    return;
                }
                depths.shorten(ray.t_max);
            }
        }
        self.others.extend_from_slice(block.others_of(tile_idx));
    }

    /// A ray against sixteen triangles. Returns whether there was a hit.
    #[inline(always)]
    fn meet_leaf<S: Simd>(&mut self, simd: S, leaf: &TriangleLeaf, ray: &mut TileRay) -> bool {
        self.stats.triangle_tests += LANES as u64;
        self.stats.bytes += LANES as u64 * TRIANGLE_BYTES;
        let triangles = match self.asked.place {
            None => AlignedBlock::load(simd, &leaf.triangles, ray.axes),
            Some(place) => {
                let in_world = place.triangles_in_world(simd, &leaf.triangles);
                AlignedBlock::load(simd, &in_world, ray.axes)
            }
        };
        let seen = u32x16::from_slice(simd, &leaf.masks) & u32x16::splat(simd, ray.mask);
        let active: mask32x16<S> = !seen.simd_eq(u32x16::splat(simd, 0));
        let interval = [ray.t_min, ray.t_max];
        let hits = intersect_aligned(simd, ray.origin, ray.shear, interval, &triangles, active);
        if !hits.accepted.any_true() {
            return false;
        }
        match self.asked.place {
            None => ray.nearest.offer_lanes(&hits, &leaf.ranks),
            Some(place) => {
                place.offer_lanes(simd, self.asked.table, hits, &leaf.ranks, &mut ray.nearest);
            }
        }
        let is_hit = !ray.nearest.is_none();
        if is_hit {
            ray.t_max = match self.asked.question {
                Question::Closest => ray.nearest.t,
                Question::Occluded => f32::NEG_INFINITY,
            };
        }
        is_hit
    }
}
