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
use crate::answer::AnswerColumns;
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
    /// How many of sixteen rays are tried as the first of a group.
    pub(super) leader_count: usize,
    pub(super) question: Question,
}

/// What a task works with.
#[derive(Debug)]
pub(super) struct BlockTracer {
    rays: RayBlock,
    /// What the rays hit so far.
    nearest: Vec<Nearest>,
    walk: TreeWalk,
    /// Holds rays for primitives that are not triangles.
    packet: TracePacket,
}

impl Default for BlockTracer {
    fn default() -> Self {
        Self {
            rays: RayBlock::default(),
            nearest: Vec::new(),
            walk: TreeWalk::default(),
            packet: TracePacket::EMPTY,
        }
    }
}

impl BlockTracer {
    /// Answers the rays of the batch from `first_ray` on.
    #[inline(always)]
    pub(super) fn answer<S: Simd>(
        &mut self,
        simd: S,
        asked: &BlockQuestion<'_>,
        first_ray: usize,
        answers: AnswerColumns<'_>,
    ) -> TraceStats {
        let rays = first_ray..first_ray + answers.len();
        let mut stats = self.rays.fill(simd, asked, rays, answers.t_bounds());
        self.nearest.clear();
        self.nearest.resize(answers.len(), Nearest::NONE);
        self.trace(simd, asked, &mut stats);
        answers.take(simd, asked.table, &self.nearest);
        stats
    }

    /// Finds the nearest hits of the block's rays.
    #[inline(always)]
    fn trace<S: Simd>(&mut self, simd: S, asked: &BlockQuestion<'_>, stats: &mut TraceStats) {
        for face in 0..FACES {
            self.trace_groups(simd, asked, face, stats);
            let Self { rays: block, nearest, walk, packet } = self;
            let RayBlock { first_ray, rays, faces, .. } = block;
            let first_ray = *first_ray;
            let mut travellers = SingleRays { asked, first_ray, rays, nearest, packet };
            for tree in asked.trees {
                walk.walk(simd, tree, face, &faces[face], &mut travellers, stats);
            }
        }
    }

    /// Finds the nearest hits of the groups that leave through one face; those of groups that are
    /// dissolved on the way are the nearest so far, and their rays join the single ones.
    #[inline(always)]
    fn trace_groups<S: Simd>(
        &mut self,
        simd: S,
        asked: &BlockQuestion<'_>,
        face: usize,
        stats: &mut TraceStats,
    ) {
        let Self { rays: block, nearest, walk, packet } = self;
        let RayBlock { first_ray, groups, group_count, group_faces, .. } = block;
        let (first_ray, groups) = (*first_ray, &mut groups[..*group_count]);
        let mut travellers = RayGroups { asked, first_ray, groups, packet };
        for tree in asked.trees {
            walk.walk(simd, tree, face, &group_faces[face], &mut travellers, stats);
        }
        let list = std::mem::take(&mut group_faces[face]);
        for &group_idx in &list {
            let group = &block.groups[group_idx as usize];
            group.write_hits(simd, &mut nearest[group.first as usize..]);
            if group.is_dissolved() {
                block.dissolve(simd, asked, group_idx);
            }
        }
        block.group_faces[face] = list;
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.rays.memory_usage()
            + self.nearest.capacity() * size_of::<Nearest>()
            + self.walk.memory_usage()
    }
}
