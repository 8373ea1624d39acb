//! Sorts rays by their place on the faces, along a Hilbert curve.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayflock_geom::RayBatch;
use rayflock_geom::simd::face::{Face, pierce_cube};
use rayflock_geom::simd::{
    LANES, Select, Simd, SimdBase, SimdCvtTruncate, SimdLevel, SimdMask, dispatch, f32x16,
    mask32x16, u32x16,
};
use rayon::prelude::*;
use tracing::debug_span;

use super::super::arrange::NO_RAY;
use super::ray_columns::{RayColumns, RayStates};
use crate::sort_keyed::KeyedSorter;

/// Rays that one task gives keys.
const RAYS_PER_TASK: usize = 4096;

/// Bits of the curve at most; a face number stands above them.
const MOST_CURVE_BITS: u32 = 28;

/// Rays in the order of their places on the faces.
#[derive(Debug, Default)]
pub(super) struct PointSorter {
    sorter: KeyedSorter,
    /// Positions in the batch; each face's rays fill whole tiles, with [`NO_RAY`] at the end.
    pub(super) ray_idx: Vec<u32>,
    /// For each tile, its face.
    pub(super) tile_faces: Vec<u32>,
    /// Entries of rays on faces; those behind have no place, or are not to be traced.
    placed: usize,
}

/// The part of a face that is divided into cells.
#[derive(Clone, Copy, Debug)]
struct Window {
    low: [f32; 2],
    scale: [f32; 2],
    /// Bits of the place along the curve.
    curve_bits: u32,
}

impl PointSorter {
    /// Sorts the rays of the batch into tiles. Returns the number of rays that are not valid, and
    /// whether some active ray has no place or looks behind its origin.
    pub(super) fn sort(
        &mut self,
        level: SimdLevel,
        batch: &RayBatch<'_>,
        faces: &[Face],
        tile_len: usize,
    ) -> (u64, bool) {
        let _span = debug_span!("sort_points").entered();
        let window = dispatch!(level.level(), simd => window(simd, batch, faces));
        let tasks = self.sorter.entries(batch.len()).par_chunks_mut(RAYS_PER_TASK).enumerate();
        let (invalid_count, is_lost) = tasks
            .map(|(task_idx, keyed)| {
                let first_ray = task_idx * RAYS_PER_TASK;
                dispatch!(level.level(), simd => {
                    write_keys(simd, batch, faces, &window, first_ray, keyed)
                })
            })
            .reduce(|| (0, false), |a, b| (a.0 + b.0, a.1 | b.1));
        if !is_lost {
            // The number behind the last face is that of rays that are not traced.
            let face_bits = usize::BITS - faces.len().leading_zeros();
            self.sorter.sort(window.curve_bits + face_bits);
            self.fill_tiles(faces.len(), window.curve_bits, tile_len);
        }
        (invalid_count, is_lost)
    }

    fn fill_tiles(&mut self, face_count: usize, curve_bits: u32, tile_len: usize) {
        let sorted = self.sorter.sorted();
        self.ray_idx.clear();
        self.tile_faces.clear();
        self.placed = 0;
        for face_idx in 0..face_count as u32 {
            let face_of = |entry: &AtomicU64| (entry.load(Relaxed) >> (32 + curve_bits)) as u32;
            let rest = &sorted[self.placed..];
            let rest = &rest[..rest.partition_point(|entry| face_of(entry) <= face_idx)];
            let first = self.ray_idx.len();
            self.ray_idx.resize(first + rest.len().next_multiple_of(tile_len), NO_RAY);
            self.tile_faces.resize(self.ray_idx.len() / tile_len, face_idx);
            let tasks = self.ray_idx[first..].par_chunks_mut(RAYS_PER_TASK);
            tasks.zip(rest.par_chunks(RAYS_PER_TASK)).for_each(|(ray_idx, entries)| {
                for (ray_idx, entry) in ray_idx.iter_mut().zip(entries) {
                    *ray_idx = entry.load(Relaxed) as u32;
                }
            });
            self.placed += rest.len();
        }
    }

    /// Rays of the batch that are in no tile.
    pub(super) fn left_out(&self) -> impl Iterator<Item = u32> + '_ {
        self.sorter.sorted()[self.placed..].iter().map(|entry| entry.load(Relaxed) as u32)
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.sorter.memory_usage() + 4 * (self.ray_idx.capacity() + self.tile_faces.capacity())
    }
}

