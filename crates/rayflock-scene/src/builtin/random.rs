//! A small generator of random numbers, so that scenes stay the same.
//!
//! **Source.** G. Steele, D. Lea, C. Flood, "Fast Splittable Pseudorandom Number Generators",
//! OOPSLA 2014 (SplitMix64): a Weyl sequence, scrambled.

use std::f32::consts::TAU;

use glam::Vec3;

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

    fn next_u64(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number in `0..1`, 1 excluded.
    pub(super) fn unit(&mut self) -> f32 {
        (self.next_u64() >> 40) as f32 / (1_u64 << 24) as f32
    }

    /// A number in `low..high`.
    pub(super) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// A direction of unit length, evenly over the sphere.
    pub(super) fn direction(&mut self) -> Vec3 {
        let (y, angle) = (self.between(-1.0, 1.0), TAU * self.unit());
        let radius = (1.0 - y * y).max(0.0).sqrt();
        Vec3::new(radius * angle.cos(), y, radius * angle.sin())
    }

    /// A point evenly over the disc of this radius around the origin, with `y == 0`.
    pub(super) fn in_disc(&mut self, radius: f32) -> Vec3 {
        let (distance, angle) = (radius * self.unit().sqrt(), TAU * self.unit());
        Vec3::new(distance * angle.cos(), 0.0, distance * angle.sin())
    }
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
            assert!(a.in_disc(0.5).length() <= 0.5);
            (_, _) = (b.direction(), b.in_disc(0.5));
        }
    }
}
