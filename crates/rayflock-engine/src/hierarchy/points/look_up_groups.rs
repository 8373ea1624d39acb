//! Looks up which groups of a band sixteen triangles may hit.
//!
//! Strip by strip, for all triangles at once: what of the strip a triangle covers, from which cell
//! to which that is, and so from which group to which. What is found is a list of pairs, so that
//! neither it nor those who shorten it have loops within loops, whose ends no processor foresees.
//!
//! **Source.** Spans of scan conversion, as in Pineda's paper (see `points`). **Departures.** A span
//! is that of a strip of some height, and becomes a range of rays that lie anywhere.
//!
//! **Invariants.** Those of `ray_strips`; what of a strip a triangle covers holds all that its edge
//! functions keep there.
//!
//! **Cost.** Some 80 operations and three divisions a strip for sixteen triangles, two look-ups a
//! strip for each.

use std::array::from_fn;
use std::ops::Range;

use rayflock_geom::simd::face_triangle::{FaceTriangle, TrianglePlanes};
use rayflock_geom::simd::{LANES, Simd, SimdBase, SimdMask, f32x16, mask32x16, u32x16};

use super::ray_strips::{Band, FaceStrips, RayStrips};

/// Groups of a triangle that are written at once, wanted or not.
const STEP: usize = 4;

/// Sixteen triangles on a face.
pub(super) struct Sought<S: Simd> {
    pub(super) planes: TrianglePlanes<S>,
    /// Least and largest x.
    pub(super) ends: [f32x16<S>; 2],
    /// The first and the last strip.
    pub(super) strips: [u32x16<S>; 2],
    pub(super) present: mask32x16<S>,
}

impl<S: Simd> Sought<S> {
    /// One triangle.
    #[inline(always)]
    pub(super) fn one(simd: S, triangle: &FaceTriangle, [low, high]: [usize; 2]) -> Self {
        let [x0, x1] = triangle.ends();
        Self {
            planes: TrianglePlanes::of_one(simd, triangle),
            ends: [f32x16::splat(simd, x0), f32x16::splat(simd, x1)],
            strips: [u32x16::splat(simd, low as u32), u32x16::splat(simd, high as u32)],
            present: mask32x16::from_bitmask(simd, 1),
        }
    }
}

/// Pairs of one of sixteen triangles and a group of rays.
#[derive(Debug, Default)]
pub(super) struct Pairs {
    /// The group, above four bits for the triangle; as many of them as `len` tells.
    entries: Vec<u32>,
    len: usize,
}

impl Pairs {
    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// The triangle and the group of a pair.
    #[inline(always)]
    pub(super) fn get(&self, idx: usize) -> (usize, usize) {
        let entry = self.entries[idx] as usize;
        (entry % LANES, entry / LANES)
    }

    /// Keeps those that are wanted.
    #[inline(always)]
    pub(super) fn retain(&mut self, mut is_wanted: impl FnMut(usize, usize) -> bool) {
        let mut kept = 0;
        for idx in 0..self.len {
            let (lane, group_idx) = self.get(idx);
            // Without a branch, which would be mistaken half of the time.
            self.entries[kept] = self.entries[idx];
            kept += usize::from(is_wanted(lane, group_idx));
        }
        self.len = kept;
    }

    /// Finds the pairs of a band: every group with a ray that one of the triangles may hit is
    /// among that triangle's.
    #[inline(always)]
    pub(super) fn look_up<S: Simd>(
        &mut self,
        simd: S,
        strips: &RayStrips,
        (face, band): (&FaceStrips, &Band),
        sought: &Sought<S>,
    ) {
        self.len = 0;
        let splat = |value: usize| u32x16::splat(simd, value as u32);
        let [mut strip, last] = band.strips(simd, sought.strips);
        loop {
            let asked = sought.present & strip.simd_le(last);
            if !asked.any_true() {
                return;
            }
            let heights = face.heights(simd, strip);
            let [x0, x1] = sought.planes.clip(simd, sought.ends, heights);
            let asked = asked & x0.simd_le(x1);
            let [left, right] = face.box_columns(simd, [x0, x1]);
            let cell = (strip + splat(face.first_strip)) * splat(face.columns);
            let first = (cell + left).max(splat(band.first_cell));
            let end = (cell + right + splat(1)).min(splat(band.end_cell));
            let asked = asked & first.simd_lt(end);
            self.add(strips, band, (*first, *end), asked.to_bitmask());
            strip += splat(1);
        }
    }

    /// Adds the groups of some triangles from a cell up to another.
    #[inline(always)]
    fn add(
        &mut self,
        strips: &RayStrips,
        band: &Band,
        (first, end): ([u32; LANES], [u32; LANES]),
        mut lanes: u64,
    ) {
        let group_count = (band.end_place - band.first_place) / LANES;
        let room = self.len + LANES * (group_count + STEP);
        if self.entries.len() < room {
            self.entries.resize(room, 0);
        }
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let ray = |cell: u32| strips.cells[cell as usize] as usize - band.first_ray;
            let (first_ray, end_ray) = (ray(first[lane]), ray(end[lane]));
            let end_group = if first_ray == end_ray { 0 } else { end_ray.div_ceil(LANES) };
            self.push(lane, first_ray / LANES..end_group);
        }
    }

    /// Adds the groups of one triangle, for which there is room.
    #[inline(always)]
    fn push(&mut self, lane: usize, groups: Range<usize>) {
        let end = self.len + groups.len();
        let (mut place, mut entry) = (self.len, groups.start * LANES + lane);
        // Mostly one step is enough, so there is no branch to be mistaken.
        loop {
            let entries: [u32; STEP] = from_fn(|ahead| (entry + ahead * LANES) as u32);
            self.entries[place..place + STEP].copy_from_slice(&entries);
            (place, entry) = (place + STEP, entry + STEP * LANES);
            if place >= end {
                break;
            }
        }
        self.len = end;
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        4 * self.entries.capacity()
    }
}
