//! Sends the rays of a block through the trees: groups of rays that go similar ways, then single
//! rays, face by face of the cube that they leave through.

use rayflock_geom::RayBatch;
use rayflock_geom::simd::Simd;
use rayflock_geom::simd::aligned_rays::FACES;
use rayflock_geom::simd::ray_boxes::BoxBounds;

use super::ray_block::RayBlock;
use super::trace_groups::RayGroups;
use super::trace_rays::SingleRays;
use super::tree::Tree;
use super::walk_tree::TreeWalk;
use crate::TraceStats;
use crate::packet::{Nearest, Question, TracePacket};
use crate::primitives::PrimitiveTable;

/// What one block of rays asks.
pub(super) struct BlockQuestion<'a> {
    pub(super) table: &'a PrimitiveTable,
    pub(super) batch: &'a RayBatch<'a>,
    /// In the order in which they are traced.
    pub(super) trees: [&'a Tree; 2],
    /// The box around everything in the trees.
    pub(super) bounds: BoxBounds,
    /// Groups may be this wide in the middle of their way.
    pub(super) group_width: f32,
    pub(super) question: Question,
}

/// What a task works with.
#[derive(Debug)]
pub(super) struct BlockTracer {
    pub(super) rays: RayBlock,
    walk: TreeWalk,
    /// Holds rays for primitives that are not triangles.
    packet: TracePacket,
}

impl Default for BlockTracer {
    fn default() -> Self {
        Self { rays: RayBlock::default(), walk: TreeWalk::default(), packet: TracePacket::EMPTY }
    }
}

impl BlockTracer {
    /// Finds the nearest hits of the block's rays, one for each entry of `nearest`.
    #[inline(always)]
    pub(super) fn trace<S: Simd>(
        &mut self,
        simd: S,
        asked: &BlockQuestion<'_>,
        nearest: &mut [Nearest],
        stats: &mut TraceStats,
    ) {
        let Self { rays: RayBlock { first_ray, rays, faces, groups, group_faces }, walk, packet } =
            self;
        let first_ray = *first_ray;
        for face in 0..FACES {
            let mut travellers = RayGroups { asked, first_ray, groups, packet };
            for tree in asked.trees {
                walk.walk(simd, tree, face, &group_faces[face], &mut travellers, stats);
            }
            let mut travellers = SingleRays { asked, first_ray, rays, nearest, packet };
            for tree in asked.trees {
                walk.walk(simd, tree, face, &faces[face], &mut travellers, stats);
            }
        }
        for group in groups {
            group.write_hits(simd, &mut nearest[group.first as usize..]);
        }
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.rays.memory_usage() + self.walk.memory_usage()
    }
}
