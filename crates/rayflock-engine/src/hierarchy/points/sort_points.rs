//! Sorts rays by their place on the faces, along a Hilbert curve.

use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};

use rayflock_geom::RayBatch;
use rayflock_geom::simd::face::Face;
use rayflock_geom::simd::{
    LANES, Select, Simd, SimdBase, SimdCvtTruncate, SimdLevel, SimdMask, dispatch, f32x16, u32x16,
};
use rayon::prelude::*;

use super::super::arrange::NO_RAY;
use super::radix_sort::RadixSorter;
use super::ray_columns::RayColumns;

/// Rays that one task gives keys.
const RAYS_PER_TASK: usize = 4096;

/// Bits of the curve at most; a face number stands above them.
const MOST_CURVE_BITS: u32 = 28;

/// Bits of a face number.
const FACE_BITS: u32 = 3;

/// Face number of rays that have no place, or are not to be traced.
const NOWHERE: u32 = 7;

/// Rays in the order of their places on the faces.
#[derive(Debug, Default)]
pub(super) struct PointSorter {
    sorter: RadixSorter,
    /// Positions in the batch; each face's rays fill whole tiles, with [`NO_RAY`] at the end.
    pub(super) ray_idx: Vec<u32>,
    /// For each tile, its face.
    pub(super) tile_faces: Vec<u32>,
    places: Vec<AtomicU32>,
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
            self.sorter.sort(window.curve_bits + FACE_BITS);
            self.fill_tiles(faces.len(), window.curve_bits, tile_len);
        }
        (invalid_count, is_lost)
    }

    fn fill_tiles(&mut self, face_count: usize, curve_bits: u32, tile_len: usize) {
        let sorted = self.sorter.sorted();
        self.ray_idx.clear();
        self.tile_faces.clear();
        self.places.resize_with(sorted.len(), AtomicU32::default);
        let mut begin = 0;
        for face_idx in 0..face_count as u32 {
            let face_of = |entry: &AtomicU64| (entry.load(Relaxed) >> (32 + curve_bits)) as u32;
            let rest = &sorted[begin..];
            let rest = &rest[..rest.partition_point(|entry| face_of(entry) <= face_idx)];
            let first = self.ray_idx.len();
            self.ray_idx.resize(first + rest.len().next_multiple_of(tile_len), NO_RAY);
            self.tile_faces.resize(self.ray_idx.len() / tile_len, face_idx);
            let places = &self.places;
            let tasks = self.ray_idx[first..].par_chunks_mut(RAYS_PER_TASK);
            tasks.zip(rest.par_chunks(RAYS_PER_TASK)).enumerate().for_each(
                |(task_idx, (ray_idx, entries))| {
                    for (idx, (ray_idx, entry)) in ray_idx.iter_mut().zip(entries).enumerate() {
                        *ray_idx = entry.load(Relaxed) as u32;
                        let place = first + task_idx * RAYS_PER_TASK + idx;
                        places[*ray_idx as usize].store(place as u32, Relaxed);
                    }
                },
            );
            begin += rest.len();
        }
        for entry in &sorted[begin..] {
            self.places[entry.load(Relaxed) as u32 as usize].store(NO_RAY, Relaxed);
        }
    }

    /// Where a ray of the batch lies; [`NO_RAY`] for one that is not traced.
    #[inline(always)]
    pub(super) fn place(&self, ray_idx: usize) -> u32 {
        self.places[ray_idx].load(Relaxed)
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.sorter.memory_usage()
            + 4 * (self.ray_idx.capacity() + self.tile_faces.capacity() + self.places.capacity())
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
            columns.gather(batch, &positions);
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
    // Some four to sixteen cells a ray.
    let axis_bits = (usize::BITS - batch.len().leading_zeros()).div_ceil(2) + 1;
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
        columns.gather(batch, &positions(start, start + keyed.len()));
        let states = columns.states(simd);
        invalid_count += states.invalid_count;
        let mut left = states.active;
        let mut keys = u32x16::splat(simd, NOWHERE << window.curve_bits);
        for (face_idx, face) in faces.iter().enumerate() {
            let points = face.project_rays(simd, columns.origin(simd), columns.direction(simd));
            let mut here = left & points.on_face;
            if faces.len() > 1 {
                // Each ray belongs to the side of the cube that it pierces.
                let side = f32x16::splat(simd, 1.0);
                here &= points.x.abs().simd_le(side) & points.y.abs().simd_le(side);
            }
            let curve = curve(simd, window, points.x, points.y);
            let key = curve | u32x16::splat(simd, (face_idx as u32) << window.curve_bits);
            keys = here.select(key, keys);
            left &= !here;
        }
        is_lost |= left.any_true() | states.looks_back;
        for (lane, keyed) in keyed.iter_mut().enumerate() {
            *keyed.get_mut() = (u64::from(keys[lane]) << 32) | (start + lane) as u64;
        }
    }
    (invalid_count, is_lost)
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
