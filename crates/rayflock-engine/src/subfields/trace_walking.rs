//! Traces rays that go about along a subfield: each walks over the tiles of its face.

use rayflock_geom::RayState;
use rayflock_geom::simd::ray_triangle::{PERTURBATION, ShearedRay};
use rayflock_geom::simd::{LANES, Simd};

use super::meet_tile::TileRay;
use super::ray_group::{Asked, RayGroup};
use super::subfield::Subfield;
use super::walk_tiles::{RayLine, walk_grid};
use crate::answers::Answers;
use crate::packet::Nearest;

/// Answers rays of one subfield, given their positions in the batch.
#[inline(always)]
pub(super) fn trace_walking<S: Simd>(
    simd: S,
    asked: &Asked<'_>,
    subfield: &Subfield,
    group: &mut RayGroup,
    ray_idx: impl ExactSizeIterator<Item = usize>,
    t_bound: &impl Fn(usize) -> f32,
    answers: &Answers,
) {
    let mut ray_idx = ray_idx.peekable();
    while ray_idx.peek().is_some() {
        group.clear();
        for (lane, ray_idx) in ray_idx.by_ref().take(LANES).enumerate() {
            group.ray_idx[lane] = ray_idx;
            if let Some(line) = load(asked, subfield, group, lane, t_bound) {
                walk(simd, asked, subfield, &line, lane, group);
            }
        }
        group.meet_others(simd, asked, subfield.everywhere());
        for (lane, ray) in group.rays.iter().enumerate() {
            if group.active & (1 << lane) != 0 {
                answers.set(group.ray_idx[lane], &ray.nearest);
            }
        }
    }
}

/// Takes an active ray into the group.
#[inline(always)]
fn load(
    asked: &Asked<'_>,
    subfield: &Subfield,
    group: &mut RayGroup,
    lane: usize,
    t_bound: &impl Fn(usize) -> f32,
) -> Option<RayLine> {
    let ray_idx = group.ray_idx[lane];
    let ray = asked.batch.ray(ray_idx);
    debug_assert_eq!(ray.state(), RayState::Active, "others have no direction");
    let sheared = ShearedRay::new(&ray);
    group.active |= 1 << lane;
    group.rays[lane] = TileRay {
        axes: sheared.axes,
        origin: sheared.axes.map(|axis| ray.origin[axis]).into(),
        shear: sheared.shear,
        t_min: ray.t_min,
        t_max: ray.t_max.min(t_bound(ray_idx)),
        mask: ray.mask,
        nearest: Nearest::NONE,
    };
    Some(subfield.line(&ray))
}

/// One ray over both grids.
#[inline(always)]
fn walk<S: Simd>(
    simd: S,
    asked: &Asked<'_>,
    subfield: &Subfield,
    line: &RayLine,
    lane: usize,
    group: &mut RayGroup,
) {
    let slack = asked.table.slack().max(PERTURBATION);
    let (ray, mut meeting) = group.at_work(lane, asked.question);
    for grid in subfield.grids() {
        if !grid.is_empty() && !ray.is_done() {
            walk_grid(simd, grid, line, slack, ray, &mut meeting);
        }
    }
}
