//! Chance, the same whoever asks for it in which order: a hash of what it decides.
//!
//! **Source**: G. E. P. Box and M. E. Muller, *A Note on the Generation of Random Normal Deviates*,
//! Annals of Mathematical Statistics 29(2), 1958; the hash is that of
//! [`sampling`](crate::shading::sampling).

use std::f64::consts::TAU;

use crate::shading::sampling::hash;

/// The chances of one sweep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Draws(u32);

/// What is left to chance about an echo.
#[derive(Clone, Copy, Debug)]
enum Draw {
    DropOut,
    NoiseLength,
    NoiseAngle,
}

impl Draws {
    /// Those of the sweep that starts at `start` seconds.
    pub(crate) fn new(seed: u64, start: f64) -> Self {
        let words = [seed, start.to_bits()].map(|word| [word as u32, (word >> 32) as u32]);
        Self(words.as_flattened().iter().fold(0, |state, word| mixed(state, *word)))
    }

    /// A number in `0..1` that decides whether an echo is lost.
    pub(crate) fn drop_out(self, beam_idx: u32, echo_idx: u32) -> f64 {
        self.unit(beam_idx, echo_idx, Draw::DropOut)
    }

    /// How far the range of an echo is off, in standard deviations.
    pub(crate) fn noise(self, beam_idx: u32, echo_idx: u32) -> f64 {
        let length = self.unit(beam_idx, echo_idx, Draw::NoiseLength);
        let angle = self.unit(beam_idx, echo_idx, Draw::NoiseAngle);
        (-2.0 * length.ln()).sqrt() * (TAU * angle).cos()
    }

    /// A number between 0 and 1, and neither.
    fn unit(self, beam_idx: u32, echo_idx: u32, draw: Draw) -> f64 {
        let bits = [beam_idx, echo_idx, draw as u32].into_iter().fold(self.0, mixed);
        (f64::from(bits) + 0.5) / (f64::from(u32::MAX) + 1.0)
    }
}

fn mixed(state: u32, word: u32) -> u32 {
    hash(state.wrapping_add(0x9e37_79b9) ^ hash(word.wrapping_add(0x85eb_ca6b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_normal() {
        let draws = Draws::new(7, 0.1);
        let values: Vec<f64> = (0..100_000).map(|beam_idx| draws.noise(beam_idx, 0)).collect();
        let moment = |power| values.iter().map(|value| value.powi(power)).sum::<f64>() / 1e5;
        // Five standard errors.
        assert!(moment(1).abs() < 5.0 * 1e-5_f64.sqrt(), "{}", moment(1));
        assert!((moment(2) - 1.0).abs() < 5.0 * 2e-5_f64.sqrt(), "{}", moment(2));
        assert!((moment(4) - 3.0).abs() < 5.0 * 96e-5_f64.sqrt(), "{}", moment(4));
        let beyond_two = values.iter().filter(|value| value.abs() > 2.0).count();
        assert!((4_300..4_800).contains(&beyond_two), "{beyond_two}");
    }

    #[test]
    fn everything_counts() {
        let value = |seed, start, beam, echo| Draws::new(seed, start).drop_out(beam, echo);
        let all = [
            value(0, 0.0, 0, 0),
            value(1, 0.0, 0, 0),
            value(1 << 32, 0.0, 0, 0),
            value(0, 0.1, 0, 0),
            value(0, 0.0, 1, 0),
            value(0, 0.0, 0, 1),
            Draws::new(0, 0.0).noise(0, 0),
        ];
        for (idx, value) in all.iter().enumerate() {
            assert!(!all[..idx].contains(value), "{all:?}");
        }
        let draws = Draws::new(3, 0.0);
        let mean = (0..10_000).map(|beam| draws.drop_out(beam, 1)).sum::<f64>() / 1e4;
        assert!((mean - 0.5).abs() < 5.0 * (1.0_f64 / 12e4).sqrt(), "{mean}");
    }
}