/// The window around a sample of the rays of a single face; the square of a cube's side.
#[inline(always)]
fn window<S: Simd>(simd: S, batch: &RayBatch<'_>, faces: &[Face]) -> Window {
    let mut low = [-1.0; 2];
    let mut high = [1.0; 2];
    if let [face] = faces {
        (low, high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        let mut columns = RayColumns::EMPTY;
        let step = (batch.len() / 64).max(LANES);
        for start in (0..batch.len()).step_by(step) {
            let positions = positions(start, batch.len());
            columns.gather(simd, batch, &positions);
            let points = face.project_rays(simd, columns.origin(simd), columns.direction(simd));
            let active = (columns.states(simd).active & points.on_face).to_bitmask();
            for lane in (0..LANES).filter(|lane| active & (1 << lane) != 0) {
                for (axis, value) in [points.x[lane], points.y[lane]].into_iter().enumerate() {
                    low[axis] = low[axis].min(value);
                    high[axis] = high[axis].max(value);
                }
            }
        }
    }
    // One to four cells a ray.
    let axis_bits = (usize::BITS - batch.len().leading_zeros()).div_ceil(2);
    let curve_bits = (2 * axis_bits).min(MOST_CURVE_BITS);
    let cells = (1 << (curve_bits / 2)) as f32;
    let scale = [0, 1].map(|axis| {
        let scale = cells / (high[axis] - low[axis]);
        if scale.is_finite() && scale > 0.0 { scale } else { 0.0 }
    });
    let low = low.map(|low| if low.is_finite() { low } else { 0.0 });
    Window { low, scale, curve_bits }
}

/// Sixteen consecutive positions, as many as there are.
fn positions(start: usize, len: usize) -> [u32; LANES] {
    std::array::from_fn(|lane| if start + lane < len { (start + lane) as u32 } else { NO_RAY })
}

#[inline(always)]
fn write_keys<S: Simd>(
    simd: S,
    batch: &RayBatch<'_>,
    faces: &[Face],
    window: &Window,
    first_ray: usize,
    keyed: &mut [AtomicU64],
) -> (u64, bool) {
    let mut columns = RayColumns::EMPTY;
    let (mut invalid_count, mut is_lost) = (0, false);
    for (idx, keyed) in keyed.chunks_mut(LANES).enumerate() {
        let start = first_ray + idx * LANES;
        columns.gather(simd, batch, &positions(start, start + keyed.len()));
        let states = columns.states(simd);
        invalid_count += states.invalid_count;
        let (here, face_idx, [x, y]) = points(simd, faces, &columns, &states);
        is_lost |= (states.active & !here).any_true() | states.looks_back;
        let nowhere = u32x16::splat(simd, (faces.len() as u32) << window.curve_bits);
        let keys = (face_idx << window.curve_bits) | curve(simd, window, x, y);
        let keys = here.select(keys, nowhere);
        for (lane, keyed) in keyed.iter_mut().enumerate() {
            *keyed.get_mut() = (u64::from(keys[lane]) << 32) | (start + lane) as u64;
        }
    }
    (invalid_count, is_lost)
}

/// Active rays that have a place, on which face, and where.
#[inline(always)]
fn points<S: Simd>(
    simd: S,
    faces: &[Face],
    columns: &RayColumns,
    states: &RayStates<S>,
) -> (mask32x16<S>, u32x16<S>, [f32x16<S>; 2]) {
    let direction = columns.direction(simd);
    if let [face] = faces {
        let points = face.project_rays(simd, columns.origin(simd), direction);
        return (states.active & points.on_face, u32x16::splat(simd, 0), [points.x, points.y]);
    }
    let (side, point) = pierce_cube(simd, direction);
    (states.active, side, point)
}

/// Places of points along the curve, outside the window at its border.
#[inline(always)]
fn curve<S: Simd>(simd: S, window: &Window, x: f32x16<S>, y: f32x16<S>) -> u32x16<S> {
    let axis_bits = window.curve_bits / 2;
    let most = f32x16::splat(simd, ((1 << axis_bits) - 1) as f32);
    let zero = f32x16::splat(simd, 0.0);
    let x = ((x - window.low[0]) * window.scale[0]).max(zero).min(most);
    let y = ((y - window.low[1]) * window.scale[1]).max(zero).min(most);
    hilbert(simd, u32x16::truncate_from_precise(x), u32x16::truncate_from_precise(y), axis_bits)
}

/// Places along the Hilbert curve: by quadrants from the largest down, each turned so that the
/// curve enters it where it left the one before.
#[inline(always)]
fn hilbert<S: Simd>(simd: S, mut x: u32x16<S>, mut y: u32x16<S>, axis_bits: u32) -> u32x16<S> {
    let splat = u32x16::splat;
    let (zero, one) = (splat(simd, 0), splat(simd, 1));
    let mut place = zero;
    for bit in (0..axis_bits).rev() {
        let (right, upper) = ((x >> bit) & one, (y >> bit) & one);
        place = (place << 2) | (right << 1) | (right ^ upper);
        // Lower quadrants are mirrored at a diagonal, the one to the right at the other diagonal.
        let is_lower = upper.simd_eq(zero);
        let flip = right.simd_eq(one) & is_lower;
        let flipped = flip.select(splat(simd, u32::MAX), zero);
        let (turned_x, turned_y) = (y ^ flipped, x ^ flipped);
        x = is_lower.select(turned_x, x);
        y = is_lower.select(turned_y, y);
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_visits_every_cell_and_goes_from_cell_to_neighbour() {
        for level in SimdLevel::available() {
            let mut cells = [None; 256];
            for row in 0..16 {
                let places = dispatch!(level.level(), simd => {
                    let columns = u32x16::from_fn(simd, |lane| lane as u32);
                    *hilbert(simd, columns, u32x16::splat(simd, row), 4)
                });
                for (column, place) in places.into_iter().enumerate() {
                    cells[place as usize] = Some((column as i32, row as i32));
                }
            }
            for pair in cells.windows(2) {
                let [Some(a), Some(b)] = [pair[0], pair[1]] else { panic!("a cell is missing") };
                assert_eq!((a.0 - b.0).abs() + (a.1 - b.1).abs(), 1, "{a:?} to {b:?}");
            }
        }
    }
}
