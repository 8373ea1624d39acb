//! Last stage: light arrives at pixels.
//!
//! Sums are kept in `f64`, where adding `f32` values is exact but for the rarest cases; so the
//! picture does not depend on how rays were cut into batches.
//!
//! Each thread has a part of the pixels and adds what arrives there, in the order of the rays, so
//! no two threads ever add to one pixel. Runs that lie elsewhere in the picture are skipped whole:
//! all but a few for rays from the camera.

use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;
use tracing::debug_span;

use crate::wave::{Contribution, ShadedRun};

/// The sums of a band of rows.
#[derive(Debug, Default)]
pub(crate) struct BandSums {
    sums: Vec<[f64; 3]>,
    dropped: u64,
}

impl BandSums {
    /// Starts a band of `pixel_count` black pixels.
    pub(crate) fn reset(&mut self, pixel_count: usize) {
        self.sums.clear();
        self.sums.resize(pixel_count, [0.0; 3]);
    }

    /// Adds light that needs no shadow ray.
    pub(crate) fn add_unshadowed(&mut self, runs: &[ShadedRun]) {
        self.add(|part| {
            for run in runs {
                if part.overlaps(&run.pixels) {
                    run.unshadowed.iter().for_each(|contribution| part.add(contribution));
                }
            }
        });
    }

    /// Adds the light whose shadow ray found nothing in its way; `occluded` has an entry for each
    /// shadow ray of all runs.
    pub(crate) fn add_lit(&mut self, runs: &[ShadedRun], occluded: &[bool]) {
        self.add(|part| {
            let mut occluded = occluded;
            for run in runs {
                let (of_run, of_others) = occluded.split_at(run.lit.len());
                occluded = of_others;
                if part.overlaps(&run.pixels) {
                    let lit = run.lit.iter().zip(of_run).filter(|(_, occluded)| !**occluded);
                    lit.for_each(|(contribution, _)| part.add(contribution));
                }
            }
        });
    }

    /// Has each thread add what arrives at its part of the pixels.
    fn add(&mut self, add_part: impl Fn(&mut Part<'_>) + Sync) {
        let _span = debug_span!("accumulate").entered();
        let part_len = self.sums.len().div_ceil(rayon::current_num_threads()).max(1);
        let parts = self.sums.par_chunks_mut(part_len).enumerate().map(|(part_idx, sums)| {
            let mut part = Part { first_pixel: part_idx * part_len, sums, dropped: 0 };
            add_part(&mut part);
            part.dropped
        });
        self.dropped += parts.sum::<u64>();
    }

    /// Writes the means over `sample_count` samples to the pixels of the band.
    pub(crate) fn write(&self, sample_count: u32, pixels: &mut [[f32; 3]]) {
        let share = 1.0 / f64::from(sample_count);
        pixels.par_iter_mut().zip(&self.sums).for_each(|(pixel, sum)| {
            *pixel = sum.map(|channel| (channel * share).min(f64::from(f32::MAX)) as f32);
        });
    }

    /// Contributions left out since the beginning because they were not finite.
    pub(crate) const fn dropped(&self) -> u64 {
        self.dropped
    }

    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        self.sums.capacity() * size_of::<[f64; 3]>()
    }
}

/// Neighbouring pixels that one thread adds to.
struct Part<'a> {
    first_pixel: usize,
    sums: &'a mut [[f64; 3]],
    dropped: u64,
}

impl Part<'_> {
    /// Whether any of `pixels` may belong to this part.
    fn overlaps(&self, pixels: &Range<usize>) -> bool {
        pixels.start < self.first_pixel + self.sums.len() && self.first_pixel < pixels.end
    }

    /// Adds a contribution if its pixel belongs to this part.
    fn add(&mut self, &Contribution { pixel_idx, radiance }: &Contribution) {
        let place = (pixel_idx as usize).wrapping_sub(self.first_pixel);
        let Some(sum) = self.sums.get_mut(place) else { return };
        if !radiance.is_finite() {
            self.dropped += 1;
            return;
        }
        let Vec3 { x, y, z } = radiance;
        sum.iter_mut().zip([x, y, z]).for_each(|(sum, added)| *sum += f64::from(added));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_thread_adds_to_its_own_pixels() {
        let contribution = |pixel_idx: usize| Contribution {
            pixel_idx: pixel_idx as u32,
            radiance: Vec3::splat(1.0 + pixel_idx as f32),
        };
        let run = |pixels: [usize; 3]| ShadedRun {
            unshadowed: pixels.map(contribution).into(),
            pixels: pixels[0].min(pixels[1])..pixels[2] + 1,
            ..ShadedRun::default()
        };
        let runs = [run([0, 1, 2]), run([6, 3, 8]), run([0, 4, 9])];
        for threads in [1, 2, 3, 16] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut sums = BandSums::default();
            sums.reset(10);
            pool.install(|| sums.add_unshadowed(&runs));
            let mut pixels = [[0.0; 3]; 10];
            sums.write(1, &mut pixels);
            let found = pixels.map(|pixel| pixel[0]);
            assert_eq!(found, [2.0, 2.0, 3.0, 4.0, 5.0, 0.0, 7.0, 0.0, 9.0, 10.0], "{threads}");
        }
    }

    #[test]
    fn what_is_occluded_or_not_finite_is_left_out() {
        let of = |value| Contribution { pixel_idx: 0, radiance: Vec3::splat(value) };
        let mut sums = BandSums::default();
        sums.reset(1);
        let run = |lit| ShadedRun { lit, pixels: 0..1, ..ShadedRun::default() };
        let runs = [run(vec![of(1.0), of(2.0), of(f32::NAN)]), run(vec![of(5.0)])];
        sums.add_lit(&runs, &[false, true, false, false]);
        let mut pixels = [[0.0; 3]];
        sums.write(2, &mut pixels);
        assert_eq!((pixels, sums.dropped()), ([[3.0; 3]], 1));
    }
}
