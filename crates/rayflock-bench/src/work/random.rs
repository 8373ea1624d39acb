//! Random numbers that a seed reproduces.
//!
//! **Source.** G. Steele, D. Lea, C. Flood, "Fast Splittable Pseudorandom Number Generators",
//! OOPSLA 2014 (SplitMix64): a Weyl sequence, scrambled.

use std::f32::consts::TAU;

use rayflock::prelude::Vec3;

/// The step of the Weyl sequence.
const STEP: u64 = 0x9E37_79B9_7F4A_7C15;

/// The state of a generator.
#[derive(Clone, Debug)]
pub(super) struct Random {
    state: u64,
}

impl Random {
    /// A generator whose numbers depend on `seed` alone.
    pub(super) const fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// The generator of item `idx`: items need not be visited in any order.
    pub(super) const fn of_item(seed: u64, idx: usize) -> Self {
        Self::new(scramble(seed ^ scramble((idx as u64).wrapping_add(STEP))))
    }

    const fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(STEP);
        scramble(self.state)
    }

    /// A number in `0..1`, 1 excluded.
    pub(super) fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1_u64 << 24) as f32
    }

    /// A number in `low..high`.
    pub(super) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// A whole number in `0..count`, `count` not 0.
    const fn below(&mut self, count: usize) -> usize {
        // The high half of the product: the bias is 2^-64 * count.
        ((self.bits() as u128 * count as u128) >> 64) as usize
    }

    /// A direction of unit length, evenly over the sphere.
    pub(super) fn direction(&mut self) -> Vec3 {
        let (y, angle) = (self.between(-1.0, 1.0), TAU * self.unit());
        let radius = (1.0 - y * y).max(0.0).sqrt();
        Vec3::new(radius * angle.cos(), y, radius * angle.sin())
    }

    /// A point evenly in the ball of radius 1.
    pub(super) fn in_ball(&mut self) -> Vec3 {
        self.direction() * self.unit().cbrt()
    }

    /// A direction of unit length on the side of `normal`, as likely as the cosine between them.
    pub(super) fn around(&mut self, normal: Vec3) -> Vec3 {
        let (radius, angle) = (self.unit().sqrt(), TAU * self.unit());
        let (right, up) = normal.any_orthonormal_pair();
        let height = (1.0 - radius * radius).max(0.0).sqrt();
        (right * (radius * angle.cos()) + up * (radius * angle.sin()) + normal * height).normalize()
    }

    /// Puts `items` in random order.
    ///
    /// **Source.** R. Durstenfeld, "Algorithm 235: Random permutation", CACM 1964.
    pub(super) fn shuffle<T>(&mut self, items: &mut [T]) {
        for last in (1..items.len()).rev() {
            items.swap(last, self.below(last + 1));
        }
    }
}

const fn scramble(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stay_in_range_and_repeat() {
        let (mut a, mut b) = (Random::new(7), Random::new(7));
        for _ in 0..1000 {
            let value = a.between(2.0, 3.0);
            assert!((2.0..3.0).contains(&value));
            assert_eq!(value, b.between(2.0, 3.0));
            assert!((a.direction().length() - 1.0).abs() < 1e-5);
            assert!(a.in_ball().length() <= 1.0 + 1e-6);
            assert!(a.below(3) < 3);
            (_, _, _) = (b.direction(), b.in_ball(), b.below(3));
        }
    }

    #[test]
    fn a_shuffle_moves_nearly_everything_and_loses_nothing() {
        let mut items: Vec<usize> = (0..1000).collect();
        Random::new(3).shuffle(&mut items);
        let at_home = items.iter().enumerate().filter(|&(place, &item)| place == item).count();
        assert!(at_home < 10, "{at_home}");
        items.sort_unstable();
        assert!(items.into_iter().eq(0..1000));
    }

    #[test]
    fn directions_around_a_normal_follow_the_cosine() {
        let normal = Vec3::new(0.6, -0.8, 0.0);
        let cosines: Vec<f32> =
            (0..20_000).map(|idx| Random::of_item(5, idx).around(normal).dot(normal)).collect();
        assert!(cosines.iter().all(|&cosine| (0.0..=1.0 + 1e-6).contains(&cosine)));
        // The density 2c of the cosine c has the mean 2/3 and the mean square 1/2.
        let mean = |f: fn(f32) -> f32| cosines.iter().map(|&c| f(c)).sum::<f32>() / 20_000.0;
        assert!((mean(|c| c) - 2.0 / 3.0).abs() < 0.01);
        assert!((mean(|c| c * c) - 0.5).abs() < 0.01);
    }
}
