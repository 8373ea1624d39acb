//! Sorts rays by their place on the faces, strip by strip and column by column.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayflock_geom::RayBatch;
use rayflock_geom::simd::face::{Face, FaceKind, pierce_cube};
use rayflock_geom::simd::point_box::PointBox;
use rayflock_geom::simd::{
    LANES, Select, Simd, SimdBase, SimdLevel, SimdMask, dispatch, f32x16, mask32x16, u32x16,
};
use rayon::prelude::*;
use tracing::debug_span;

use super::super::arrange::NO_RAY;
use super::faces::spread_positions;
use super::ray_columns::{RayColumns, RayStates};
use super::ray_strips::{Band, FaceStrips, RayStrips, extent};
use crate::sort_keyed::KeyedSorter;

/// Rays that one task gives keys.
const RAYS_PER_TASK: usize = 4096;

/// Cells that one task looks up.
const CELLS_PER_TASK: usize = 4096;

/// Groups of rays that are looked at for the window.
const WINDOW_SAMPLE: usize = 64;

/// Strips of a face at most, as a power of two.
const MOST_STRIP_BITS: u32 = 10;

/// Columns for each strip of a face, as a power of two: a group is as wide as a strip is high
/// where there are sixteen rays in so many cells.
const COLUMNS_PER_STRIP: u32 = 2;

/// How far points on the sides of a cube are from those on faces at most, for rounding.
const ON_CUBE: f32 = 1.0 / (1 << 18) as f32;

/// Where points on a side of a cube are, rounded as they may be.
const ON_SIDE: [f32; 4] = [-1.0 - ON_CUBE, 1.0 + ON_CUBE, -1.0 - ON_CUBE, 1.0 + ON_CUBE];

/// Brings rays into strips by sorting.
#[derive(Debug, Default)]
pub(super) struct StripSorter {
    sorter: KeyedSorter,
    placed: usize,
}

/// What is known of some rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeenRays {
    pub(super) invalid_count: u64,
    /// Whether an active ray has no place or looks behind its origin.
    pub(super) is_lost: bool,
    /// Around their points, where there is a single face.
    bound: PointBox,
    /// The largest distance of an origin from the center of the face.
    reach: f32,
}

impl SeenRays {
    const NONE: Self =
        Self { invalid_count: 0, is_lost: false, bound: PointBox::EMPTY, reach: 0.0 };

    fn join(self, other: Self) -> Self {
        Self {
            invalid_count: self.invalid_count + other.invalid_count,
            is_lost: self.is_lost | other.is_lost,
            bound: self.bound.union(&other.bound),
            reach: self.reach.max(other.reach),
        }
    }
}

impl StripSorter {
    /// Sorts the rays of the batch into strips, in bands of about `band_len` rays; not if a ray is
    /// lost. With `notes_rays`, faces know afterwards where rays are.
    pub(super) fn sort(
        &mut self,
        level: SimdLevel,
        batch: &RayBatch<'_>,
        faces: &[Face],
        (band_len, notes_rays): (usize, bool),
        strips: &mut RayStrips,
    ) -> SeenRays {
        let _span = debug_span!("sort_strips").entered();
        strips.clear(faces);
        dispatch!(level.level(), simd => lay_out(simd, batch, strips));
        for face in strips.faces.iter_mut().filter(|_| notes_rays) {
            let [x0, x1, y0, y1] = face.window();
            face.occupancy.clear([x0, x1, y0, y1], batch.len());
            face.asks_occupancy = true;
        }
        let tasks = self.sorter.entries(batch.len()).par_chunks_mut(RAYS_PER_TASK).enumerate();
        let seen = tasks
            .map(|(task_idx, keyed)| {
                let first_ray = task_idx * RAYS_PER_TASK;
                dispatch!(level.level(), simd => write_keys(simd, batch, strips, first_ray, keyed))
            })
            .reduce(|| SeenRays::NONE, SeenRays::join);
        if !seen.is_lost {
            self.fill(band_len, strips);
            note_bounds(&seen, strips);
            if notes_rays {
                note_rays(level, batch, strips);
            }
        }
        seen
    }

