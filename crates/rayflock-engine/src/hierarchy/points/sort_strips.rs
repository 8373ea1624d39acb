//! Sorts rays by their place on the faces, strip by strip and column by column.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use rayflock_geom::RayBatch;
use rayflock_geom::simd::face::Face;
use rayflock_geom::simd::{LANES, Simd, SimdLevel, dispatch};
use rayon::prelude::*;
use tracing::debug_span;

use super::super::arrange::NO_RAY;
use super::place_rays::{SeenRays, lay_out, note_bounds, write_keys};
use super::ray_columns::RayColumns;
use super::ray_strips::{Band, FaceStrips, RayStrips};
use crate::sort_keyed::KeyedSorter;

/// Rays that one task gives keys.
const RAYS_PER_TASK: usize = 4096;

/// Brings rays into strips by sorting.
#[derive(Debug, Default)]
pub(super) struct StripSorter {
    sorter: KeyedSorter,
    placed: usize,
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
            dispatch!(level.level(), simd => note_bounds(simd, &seen, strips));
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
        let key_bits = usize::BITS - cell_count.leading_zeros();
        strips.cells.resize(1 << key_bits, 0);
        self.sorter.sort_and_count(key_bits, Some(&mut strips.cells));
        let sorted = self.sorter.sorted();
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

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use rayflock_geom::simd::face_triangle::{FaceReach, FaceTriangle};
    use rayflock_testkit::Rng;

    use super::super::faces::Faces;
    use super::super::look_up_groups::{Pairs, Sought};
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
                let reach = FaceReach::anywhere([x, x + size, heights[0], heights[1]], 0.0);
                let triangle = FaceTriangle::of(&reach);
                let mut found = vec![0; origins.len()];
                for band in &strips.bands {
                    let mut pairs = Pairs::default();
                    dispatch!(level.level(), simd => {
                        let sought = Sought::one(simd, &triangle, face.strips(heights));
                        pairs.look_up(simd, &strips, (face, band), &sought);
                    });
                    let mut groups: Vec<usize> =
                        (0..pairs.len()).map(|idx| pairs.get(idx).1).collect();
                    groups.dedup();
                    let ray_idx = &strips.ray_idx[band.first_place..band.end_place];
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
