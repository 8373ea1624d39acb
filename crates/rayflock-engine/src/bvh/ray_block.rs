//! The rays that one task traces through the trees together.

use std::ops::Range;

use glam::Vec3;
use rayflock_geom::simd::aligned_rays::{AlignedRays, FACES};
use rayflock_geom::simd::neighbours::{Neighbours, Slopes};
use rayflock_geom::simd::ray_beams::RayBeam;
use rayflock_geom::simd::ray_boxes::BoxRay;
use rayflock_geom::simd::ray_lanes::RayLanes;
use rayflock_geom::simd::{LANES, Simd};

use super::ray_group::RayGroup;
use super::trace_block::BlockQuestion;
use crate::TraceStats;

/// All that boxes and triangles need to know about a ray: one line of the cache, for rays are read
/// far more often than anything else here.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct StreamRay {
    /// In the order kx, ky, kz.
    pub(super) origin: Vec3,
    /// In the same order.
    pub(super) box_ray: BoxRay,
    /// sx, sy and `d[kz]` of the accepting test.
    pub(super) shear: [f32; 3],
    pub(super) t_min: f32,
    /// The nearest hit so far; minus infinity when the ray looks nowhere any more.
    pub(super) t_max: f32,
    /// Which objects the ray sees.
    pub(super) mask: u32,
}

impl StreamRay {
    /// A ray that hits nothing.
    const EMPTY: Self = Self {
        origin: Vec3::ZERO,
        box_ray: BoxRay::EMPTY,
        shear: [0.0, 0.0, 1.0],
        t_min: f32::INFINITY,
        t_max: f32::NEG_INFINITY,
        mask: 0,
    };

    /// Makes the ray look no farther than `t`.
    #[inline(always)]
    pub(super) fn set_t_max(&mut self, t: f32) {
        self.t_max = t;
        // The largest coordinate of the direction is that along kz.
        self.box_ray.set_t_max(t, self.shear[2].abs());
    }

    /// Whether the ray looks nowhere any more.
    #[inline(always)]
    pub(super) fn is_done(&self) -> bool {
        self.t_max == f32::NEG_INFINITY
    }
}

/// Rays in the smallest group: fewer are not worth the tests that their company costs.
const FEWEST: u32 = 8;

/// Rays in the order of their batch.
#[derive(Debug, Default)]
pub(super) struct RayBlock {
    /// Position in the batch of the first ray.
    pub(super) first_ray: usize,
    pub(super) rays: Vec<StreamRay>,
    /// The active single rays by the face of their direction, as positions in the block.
    pub(super) faces: [Vec<u32>; FACES],
    /// Rays that travel together; `rays` has nothing of them. Those from `group_count` on are of
    /// an earlier block.
    pub(super) groups: Vec<RayGroup>,
    pub(super) group_count: usize,
    /// The groups by the face of their directions.
    pub(super) group_faces: [Vec<u32>; FACES],
}

impl RayBlock {
    /// Takes in some rays of the batch; `t_bounds`, if any, tell for each beyond
    /// which hits are of no interest.
    #[inline(always)]
    pub(super) fn fill<S: Simd>(
        &mut self,
        simd: S,
        asked: &BlockQuestion<'_>,
        rays: Range<usize>,
        t_bounds: Option<&[f32]>,
    ) -> TraceStats {
        let mut stats = TraceStats { rays: rays.len() as u64, ..TraceStats::default() };
        self.first_ray = rays.start;
        self.group_count = 0;
        self.faces.iter_mut().chain(&mut self.group_faces).for_each(Vec::clear);
        self.rays.resize(rays.len(), StreamRay::EMPTY);
        for first_ray in rays.clone().step_by(LANES) {
            let count = (rays.end - first_ray).min(LANES);
            let t_bounds = t_bounds.map(|bounds| &bounds[first_ray - rays.start..]);
            stats.invalid_rays += self.fill_lanes(simd, asked, first_ray, count, t_bounds);
        }
        stats
    }

    /// Takes in sixteen rays; returns how many are invalid.
    #[inline(always)]
    fn fill_lanes<S: Simd>(
        &mut self,
        simd: S,
        asked: &BlockQuestion<'_>,
        first_ray: usize,
        count: usize,
        t_bounds: Option<&[f32]>,
    ) -> u64 {
        let batch = asked.batch;
        let mut lanes = RayLanes::load(simd, batch, first_ray);
        let (active, invalid) = lanes.states(simd);
        if let Some(t_bounds) = t_bounds {
            lanes.bound(simd, t_bounds);
        }
        let there = (1 << count) - 1;
        let invalid_count = u64::from((invalid & there).count_ones());
        if active & there == 0 {
            return invalid_count;
        }
        let masks = *batch.mask().vector(simd, first_ray);
        let first = first_ray - self.first_ray;
        let single = self.push_groups(simd, asked, first, active & there, (&lanes, masks));
        if single != 0 {
            self.push_single(simd, asked, first, single, (&lanes, masks));
        }
        invalid_count
    }

