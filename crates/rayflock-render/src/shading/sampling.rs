//! Sample positions: low-discrepancy, and the same whoever asks for them in which order.
//!
//! Points come from an additive recurrence with the generalised golden ratio, in 32-bit fixed
//! point, rotated by a hash of the path. A path is known by the pixel it started from and its
//! turns, not by its place in a batch, so batches can be cut anywhere. Turns chosen by chance take
//! their numbers from an Owen-scrambled Sobol sequence, of which there are as many as paths.
//!
//! **Source**: M. Roberts, *The Unreasonable Effectiveness of Quasirandom Sequences* (2018), for
//! the recurrence; R. Cranley and T. Patterson, *Randomization of Number Theoretic Methods for
//! Multiple Integration* (1976), for the rotation; B. Burley, *Practical Hash-based Owen
//! Scrambling*, JCGT 9(4), 2020, for the scrambling; C. Wellons, *Prospecting for Hash Functions*
//! (2018), for the hash.

use std::f32::consts::TAU;

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3};

/// Powers of the inverse generalised golden ratio in two dimensions, times `2^32`.
const RATIO_2: [u32; 2] = [0xc13f_a9a9, 0x91e1_0da6];
/// The same in three dimensions.
const RATIO_3: [u32; 3] = [0xd1b5_4a33, 0xabc9_8389, 0x8cb9_2ba7];
const HALF: u32 = 1 << 31;

/// The identity of a path from the camera: its pixel and its turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub(crate) struct PathSeed(u32);

/// How a path goes on at a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Turn {
    Mirror,
    Refraction,
    /// Chosen by chance: any.
    Chance,
}

impl PathSeed {
    /// No path.
    pub(crate) const NONE: Self = Self(0);

    /// The path through pixel (`x`, `y`) of the film.
    pub(crate) fn of_pixel(x: usize, y: usize) -> Self {
        Self(hash(x as u32 ^ hash(y as u32)))
    }

    /// The path after a turn.
    pub(crate) fn after(self, turn: Turn) -> Self {
        Self(hash(self.0 ^ (0x9e37_79b9 + turn as u32)))
    }

    /// Paths that belong to no pixel, such as walks from lights: one family of them.
    pub(crate) fn of_walks(family: u32) -> Self {
        Self(hash(0x51ed_270b ^ hash(family)))
    }

    /// Point `sample_idx`, below `2^16`, of the sequence for turn `turn_idx` of such paths, in the
    /// unit cube of four dimensions.
    pub(crate) fn unit_4_cube(self, sample_idx: u32, turn_idx: u32) -> [f32; 4] {
        let set = turn_idx % sobol_burley::NUM_DIMENSION_SETS_4D;
        sobol_burley::sample_4d(sample_idx & 0xffff, set, self.0)
    }

    /// Point `sample_idx` of this path's sequence in the unit cube.
    pub(crate) fn unit_cube(self, sample_idx: u32) -> [f32; 3] {
        let rotation = |axis: u32| hash(self.0.wrapping_add(axis));
        [0, 1, 2].map(|axis| {
            let step = sample_idx.wrapping_mul(RATIO_3[axis as usize]);
            unit_float(rotation(axis).wrapping_add(step))
        })
    }
}

/// Where sample `sample_idx` lies in its pixel, in `0..1` from the top left; the first is the
/// centre.
pub(crate) fn subpixel(sample_idx: u32) -> Vec2 {
    let [x, y] = RATIO_2.map(|ratio| unit_float(HALF.wrapping_add(sample_idx.wrapping_mul(ratio))));
    Vec2::new(x, y)
}

/// A direction about unit `normal`, chosen by `random`, with a density of its cosine over pi.
pub(crate) fn cosine_direction(normal: Vec3, random: [f32; 2]) -> Vec3 {
    let (side, up) = normal.any_orthonormal_pair();
    let (sin_turn, cos_turn) = (TAU * random[1]).sin_cos();
    let radius = random[0].sqrt();
    let height = (1.0 - random[0]).sqrt();
    (side * (radius * cos_turn) + up * (radius * sin_turn) + normal * height).normalize_or(normal)
}

/// Spreads every bit over all others.
pub(crate) fn hash(mut x: u32) -> u32 {
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// The upper 24 bits as a fraction in `0..1`.
pub(crate) fn unit_float(bits: u32) -> f32 {
    (bits >> 8) as f32 / (1 << 24) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_sample_is_the_pixel_centre_and_all_lie_inside() {
        assert_eq!(subpixel(0), Vec2::splat(0.5));
        for sample_idx in 0..1000 {
            let position = subpixel(sample_idx);
            assert!(position.cmpge(Vec2::ZERO).all() && position.cmplt(Vec2::ONE).all());
        }
    }

    #[test]
    fn sixteen_samples_fall_into_all_four_quarters_evenly() {
        let mut counts = [0; 4];
        for sample_idx in 0..16 {
            let position = subpixel(sample_idx);
            counts[usize::from(position.x < 0.5) + 2 * usize::from(position.y < 0.5)] += 1;
        }
        assert!(counts.iter().all(|count| (3..=5).contains(count)), "{counts:?}");
    }

    #[test]
    fn directions_crowd_around_the_normal_as_the_cosine_says() {
        let normal = Vec3::new(0.48, 0.6, 0.64);
        let seed = PathSeed::of_walks(0);
        let mean = (0..1024).map(|i| {
            let [u, v, ..] = seed.unit_4_cube(i, 3);
            cosine_direction(normal, [u, v])
        });
        // The mean of the cosine, weighted by itself.
        let mean = mean.sum::<Vec3>() / 1024.0;
        assert!((mean - normal * (2.0 / 3.0)).length() < 1e-2, "{mean}");
    }

    #[test]
    fn paths_have_sequences_of_their_own_with_the_right_mean() {
        let seed = PathSeed::of_pixel(3, 5);
        assert_ne!(seed.after(Turn::Mirror), seed.after(Turn::Refraction));
        let mean = |axis: usize| (0..256).map(|i| seed.unit_cube(i)[axis]).sum::<f32>() / 256.0;
        assert!((0..3).all(|axis| (mean(axis) - 0.5).abs() < 0.02));
    }
}