    /// Sorts the entries and writes cells, bands and the order of the rays.
    fn fill(&mut self, band_len: usize, strips: &mut RayStrips) {
        let cell_count: usize =
            strips.faces.iter().map(|face| face.strip_count * face.columns).sum();
        // The cell behind the last one is that of rays that are not traced.
        self.sorter.sort(usize::BITS - cell_count.leading_zeros());
        let sorted = self.sorter.sorted();
        strips.cells.resize(cell_count + 1, 0);
        let tasks = strips.cells.par_chunks_mut(CELLS_PER_TASK).enumerate();
        tasks.for_each(|(task_idx, cells)| look_up(sorted, task_idx * CELLS_PER_TASK, cells));
        self.placed = strips.cells[cell_count] as usize;
        strips.cut_bands(band_len);
        strips.ray_idx.resize(strips.bands.last().map_or(0, |band| band.end_place), NO_RAY);
        write_bands(sorted, &strips.bands, &mut strips.ray_idx);
    }

    /// Rays of the batch that are in no strip.
    pub(super) fn left_out(&self) -> impl Iterator<Item = u32> + '_ {
        self.sorter.sorted()[self.placed..].iter().map(ray_of)
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        self.sorter.memory_usage()
    }
}

/// The ray of an entry; its cell stands above.
fn ray_of(entry: &AtomicU64) -> u32 {
    entry.load(Relaxed) as u32
}

/// Writes how many entries come before each of some cells.
fn look_up(sorted: &[AtomicU64], first_cell: usize, cells: &mut [u32]) {
    let cell_of = |entry: &AtomicU64| (entry.load(Relaxed) >> 32) as usize;
    let mut before = sorted.partition_point(|entry| cell_of(entry) < first_cell);
    for (idx, cell) in cells.iter_mut().enumerate() {
        while sorted.get(before).is_some_and(|entry| cell_of(entry) < first_cell + idx) {
            before += 1;
        }
        *cell = before as u32;
    }
}

/// Writes the rays of consecutive bands, from the place of the first on, in parallel.
fn write_bands(sorted: &[AtomicU64], bands: &[Band], ray_idx: &mut [u32]) {
    if let [band] = bands {
        let entries = &sorted[band.first_ray..band.end_ray];
        let (places, rest) = ray_idx.split_at_mut(entries.len());
        places.iter_mut().zip(entries).for_each(|(ray_idx, entry)| *ray_idx = ray_of(entry));
        rest.fill(NO_RAY);
    } else if let Some(middle) = bands.get(bands.len() / 2) {
        let (before, after) = bands.split_at(bands.len() / 2);
        let (left, right) = ray_idx.split_at_mut(middle.first_place - bands[0].first_place);
        rayon::join(|| write_bands(sorted, before, left), || write_bands(sorted, after, right));
    }
}

/// Divides the faces into strips and columns: four by four rays a group, as far as the window
/// around a sample tells; the squares of a cube's sides are known.
#[inline(always)]
fn lay_out<S: Simd>(simd: S, batch: &RayBatch<'_>, strips: &mut RayStrips) {
    let is_cube = strips.faces.len() > 1;
    let [x0, x1, y0, y1] = match &strips.faces[..] {
        [face] => sample_bounds(simd, batch, &face.face),
        _ => [-1.0, 1.0, -1.0, 1.0],
    };
    let ray_bits = usize::BITS - batch.len().leading_zeros();
    let strip_bits = (ray_bits.div_ceil(2) - u32::from(is_cube)).saturating_sub(2);
    let strip_bits = strip_bits.min(MOST_STRIP_BITS);
    let (strip_count, columns) = (1 << strip_bits, 1 << (strip_bits + COLUMNS_PER_STRIP));
    let scale = [(columns, x0, x1), (strip_count, y0, y1)].map(|(count, low, high)| {
        let scale = count as f32 / (high - low);
        if scale.is_finite() && scale > 0.0 { scale } else { 1.0 }
    });
    let low = [x0, y0].map(|low| if low.is_finite() { low } else { 0.0 });
    for (face_idx, face) in strips.faces.iter_mut().enumerate() {
        face.first_strip = face_idx * strip_count;
        (face.strip_count, face.columns) = (strip_count, columns);
        (face.low, face.scale) = (low, scale);
        face.tolerance = [if is_cube { ON_CUBE } else { 0.0 }; 2];
    }
}

