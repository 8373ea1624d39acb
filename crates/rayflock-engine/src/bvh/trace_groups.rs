//! Groups of sixteen rays on their way through a tree: the beam around them against sixteen boxes,
//! in a leaf against the boxes of its triangles, then all of its rays against each triangle left.
//! How wide a group may be is guessed from the whole scene; where that was too wide for what lies
//! here, the group finds out by what it meets, and is dissolved.

use rayflock_geom::Ray;
use rayflock_geom::simd::aligned_rays::face_axes;
use rayflock_geom::simd::ray_beams::{BoxCorners, beam_crosses};
use rayflock_geom::simd::ray_boxes::BoxLanes;
use rayflock_geom::simd::triangle_boxes::triangle_corners;
use rayflock_geom::simd::{LANES, Simd, SimdMask};

use super::ray_group::{LeafTriangle, RayGroup};
use super::trace_block::BlockQuestion;
use super::tree::OtherLeaf;
use super::walk_tree::Travellers;
use crate::TraceStats;
use crate::packet::{Nearest, TracePacket};
use crate::primitives::TRIANGLE_BYTES;
use crate::triangle_leaf::TriangleLeaf;

/// As many triangles take as long as another primitive.
const OTHER_TESTS: u32 = 2;

/// The groups of a block.
pub(super) struct RayGroups<'a> {
    pub(super) asked: &'a BlockQuestion<'a>,
    /// Position in the batch of the block's first ray.
    pub(super) first_ray: usize,
    pub(super) groups: &'a mut [RayGroup],
    pub(super) packet: &'a mut TracePacket,
}

impl<S: Simd> Travellers<S> for RayGroups<'_> {
    type Boxes = BoxCorners<S>;

    #[inline(always)]
    fn ready(boxes: BoxLanes<S>) -> BoxCorners<S> {
        BoxCorners::of(&boxes)
    }

    #[inline(always)]
    fn crosses(&self, simd: S, traveller: u32, boxes: &BoxCorners<S>) -> u32 {
        beam_crosses(simd, &self.groups[traveller as usize].beam, boxes).to_bitmask() as u32
    }

    #[inline(always)]
    fn meet_triangles(
        &mut self,
        simd: S,
        leaf: &TriangleLeaf,
        face: usize,
        list: &[u32],
        stats: &mut TraceStats,
    ) {
        let boxes = triangle_corners(simd, &leaf.triangles, face_axes(face));
        let mut test_count = 0;
        for &idx in list {
            let group = &mut self.groups[idx as usize];
            let mut left = beam_crosses(simd, &group.beam, &boxes).to_bitmask();
            let met = left.count_ones();
            while left != 0 {
                let lane = left.trailing_zeros() as usize;
                left &= left - 1;
                let (mask, rank) = (leaf.masks[lane], leaf.ranks[lane]);
                let triangle = LeafTriangle { corners: leaf.triangles.get(lane), mask, rank };
                group.test(simd, &triangle, self.asked.question);
            }
            group.spend(met);
            test_count += met as usize;
        }
        stats.box_tests += (list.len() * LANES) as u64;
        stats.triangle_tests += (test_count * LANES) as u64;
        stats.bytes += test_count as u64 * TRIANGLE_BYTES;
    }

    #[inline(always)]
    fn meet_others(
        &mut self,
        simd: S,
        leaf: &OtherLeaf,
        boxes: &BoxCorners<S>,
        list: &[u32],
        stats: &mut TraceStats,
    ) {
        stats.box_tests += (list.len() * LANES) as u64;
        for &idx in list {
            let met = leaf.among(self.crosses(simd, idx, boxes));
            if met == 0 {
                continue;
            }
            let group = &mut self.groups[idx as usize];
            self.packet.clear();
            for lane in (0..LANES).filter(|lane| group.active & (1 << lane) != 0) {
                let ray = self.asked.batch.ray(self.first_ray + group.first as usize + lane);
                self.packet.set(lane, &Ray { t_max: group.end(lane), ..ray }, f32::INFINITY);
            }
            self.packet.test_some(simd, self.asked, leaf, met, stats);
            let mut found = [Nearest::NONE; LANES];
            for (lane, found) in found.iter_mut().enumerate() {
                *found = self.packet.nearest(lane);
            }
            group.offer(simd, &found, self.asked.question);
            group.spend(OTHER_TESTS * met.count_ones());
        }
    }
}
