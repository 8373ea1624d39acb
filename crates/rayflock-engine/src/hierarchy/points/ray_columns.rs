//! Sixteen rays of a batch as columns.

use rayflock_geom::simd::axes::load_axes;
use rayflock_geom::simd::ray_lanes::RayLanes;
use rayflock_geom::simd::{LANES, Lanes, Simd, SimdBase, SimdMask, f32x16, mask32x16};
use rayflock_geom::{Column, ColumnElement, RayBatch};

use super::super::arrange::NO_RAY;

/// Sixteen rays, fetched from wherever they lie in the batch.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct RayColumns {
    rays: RayLanes,
    pub(super) masks: [u32; LANES],
    /// Lanes that hold a ray.
    present: u64,
}

/// Which of sixteen rays are to be traced.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayStates<S: Simd> {
    pub(super) active: mask32x16<S>,
    /// Number of rays that are not valid.
    pub(super) invalid_count: u64,
    /// Whether an active ray looks behind its origin.
    pub(super) looks_back: bool,
}

impl RayColumns {
    pub(super) const EMPTY: Self = Self { rays: RayLanes::EMPTY, masks: [0; LANES], present: 0 };

    /// Asks for the rays at these positions, so that they are in the cache when they are fetched.
    #[inline(always)]
    pub(super) fn ask_for(batch: &RayBatch<'_>, ray_idx: &[u32]) {
        for ray_idx in ray_idx.iter().map(|&ray_idx| ray_idx as usize) {
            batch.origin().ask_for(ray_idx);
            batch.direction().ask_for(ray_idx);
            batch.t_max().ask_for(ray_idx);
        }
    }

    /// Fetches the rays at these positions of the batch; places without a ray repeat another.
    #[inline(always)]
    pub(super) fn gather<S: Simd>(&mut self, simd: S, batch: &RayBatch<'_>, ray_idx: &[u32]) {
        if let Some(first_ray) = first_of_run(ray_idx) {
            self.load_run(simd, batch, first_ray as usize);
            return;
        }
        let mut positions = [NO_RAY; LANES];
        positions[..ray_idx.len()].copy_from_slice(ray_idx);
        self.present = 0;
        let substitute = ray_idx.iter().copied().find(|&idx| idx != NO_RAY);
        let Some(substitute) = substitute else { return };
        for (lane, position) in positions.iter_mut().enumerate() {
            if *position == NO_RAY {
                *position = substitute;
            } else {
                self.present |= 1 << lane;
            }
        }
        gather_axes(batch.origin(), &positions, &mut self.rays.origin);
        gather_axes(batch.direction(), &positions, &mut self.rays.direction);
        gather(batch.t_min(), &positions, &mut self.rays.t_min);
        gather(batch.t_max(), &positions, &mut self.rays.t_max);
        gather(batch.mask(), &positions, &mut self.masks);
    }

    /// Fetches sixteen consecutive rays.
    #[inline(always)]
    fn load_run<S: Simd>(&mut self, simd: S, batch: &RayBatch<'_>, first_ray: usize) {
        self.present = (1 << LANES) - 1;
        self.rays = RayLanes::load(simd, batch, first_ray);
        batch.mask().vector(simd, first_ray).store_slice(&mut self.masks);
    }

    /// Makes the rays, whose positions these are, look no farther than `t_bounds` tell.
    #[inline(always)]
    pub(super) fn bound<S: Simd>(&mut self, simd: S, ray_idx: &[u32], t_bounds: Option<&[f32]>) {
        let Some(t_bounds) = t_bounds else { return };
        let mut bounds = [f32::INFINITY; LANES];
        if let Some(first_ray) = first_of_run(ray_idx) {
            bounds.copy_from_slice(&t_bounds[first_ray as usize..first_ray as usize + LANES]);
        } else {
            for (bound, &ray_idx) in bounds.iter_mut().zip(ray_idx) {
                *bound = t_bounds.get(ray_idx as usize).copied().unwrap_or(f32::INFINITY);
            }
        }
        self.rays.bound(simd, &bounds);
    }

    /// Tells which rays are to be traced.
    #[inline(always)]
    pub(super) fn states<S: Simd>(&self, simd: S) -> RayStates<S> {
        let (active, invalid) = self.rays.states(simd);
        let active = mask32x16::from_bitmask(simd, active & self.present);
        let looks_back = self.interval(simd)[0].simd_lt(f32x16::splat(simd, 0.0));
        RayStates {
            active,
            invalid_count: u64::from((invalid & self.present).count_ones()),
            looks_back: (active & looks_back).any_true(),
        }
    }

    /// Origins in registers.
    #[inline(always)]
    pub(super) fn origin<S: Simd>(&self, simd: S) -> [f32x16<S>; 3] {
        load_axes(simd, &self.rays.origin)
    }

    /// Directions in registers.
    #[inline(always)]
    pub(super) fn direction<S: Simd>(&self, simd: S) -> [f32x16<S>; 3] {
        load_axes(simd, &self.rays.direction)
    }

    /// The smallest and the largest accepted `t` in registers.
    #[inline(always)]
    pub(super) fn interval<S: Simd>(&self, simd: S) -> [f32x16<S>; 2] {
        let RayLanes { t_min, t_max, .. } = &self.rays;
        [f32x16::from_slice(simd, t_min), f32x16::from_slice(simd, t_max)]
    }

    /// Overwrites rays that are not `active` by one that is, so that they do not stand in the way
    /// of what all have in common.
    #[inline(always)]
    pub(super) fn repeat_active(&mut self, active: u64) {
        let all = (1 << LANES) - 1;
        if active == all || active == 0 {
            return;
        }
        let source = active.trailing_zeros() as usize;
        for lane in (0..LANES).filter(|lane| active & (1 << lane) == 0) {
            for axis in 0..3 {
                for column in [&mut self.rays.origin[axis], &mut self.rays.direction[axis]] {
                    column[lane] = column[source];
                }
            }
        }
    }
}

/// The first of sixteen positions, if the others follow it one by one.
#[inline(always)]
fn first_of_run(ray_idx: &[u32]) -> Option<u32> {
    let ray_idx: &[u32; LANES] = ray_idx.try_into().ok()?;
    let first = ray_idx[0];
    let is_run = (0..LANES as u32).all(|lane| ray_idx[lane as usize] == first.wrapping_add(lane));
    (is_run && first < NO_RAY - LANES as u32).then_some(first)
}

#[inline(always)]
fn gather_axes(
    column: &Column<'_, glam::Vec3>,
    positions: &[u32; LANES],
    columns: &mut [Lanes; 3],
) {
    if let Some(value) = column.uniform() {
        for (column, coordinate) in columns.iter_mut().zip(value.to_array()) {
            *column = [coordinate; LANES];
        }
        return;
    }
    let [x, y, z] = columns;
    for lane in 0..LANES {
        [x[lane], y[lane], z[lane]] = column.get(positions[lane] as usize).to_array();
    }
}

#[inline(always)]
fn gather<T: ColumnElement>(
    column: &Column<'_, T>,
    positions: &[u32; LANES],
    lanes: &mut [T; LANES],
) {
    if let Some(value) = column.uniform() {
        *lanes = [value; LANES];
        return;
    }
    for (lane, &position) in lanes.iter_mut().zip(positions) {
        *lane = column.get(position as usize);
    }
}
