//! Traces rays that go exactly along a subfield: each is a point on its face.
//!
//! Sixteen rays are projected together; each then meets the leaves of the one tile that its point
//! lies in. Where the point is that close to a border that it may be beyond, the ray walks.

use std::ops::Range;

use glam::Vec3;
use rayflock_geom::simd::face::RayPoints;
use rayflock_geom::simd::face_rows::CELL_BITS;
use rayflock_geom::simd::ray_lanes::RayLanes;
use rayflock_geom::simd::ray_triangle::{PERTURBATION, ShearedRay};
use rayflock_geom::simd::{LANES, Lanes, Select, Simd, SimdBase, f32x16, u32x16};

use super::asked::Asked;
use super::meet_tile::{DepthRange, TileRay};
use super::ray_group::RayGroup;
use super::subfield::Subfield;
use super::tile_grid::{Cell, TileGrid};
use super::walk_tiles::{RayLine, walk_grid};
use crate::packet::Nearest;

/// Sixteen rays on the face of a subfield.
struct Places {
    /// For each grid, the least and the largest cell that a ray may be in.
    cells: [[[Cell; LANES]; 2]; 2],
    x: Lanes,
    y: Lanes,
    start: Lanes,
    pace: Lanes,
    /// The least and the largest nearness of what a ray may hit.
    limit: Lanes,
    begin: Lanes,
}

/// Answers consecutive rays, given their positions in the batch.
#[inline(always)]
pub(super) fn trace_aligned<S: Simd>(
    simd: S,
    asked: &Asked<'_>,
    subfield: &Subfield,
    group: &mut RayGroup,
    rays: Range<usize>,
) {
    group.stats.rays += rays.len() as u64;
    let sheared = ShearedRay::new(&asked.batch.ray(rays.start));
    for first_ray in rays.clone().step_by(LANES) {
        let count = (rays.end - first_ray).min(LANES);
        let places = load(simd, asked, subfield, group, first_ray, count, &sheared);
        let mut active = group.active;
        while active != 0 {
            let lane = active.trailing_zeros() as usize;
            active &= active - 1;
            for (grid_idx, grid) in subfield.grids().into_iter().enumerate() {
                if !grid.is_empty() {
                    meet_grid(simd, asked, grid, grid_idx, &places, lane, group);
                }
            }
        }
        group.note_others(subfield.everywhere());
        group.meet_others(simd, asked);
        for (ray_idx, ray) in group.ray_idx.iter().zip(&group.rays).take(count) {
            asked.answers.set(*ray_idx, &ray.nearest);
        }
    }
}

/// Takes sixteen rays into the group.
#[inline(always)]
fn load<S: Simd>(
    simd: S,
    asked: &Asked<'_>,
    subfield: &Subfield,
    group: &mut RayGroup,
    first_ray: usize,
    count: usize,
    sheared: &ShearedRay,
) -> Places {
    let batch = asked.batch;
    let mut lanes = RayLanes::load(simd, batch, first_ray);
    let masks = *batch.mask().vector(simd, first_ray);
    let (active, invalid) = lanes.states(simd);
    let there = (1 << count) - 1;
    group.clear();
    group.active = active & there;
    group.stats.invalid_rays += u64::from((invalid & there).count_ones());
    let [kx, ky, kz] = sheared.axes;
    let places = group.ray_idx.iter_mut().zip(&mut group.rays).take(count);
    for (lane, (ray_idx, ray)) in places.enumerate() {
        *ray_idx = first_ray + lane;
        lanes.t_max[lane] = lanes.t_max[lane].min(asked.t_bound(*ray_idx));
        let origin = [lanes.origin[kx][lane], lanes.origin[ky][lane], lanes.origin[kz][lane]];
        *ray = TileRay {
            axes: sheared.axes,
            origin: origin.into(),
            shear: sheared.shear,
            t_min: lanes.t_min[lane],
            t_max: lanes.t_max[lane],
            mask: masks[lane],
            nearest: Nearest::NONE,
        };
    }
    place(simd, asked, subfield, &lanes)
}

/// Finds the places of sixteen rays.
#[inline(always)]
fn place<S: Simd>(simd: S, asked: &Asked<'_>, subfield: &Subfield, lanes: &RayLanes) -> Places {
    let load = f32x16::from_slice;
    let [x, y, z] = &lanes.origin;
    let origin = [load(simd, x), load(simd, y), load(simd, z)];
    let [x, y, z] = &lanes.direction;
    let direction = [load(simd, x), load(simd, y), load(simd, z)];
    let face = &subfield.face;
    let points = face.project_rays(simd, origin, direction);
    let slack = asked.table.slack().max(PERTURBATION);
    let [first, second] = subfield.grids();
    Places {
        cells: [cells(simd, first, &points, slack), cells(simd, second, &points, slack)],
        x: *points.x,
        y: *points.y,
        start: *points.start,
        pace: *points.pace,
        limit: *face.limit(simd, &points, load(simd, &lanes.t_max)),
        begin: *face.begin(simd, &points, load(simd, &lanes.t_min)),
    }
}

/// The least and the largest cell of the places at which rays may pierce the face.
#[inline(always)]
fn cells<S: Simd>(
    simd: S,
    grid: &TileGrid,
    points: &RayPoints<S>,
    slack: f32,
) -> [[Cell; LANES]; 2] {
    let extent = points.x.abs() + points.y.abs() + points.start.abs();
    let margin = extent * f32x16::splat(simd, 4.0 * slack);
    let (x0, x1) = (points.x - margin, points.x + margin);
    let (y0, y1) = (points.y - margin, points.y + margin);
    let window = &grid.window;
    let low = window.cells(simd, x0, 0) | (window.cells(simd, y0, 1) << CELL_BITS);
    let high = window.cells(simd, x1, 0) | (window.cells(simd, y1, 1) << CELL_BITS);
    // Rays without a place have all.
    let (zero, all) = (u32x16::splat(simd, 0), u32x16::splat(simd, u32::MAX));
    [*points.on_face.select(low, zero), *points.on_face.select(high, all)]
}

/// One ray against the tiles of a grid.
#[inline(always)]
fn meet_grid<S: Simd>(
    simd: S,
    asked: &Asked<'_>,
    grid: &TileGrid,
    grid_idx: usize,
    places: &Places,
    lane: usize,
    group: &mut RayGroup,
) {
    let (start, pace) = (places.start[lane], places.pace[lane]);
    let (ray, mut meeting) = group.at_work(lane, asked);
    if ray.is_done() {
        return;
    }
    let cells = &places.cells[grid_idx];
    let (low, high) = (cells[0][lane], cells[1][lane]);
    let block_idx = grid.block_idx(low);
    if block_idx == grid.block_idx(high) {
        let Some(block) = grid.valid_block(block_idx) else { return };
        let tile_idx = grid.tile_idx(low, block.level);
        if tile_idx == grid.tile_idx(high, block.level) {
            let (least, most) = (places.limit[lane], places.begin[lane]);
            let extent = places.x[lane].abs() + places.y[lane].abs() + start.abs() + grid.reach;
            let slack = grid.depth_error + 4.0 * PERTURBATION * extent;
            let depths = DepthRange { least, most, start, pace, slack };
            meeting.meet_tile(simd, block, tile_idx, depths, ray);
            return;
        }
    }
    let line = RayLine::along(Vec3::new(places.x[lane], places.y[lane], start), pace);
    let slack = asked.table.slack().max(PERTURBATION);
    walk_grid(simd, grid, &line, slack, ray, &mut meeting);
}