    /// Takes in those of sixteen rays that go alone, unless they cross nothing.
    #[inline(always)]
    fn push_single<S: Simd>(
        &mut self,
        simd: S,
        asked: &BlockQuestion<'_>,
        first: usize,
        single: u64,
        (lanes, masks): (&RayLanes, [u32; LANES]),
    ) {
        let (prepared, crossing) =
            AlignedRays::prepare(simd, lanes, &asked.bounds, asked.table.slack());
        let mut single = single & crossing;
        while single != 0 {
            let lane = single.trailing_zeros() as usize;
            single &= single - 1;
            self.rays[first + lane] = StreamRay {
                origin: prepared.origin(lane),
                box_ray: prepared.box_ray(lane),
                shear: prepared.shear(lane),
                t_min: lanes.t_min[lane],
                t_max: lanes.t_max[lane],
                mask: masks[lane],
            };
            self.faces[prepared.face(lane)].push((first + lane) as u32);
        }
    }

    /// Has the rays of a group that is dissolved go on alone, no farther than what they hit so far.
    #[inline(always)]
    pub(super) fn dissolve<S: Simd>(&mut self, simd: S, asked: &BlockQuestion<'_>, group_idx: u32) {
        let group = &self.groups[group_idx as usize];
        let (first, active) = (group.first as usize, group.active);
        let mut lanes = RayLanes::load(simd, asked.batch, self.first_ray + first);
        for (lane, t_max) in lanes.t_max.iter_mut().enumerate() {
            *t_max = t_max.min(group.end(lane));
        }
        let masks = *asked.batch.mask().vector(simd, self.first_ray + first);
        self.push_single(simd, asked, first, active, (&lanes, masks));
    }

    /// Makes groups of the `active` rays that go similar ways. Returns those that go alone.
    #[inline(always)]
    fn push_groups<S: Simd>(
        &mut self,
        simd: S,
        asked: &BlockQuestion<'_>,
        first: usize,
        active: u64,
        (lanes, masks): (&RayLanes, [u32; LANES]),
    ) -> u64 {
        let neighbours = Neighbours::of(simd, lanes);
        let (mut left, mut single) = (active, 0);
        for _ in 0..asked.leader_count {
            if left == 0 {
                break;
            }
            let (alike, found) = find_alike(simd, asked, &neighbours, left);
            left &= !alike;
            let Some((slopes, beam)) = found else {
                single |= alike;
                continue;
            };
            self.group_faces[slopes.face()].push(self.group_count as u32);
            if self.groups.len() == self.group_count {
                self.groups.push(RayGroup::EMPTY);
            }
            let group = &mut self.groups[self.group_count];
            group.fill(beam, [first as u32, alike as u32], (lanes, &slopes), masks);
            self.group_count += 1;
        }
        single | left
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        let lists = self.faces.iter().chain(&self.group_faces);
        self.rays.capacity() * size_of::<StreamRay>()
            + self.groups.capacity() * size_of::<RayGroup>()
            + lists.map(Vec::capacity).sum::<usize>() * size_of::<u32>()
    }
}

/// Those of some lanes, at least one, whose rays go like the first of them, itself included; also
/// their slopes and the beam around them, where they are worth a group and make one.
#[inline(always)]
fn find_alike<S: Simd>(
    simd: S,
    asked: &BlockQuestion<'_>,
    neighbours: &Neighbours<S>,
    lanes: u64,
) -> (u64, Option<(Slopes<S>, RayBeam)>) {
    let first = lanes & lanes.wrapping_neg();
    let (width, distance) = (asked.group_width, asked.bounds.half_size.max_element());
    let alike = neighbours.alike(simd, lanes, width) | first;
    if alike.count_ones() < FEWEST {
        return (alike, None);
    }
    let slopes = neighbours.slopes(simd, neighbours.face(first.trailing_zeros() as usize));
    let alike = slopes.close(simd, alike, width, distance) | first;
    if alike.count_ones() < FEWEST {
        return (alike, None);
    }
    let beam = neighbours.beam(simd, &slopes, alike, &asked.bounds, asked.table.slack());
    (alike, beam.map(|beam| (slopes, beam)))
}
