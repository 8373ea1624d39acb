//! Traces rays that go about along a subfield: each walks over the tiles of its face.

use rayflock_geom::RayState;
use rayflock_geom::simd::ray_triangle::{PERTURBATION, ShearedRay};
use rayflock_geom::simd::{LANES, Simd};

use super::asked::Asked;
use super::meet_tile::TileRay;
use super::nest_place::NestPlace;
use super::ray_group::RayGroup;
use super::subfield::Subfield;
use super::walk_tiles::{RayLine, walk_grid};

/// Answers rays of one subfield, given their positions in the batch.
#[inline(always)]
pub(super) fn trace_walking<S: Simd>(
    simd: S,
    asked: &Asked<'_>,
    subfield: &Subfield,
    group: &mut RayGroup,
    ray_idx: impl ExactSizeIterator<Item = usize>,
) {
    let mut ray_idx = ray_idx.peekable();
    while ray_idx.peek().is_some() {
        group.clear();
        for (lane, ray_idx) in ray_idx.by_ref().take(LANES).enumerate() {
            group.ray_idx[lane] = ray_idx;
            let line = load(asked, subfield, group, lane);
            walk(simd, asked, subfield, &line, lane, group);
        }
        group.note_others(subfield.everywhere());
        finish(simd, asked, group);
    }
}

/// Takes an active ray into the group, whose position in the batch it has already.
#[inline(always)]
pub(super) fn load(
    asked: &Asked<'_>,
    subfield: &Subfield,
    group: &mut RayGroup,
    lane: usize,
) -> RayLine {
    let ray_idx = group.ray_idx[lane];
    let ray = asked.batch.ray(ray_idx);
    debug_assert_eq!(ray.state(), RayState::Active, "others have no direction");
    let sheared = ShearedRay::new(&ray);
    let nearest = asked.found_before(ray_idx);
    group.active |= 1 << lane;
    group.rays[lane] = TileRay {
        axes: sheared.axes,
        origin: sheared.axes.map(|axis| ray.origin[axis]).into(),
        shear: sheared.shear,
        t_min: ray.t_min,
        t_max: ray.t_max.min(asked.t_bound(ray_idx)).min(nearest.t),
        mask: ray.mask,
        nearest,
    };
    subfield.line(&asked.ray_in_grids(&ray), asked.place.map_or(0.0, NestPlace::extent))
}

/// One ray over both grids.
#[inline(always)]
pub(super) fn walk<S: Simd>(
    simd: S,
    asked: &Asked<'_>,
    subfield: &Subfield,
    line: &RayLine,
    lane: usize,
    group: &mut RayGroup,
) {
    let slack = asked.table.slack().max(PERTURBATION);
    let (ray, mut meeting) = group.at_work(lane, asked);
    for grid in subfield.grids() {
        if !grid.is_empty() && !ray.is_done() {
            walk_grid(simd, grid, line, slack, ray, &mut meeting);
        }
    }
}

/// Tests what is no triangle of a tile, and writes the answers of a group.
#[inline(always)]
pub(super) fn finish<S: Simd>(simd: S, asked: &Asked<'_>, group: &mut RayGroup) {
    group.meet_others(simd, asked);
    for (lane, ray) in group.rays.iter().enumerate() {
        if group.active & (1 << lane) != 0 {
            asked.answers.set(group.ray_idx[lane], &ray.nearest);
        }
    }
}
