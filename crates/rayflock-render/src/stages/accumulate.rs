//! Last stage: light arrives at pixels.
//!
//! Sums are kept in `f64`, where adding `f32` values is exact but for the rarest cases; so the
//! picture does not depend on how rays were cut into batches.

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
        let _span = debug_span!("accumulate").entered();
        for run in runs {
            run.unshadowed.iter().for_each(|contribution| self.add(contribution));
        }
    }

    /// Adds the light whose shadow ray found nothing in its way;
    /// `occluded.len() == contributions.len()`.
    pub(crate) fn add_lit(&mut self, contributions: &[Contribution], occluded: &[bool]) {
        let _span = debug_span!("accumulate").entered();
        for (contribution, &occluded) in contributions.iter().zip(occluded) {
            if !occluded {
                self.add(contribution);
            }
        }
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

    fn add(&mut self, &Contribution { pixel_idx, radiance }: &Contribution) {
        if !radiance.is_finite() {
            self.dropped += 1;
            return;
        }
        let Vec3 { x, y, z } = radiance;
        let sum = &mut self.sums[pixel_idx as usize];
        sum.iter_mut().zip([x, y, z]).for_each(|(sum, added)| *sum += f64::from(added));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_occluded_or_not_finite_is_left_out() {
        let of = |value| Contribution { pixel_idx: 0, radiance: Vec3::splat(value) };
        let mut sums = BandSums::default();
        sums.reset(1);
        sums.add_lit(&[of(1.0), of(2.0), of(f32::NAN), of(5.0)], &[false, true, false, false]);
        let mut pixels = [[0.0; 3]];
        sums.write(2, &mut pixels);
        assert_eq!((pixels, sums.dropped()), ([[3.0; 3]], 1));
    }
}
