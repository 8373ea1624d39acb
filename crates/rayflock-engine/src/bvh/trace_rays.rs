//! Single rays on their way through a tree: a ray against sixteen boxes, then against sixteen
//! triangles.

use rayflock_geom::Ray;
use rayflock_geom::simd::aligned_rays::face_axes;
use rayflock_geom::simd::ray_boxes::{BoxLanes, crosses};
use rayflock_geom::simd::ray_triangle::{AlignedBlock, intersect_aligned};
use rayflock_geom::simd::{LANES, Simd, SimdBase, SimdMask, mask32x16, u32x16};

use super::ray_block::StreamRay;
use super::trace_block::BlockQuestion;
use super::tree::OtherLeaf;
use super::walk_tree::Travellers;
use crate::TraceStats;
use crate::packet::{Nearest, Question, TracePacket};
use crate::primitives::{SPHERE_BYTES, TRIANGLE_BYTES};
use crate::triangle_leaf::TriangleLeaf;

/// The single rays of a block and what they hit so far.
pub(super) struct SingleRays<'a> {
    pub(super) asked: &'a BlockQuestion<'a>,
    /// Position in the batch of the first ray.
    pub(super) first_ray: usize,
    pub(super) rays: &'a mut [StreamRay],
    pub(super) nearest: &'a mut [Nearest],
    pub(super) packet: &'a mut TracePacket,
}

impl SingleRays<'_> {
    /// Makes a ray look no farther than its nearest hit, or, when any hit will do, nowhere.
    #[inline(always)]
    fn shorten(&mut self, idx: usize) {
        self.rays[idx].set_t_max(match self.asked.question {
            Question::Closest => self.nearest[idx].t,
            Question::Occluded => f32::NEG_INFINITY,
        });
    }
}

impl<S: Simd> Travellers<S> for SingleRays<'_> {
    type Boxes = BoxLanes<S>;

    #[inline(always)]
    fn ready(boxes: BoxLanes<S>) -> BoxLanes<S> {
        boxes
    }

    #[inline(always)]
    fn crosses(&self, simd: S, traveller: u32, boxes: &BoxLanes<S>) -> u32 {
        let ray = &self.rays[traveller as usize];
        crosses(simd, ray.origin, &ray.box_ray, boxes).to_bitmask() as u32
    }

    /// Each ray against sixteen triangles.
    #[inline(always)]
    fn meet_triangles(
        &mut self,
        simd: S,
        leaf: &TriangleLeaf,
        face: usize,
        list: &[u32],
        stats: &mut TraceStats,
    ) {
        let masks = u32x16::from_slice(simd, &leaf.masks);
        let triangles = AlignedBlock::load(simd, &leaf.triangles, face_axes(face));
        let mut test_count = 0;
        for &idx in list {
            let idx = idx as usize;
            let ray = &self.rays[idx];
            if ray.is_done() {
                continue;
            }
            test_count += 1;
            let seen = masks & u32x16::splat(simd, ray.mask);
            let active: mask32x16<S> = !seen.simd_eq(u32x16::splat(simd, 0));
            let interval = [ray.t_min, ray.t_max];
            let hits = intersect_aligned(simd, ray.origin, ray.shear, interval, &triangles, active);
            if hits.accepted.any_true() {
                self.nearest[idx].offer_lanes(&hits, &leaf.ranks);
                self.shorten(idx);
            }
        }
        stats.triangle_tests += (test_count * LANES) as u64;
        stats.bytes += (test_count * LANES) as u64 * TRIANGLE_BYTES;
    }

    /// Sixteen rays of a list at a time against each primitive of a leaf.
    #[inline(always)]
    fn meet_others(&mut self, simd: S, leaf: &OtherLeaf, list: &[u32], stats: &mut TraceStats) {
        let mut tests = TraceStats::default();
        for list in list.chunks(LANES) {
            self.packet.clear();
            for (lane, &idx) in list.iter().enumerate() {
                let idx = idx as usize;
                let t_max = self.rays[idx].t_max;
                if !self.rays[idx].is_done() {
                    let ray = self.asked.batch.ray(self.first_ray + idx);
                    self.packet.set(lane, &Ray { t_max, ..ray }, f32::INFINITY);
                }
            }
            self.packet.test_all(simd, self.asked, leaf, &mut tests);
            for (lane, &idx) in list.iter().enumerate() {
                let found = self.packet.nearest(lane);
                if !found.is_none() {
                    self.nearest[idx as usize].offer(found);
                    self.shorten(idx as usize);
                }
            }
        }
        tests.bytes = tests.sphere_tests / LANES as u64 * SPHERE_BYTES;
        *stats += tests;
    }
}

impl TracePacket {
    /// Tests all primitives of a leaf until no ray wants an answer any more.
    #[inline(always)]
    pub(super) fn test_all<S: Simd>(
        &mut self,
        simd: S,
        asked: &BlockQuestion<'_>,
        leaf: &OtherLeaf,
        tests: &mut TraceStats,
    ) {
        for &slot in &leaf.slots[..leaf.count] {
            if !self.is_done() {
                self.test(simd, asked.table, slot, asked.question, tests);
            }
        }
    }
}
