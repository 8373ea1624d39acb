//! Sixteen rays of a batch as columns.

use rayflock_geom::simd::axes::store_axes;
use rayflock_geom::simd::{LANES, Lanes, Select, Simd, SimdBase, SimdMask, f32x16, mask32x16};
use rayflock_geom::{Column, ColumnElement, RayBatch};

use super::super::arrange::NO_RAY;

/// Sixteen rays, fetched from wherever they lie in the batch.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct RayColumns {
    pub(super) origin: [Lanes; 3],
    pub(super) direction: [Lanes; 3],
    pub(super) t_min: Lanes,
    pub(super) t_max: Lanes,
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
    pub(super) const EMPTY: Self = Self {
        origin: [[0.0; LANES]; 3],
        direction: [[0.0; LANES]; 3],
        t_min: [0.0; LANES],
        t_max: [0.0; LANES],
        masks: [0; LANES],
        present: 0,
    };

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
        gather_axes(batch.origin(), &positions, &mut self.origin);
        gather_axes(batch.direction(), &positions, &mut self.direction);
        gather(batch.t_min(), &positions, &mut self.t_min);
        gather(batch.t_max(), &positions, &mut self.t_max);
        gather(batch.mask(), &positions, &mut self.masks);
    }

    /// Fetches sixteen consecutive rays.
    #[inline(always)]
    fn load_run<S: Simd>(&mut self, simd: S, batch: &RayBatch<'_>, first_ray: usize) {
        self.present = (1 << LANES) - 1;
        store_axes(&batch.origin().axes(simd, first_ray), &mut self.origin);
        store_axes(&batch.direction().axes(simd, first_ray), &mut self.direction);
        batch.t_min().vector(simd, first_ray).store_slice(&mut self.t_min);
        batch.t_max().vector(simd, first_ray).store_slice(&mut self.t_max);
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
        let t_max = f32x16::from_slice(simd, &self.t_max);
        let bounds = f32x16::from_slice(simd, &bounds);
        // A NaN in the interval stays.
        self.t_max = *bounds.simd_lt(t_max).select(bounds, t_max);
    }

    /// Tells which rays are to be traced, as [`Ray::state`](rayflock_geom::Ray::state) does.
    #[inline(always)]
    pub(super) fn states<S: Simd>(&self, simd: S) -> RayStates<S> {
        let load = f32x16::from_slice;
        let most = f32x16::splat(simd, f32::MAX);
        let zero = f32x16::splat(simd, 0.0);
        let mut valid = mask32x16::from_bitmask(simd, self.present);
        let mut has_direction = mask32x16::splat(simd, false);
        for axis in 0..3 {
            let direction = load(simd, &self.direction[axis]).abs();
            valid &= direction.simd_le(most);
            valid &= load(simd, &self.origin[axis]).abs().simd_le(most);
            has_direction |= direction.simd_gt(zero);
        }
        let (t_min, t_max) = (load(simd, &self.t_min), load(simd, &self.t_max));
        let valid = valid & has_direction & t_min.simd_eq(t_min) & t_max.simd_eq(t_max);
        let active = valid & t_min.simd_le(t_max);
        let valid_count = u64::from(valid.to_bitmask().count_ones());
        RayStates {
            active,
            invalid_count: u64::from(self.present.count_ones()) - valid_count,
            looks_back: (active & t_min.simd_lt(zero)).any_true(),
        }
    }

    /// Origins in registers.
    #[inline(always)]
    pub(super) fn origin<S: Simd>(&self, simd: S) -> [f32x16<S>; 3] {
        load_axes(simd, &self.origin)
    }

    /// Directions in registers.
    #[inline(always)]
    pub(super) fn direction<S: Simd>(&self, simd: S) -> [f32x16<S>; 3] {
        load_axes(simd, &self.direction)
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
                self.origin[axis][lane] = self.origin[axis][source];
                self.direction[axis][lane] = self.direction[axis][source];
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
fn load_axes<S: Simd>(simd: S, [x, y, z]: &[Lanes; 3]) -> [f32x16<S>; 3] {
    [f32x16::from_slice(simd, x), f32x16::from_slice(simd, y), f32x16::from_slice(simd, z)]
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
