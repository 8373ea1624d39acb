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

    /// Rays that cross the box of any primitive, sixteen at a time, against each primitive whose
    /// box any of them crosses.
    #[inline(always)]
    fn meet_others(
        &mut self,
        simd: S,
        leaf: &OtherLeaf,
        boxes: &BoxLanes<S>,
        list: &[u32],
        stats: &mut TraceStats,
    ) {
        stats.box_tests += (list.len() * LANES) as u64;
        let mut left = list.iter();
        loop {
            let (mut met, mut count, mut met_by) = (0, 0, [0; LANES]);
            while count < LANES
                && let Some(&idx) = left.next()
            {
                let crossed = leaf.among(self.crosses(simd, idx, boxes));
                if crossed != 0 {
                    (met, met_by[count]) = (met | crossed, idx as usize);
                    count += 1;
                }
            }
            if count == 0 {
                return;
            }
            self.meet_each(simd, leaf, met, &met_by[..count], stats);
        }
    }
}

impl SingleRays<'_> {
    /// Up to sixteen rays against the primitives in some lanes of a leaf.
    #[inline(always)]
    fn meet_each<S: Simd>(
        &mut self,
        simd: S,
        leaf: &OtherLeaf,
        lanes: u32,
        met_by: &[usize],
        stats: &mut TraceStats,
    ) {
        self.packet.clear();
        for (lane, &idx) in met_by.iter().enumerate() {
            let ray = self.asked.batch.ray(self.first_ray + idx);
            self.packet.set(lane, &Ray { t_max: self.rays[idx].t_max, ..ray }, f32::INFINITY);
        }
        self.packet.test_some(simd, self.asked, leaf, lanes, stats);
        for (lane, &idx) in met_by.iter().enumerate() {
            let found = self.packet.nearest(lane);
            if !found.is_none() {
                self.nearest[idx].offer(found);
                self.shorten(idx);
            }
        }
    }
}

impl TracePacket {
    /// Tests the primitives in some lanes of a leaf until no ray wants an answer any more.
    #[inline(always)]
    pub(super) fn test_some<S: Simd>(
        &mut self,
        simd: S,
        asked: &BlockQuestion<'_>,
        leaf: &OtherLeaf,
        mut lanes: u32,
        stats: &mut TraceStats,
    ) {
        let mut tests = TraceStats::default();
        while lanes != 0 && !self.is_done() {
            let slot = leaf.slots[lanes.trailing_zeros() as usize];
            lanes &= lanes - 1;
            self.test(simd, asked.table, slot, asked.question, &mut tests);
        }
        tests.bytes = tests.sphere_tests / LANES as u64 * SPHERE_BYTES;
        *stats += tests;
    }
}
