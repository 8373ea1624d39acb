//! The rosette of a beam that two turning prisms bend.
//!
//! Each prism bends the beam by a fixed angle, in a direction that turns with it; for small angles
//! the bends add up as vectors. Where the two rates have no common measure the curve never closes,
//! and sweeps see what those before have missed.
//!
//! **Source**: G. F. Marshall, *Risley Prism Scan Patterns*, Proc. SPIE 3787, 1999; Z. Liu,
//! F. Zhang, X. Hong, *Low-Cost Retina-Like Robotic Lidars Based on Incommensurable Scanning*,
//! IEEE/ASME Transactions on Mechatronics 27(1), 2022.
//!
//! **Departures**: bends add up to the first order, also where they are large.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3, Vec3};

use super::check_field;
use crate::sensor::SensorError;
use crate::sensor::error::ensure_value;
use crate::sensor::layout::{Layout, Lines};

/// A single beam, bent by two turning prisms around straight ahead.
#[derive(Clone, Debug, PartialEq)]
pub struct Rosette {
    /// Beams a sweep, equally spaced in time.
    pub beams: u32,
    /// Sweeps a second.
    pub rate: f64,
    /// By how much each prism bends the beam, in radians.
    pub bends: [f64; 2],
    /// Turns of each prism a second; negative the other way.
    pub turns: [f64; 2],
}

impl Rosette {
    /// Beams that count as fired together.
    pub const BURST: u32 = 64;

    /// The angle between opposite edges of what the beam reaches, in radians.
    pub fn field(&self) -> f64 {
        2.0 * self.bends.iter().sum::<f64>()
    }

    pub(super) fn check(&self) -> Result<(), SensorError> {
        let is_right = self.bends.iter().all(|bend| *bend >= 0.0);
        ensure_value(is_right, "bend of a prism", format!("{:?}", self.bends), "0 or more")?;
        check_field([self.field(); 2], [170.0; 2])?;
        let is_right = self.turns.iter().all(|turns| turns.is_finite());
        let found = format!("{:?}", self.turns);
        ensure_value(is_right, "turns of the prisms a second", found, "finite numbers")
    }

    pub(super) fn layout(&self) -> Layout {
        Layout {
            beam_count: self.beams as usize,
            line_len: Self::BURST as usize,
            lines: Lines::Bursts,
            seconds: self.rate.recip(),
        }
    }

    pub(super) fn directions(&self, start: f64) -> Vec<Vec3> {
        let spacing = (self.rate * f64::from(self.beams)).recip();
        (0..self.beams).map(|idx| self.direction(start + f64::from(idx) * spacing)).collect()
    }

    /// Where the beam goes at a time.
    fn direction(&self, time: f64) -> Vec3 {
        let bend = |prism: usize| {
            self.bends[prism] * DVec2::from_angle(TAU * (self.turns[prism] * time).fract())
        };
        let bent = bend(0) + bend(1);
        let angle = bent.length();
        let aside = bent.normalize_or_zero() * angle.sin();
        DVec3::new(aside.x, aside.y, -angle.cos()).as_vec3()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROSETTE: Rosette =
        Rosette { beams: 4000, rate: 10.0, bends: [0.25, 0.25], turns: [97.0, -59.9] };

    #[test]
    fn beams_fill_a_cone_and_none_leaves_it() {
        let directions = ROSETTE.directions(0.0);
        let angles: Vec<f32> = directions.iter().map(|to| to.angle_between(Vec3::NEG_Z)).collect();
        assert!(angles.iter().all(|angle| *angle < 0.5 + 1e-3));
        assert!(angles.iter().any(|angle| *angle > 0.499));
        assert!(angles.iter().any(|angle| *angle < 0.01));
        assert!(directions.iter().all(|to| (to.length() - 1.0).abs() < 1e-6));
    }

    #[test]
    fn the_next_sweep_goes_elsewhere() {
        let [first, second] = [0.0, 0.1].map(|start| ROSETTE.directions(start));
        let apart = first.iter().zip(&second).map(|(a, b)| a.distance(*b));
        assert!(apart.sum::<f32>() / 4000.0 > 0.05);
    }
}