/// Around the points of some rays.
#[inline(always)]
fn sample_bounds<S: Simd>(simd: S, batch: &RayBatch<'_>, face: &Face) -> [f32; 4] {
    let mut columns = RayColumns::EMPTY;
    let mut bound = PointBox::EMPTY;
    for first_ray in spread_positions(batch.len(), WINDOW_SAMPLE) {
        columns.gather(simd, batch, &positions(first_ray, batch.len()));
        let points = face.project_rays(simd, columns.origin(simd), columns.direction(simd));
        let active = columns.states(simd).active & points.on_face;
        let around = [points.x, points.y, points.x, points.y];
        bound = bound.union(&PointBox::around(simd, around, active));
    }
    bound.bounds
}

/// Takes over what was seen of all rays.
fn note_bounds(seen: &SeenRays, strips: &mut RayStrips) {
    if let [face] = &mut strips.faces[..] {
        face.bounds = seen.bound.bounds;
        if let FaceKind::Parallel { reach } = &mut face.face.kind {
            *reach = seen.reach;
        }
        return;
    }
    for face in &mut strips.faces {
        let (first_strip, columns) = (face.first_strip, face.columns);
        let has_rays = |strip: &usize| {
            let cell = (first_strip + strip) * columns;
            strips.cells[cell] < strips.cells[cell + columns]
        };
        // The first strip and the last reach to the bounds.
        face.bounds = ON_SIDE;
        let first = (0..face.strip_count).find(has_rays);
        let last = (0..face.strip_count).rfind(has_rays);
        if let (Some(first), Some(last)) = (first, last) {
            let ([low, _], [_, high]) = (face.strip_y(first), face.strip_y(last));
            let [x0, x1, y0, y1] = ON_SIDE;
            face.bounds = [x0, x1, low.max(y0), high.min(y1)];
        } else {
            face.bounds = PointBox::EMPTY.bounds;
        }
    }
}

/// Notes where rays are on the sides of a cube, and makes what was noted ready on all faces.
fn note_rays(level: SimdLevel, batch: &RayBatch<'_>, strips: &mut RayStrips) {
    let _span = debug_span!("note_rays").entered();
    if strips.faces.len() > 1 {
        let RayStrips { faces, bands, ray_idx, .. } = &*strips;
        bands.par_iter().for_each(|band| {
            let ray_idx = &ray_idx[band.first_place..band.end_place];
            let face = &faces[band.face_idx];
            dispatch!(level.level(), simd => note_band(simd, batch, face, ray_idx));
        });
    }
    strips.faces.par_iter_mut().for_each(|face| face.occupancy.finish());
}

#[inline(always)]
fn note_band<S: Simd>(simd: S, batch: &RayBatch<'_>, face: &FaceStrips, ray_idx: &[u32]) {
    let mut columns = RayColumns::EMPTY;
    for ray_idx in ray_idx.chunks(LANES) {
        columns.gather(simd, batch, ray_idx);
        let active = columns.states(simd).active;
        let points = face.face.project_rays(simd, columns.origin(simd), columns.direction(simd));
        face.occupancy.note(simd, points.x, points.y, active);
    }
}

/// Up to sixteen consecutive positions.
fn positions(first: usize, len: usize) -> [u32; LANES] {
    std::array::from_fn(|lane| if first + lane < len { (first + lane) as u32 } else { NO_RAY })
}

/// Writes the cells of the rays from `first_ray` on.
#[inline(always)]
fn write_keys<S: Simd>(
    simd: S,
    batch: &RayBatch<'_>,
    strips: &RayStrips,
    first_ray: usize,
    keyed: &mut [AtomicU64],
) -> SeenRays {
    let mut columns = RayColumns::EMPTY;
    let mut seen = SeenRays::NONE;
    // All faces are divided alike.
    let face = &strips.faces[0];
    let face_cells = (face.strip_count * face.columns) as u32;
    let nowhere = u32x16::splat(simd, strips.faces.len() as u32 * face_cells);
    for (idx, keyed) in keyed.chunks_mut(LANES).enumerate() {
        let first = first_ray + idx * LANES;
        columns.gather(simd, batch, &positions(first, first + keyed.len()));
        let states = columns.states(simd);
        let placed = place(simd, strips, &columns, &states, &mut seen);
        let cell = face.places(simd, placed.y, 1) * u32x16::splat(simd, face.columns as u32)
            + face.places(simd, placed.x, 0)
            + placed.face_idx * u32x16::splat(simd, face_cells);
        let cell = placed.is_there.select(cell, nowhere);
        for (lane, keyed) in keyed.iter_mut().enumerate() {
            *keyed.get_mut() = (u64::from(cell[lane]) << 32) | (first + lane) as u64;
        }
    }
    seen
}

/// Sixteen rays on their faces.
struct Placed<S: Simd> {
    is_there: mask32x16<S>,
    face_idx: u32x16<S>,
    x: f32x16<S>,
    y: f32x16<S>,
}

/// Finds the points of sixteen rays, and notes what was seen of them.
#[inline(always)]
fn place<S: Simd>(
    simd: S,
    strips: &RayStrips,
    columns: &RayColumns,
    states: &RayStates<S>,
    seen: &mut SeenRays,
) -> Placed<S> {
    seen.invalid_count += states.invalid_count;
    let [FaceStrips { face, occupancy, asks_occupancy, .. }] = &strips.faces[..] else {
        let (face_idx, [x, y]) = pierce_cube(simd, columns.direction(simd));
        seen.is_lost |= states.looks_back;
        return Placed { is_there: states.active, face_idx, x, y };
    };
    let points = face.project_rays(simd, columns.origin(simd), columns.direction(simd));
    let is_there = states.active & points.on_face;
    let around = [points.x, points.y, points.x, points.y, extent(&points)];
    let (bound, reach) = PointBox::around_with_most(simd, around, is_there);
    seen.bound = seen.bound.union(&bound);
    seen.reach = seen.reach.max(reach);
    seen.is_lost |= states.looks_back | (states.active & !points.on_face).any_true();
    if *asks_occupancy {
        occupancy.note(simd, points.x, points.y, is_there);
    }
    Placed { is_there, face_idx: u32x16::splat(simd, 0), x: points.x, y: points.y }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use rayflock_testkit::Rng;

    use super::super::faces::Faces;
    use super::*;

    /// Rays all over a face, most of them crowded: those in a box are among the groups that the
    /// box looks up, each in one band.
    #[test]
    fn boxes_find_all_rays_in_them() {
        let mut rng = Rng::new(77);
        let crowded = |rng: &mut Rng| if rng.one_in(3) { 4.0 } else { 0.05 };
        let origins: Vec<Vec3> = (0..3000)
            .map(|_| {
                let size = crowded(&mut rng);
                Vec3::new(size * rng.unit(), size * rng.unit(), 0.0)
            })
            .collect();
        let batch = RayBatch::new(&origins, Vec3::Z).unwrap();
        let mut faces = Faces::default();
        assert!(faces.choose(&batch));
        for level in SimdLevel::available() {
            let (mut sorter, mut strips) = (StripSorter::default(), RayStrips::default());
            let seen = sorter.sort(level, &batch, &faces.faces, (200, false), &mut strips);
            assert!(!seen.is_lost && seen.invalid_count == 0);
            let face = &strips.faces[0];
            let points: Vec<[f32; 2]> = origins
                .iter()
                .map(|&origin| {
                    let p = origin - face.face.center;
                    [face.face.rows[0].dot(p), face.face.rows[1].dot(p)]
                })
                .collect();
            for _ in 0..200 {
                let (x, y, size) = (rng.between(-3.0, 3.0), rng.between(-3.0, 3.0), rng.unit());
                let (ends, heights) = ([x, x + size], [y, y + size * rng.unit()]);
                let mut found = vec![0; origins.len()];
                for band in &strips.bands {
                    let ray_idx = &strips.ray_idx[band.first_place..band.end_place];
                    let mut groups: Vec<usize> = (face.strips(heights)[0]
                        ..=face.strips(heights)[1])
                        .flat_map(|strip| strips.groups(face, band, strip, ends))
                        .collect();
                    groups.dedup();
                    let rays = groups.iter().flat_map(|group| &ray_idx[group * LANES..][..LANES]);
                    rays.filter(|&&ray| ray != NO_RAY).for_each(|&ray| found[ray as usize] += 1);
                }
                for (point, found) in points.iter().zip(found) {
                    let margin = 1e-5;
                    let is_inside = ends[0] + margin < point[0]
                        && point[0] < ends[1] - margin
                        && heights[0] + margin < point[1]
                        && point[1] < heights[1] - margin;
                    assert!(found == 1 || !is_inside, "{point:?} was found {found} times");
                }
            }
        }
    }
}
