//! A column of beams that turns around the sensor's +Y, clockwise as seen from above.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::Vec3;

use crate::sensor::SensorError;
use crate::sensor::beams::direction;
use crate::sensor::error::ensure_value;
use crate::sensor::layout::{Layout, Lines};

/// A column of beams that turns around once a sweep, clockwise as seen from above. Column 0 looks
/// back, so that straight ahead is in the middle of the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Spinning {
    /// The elevation of each row, in radians; the first is the top row of the picture.
    pub elevations: Vec<f64>,
    /// Columns of a revolution.
    pub columns: u32,
    /// Revolutions a second: sweeps.
    pub revolutions_per_second: f64,
}

impl Spinning {
    pub(super) fn check(&self) -> Result<(), SensorError> {
        self.elevations.iter().try_for_each(|elevation| {
            let (is_right, degrees) = (elevation.abs() <= FRAC_PI_2, elevation.to_degrees());
            ensure_value(is_right, "elevation of a row", degrees, "-90 to 90 degrees")
        })
    }

    pub(super) fn layout(&self) -> Layout {
        Layout {
            beam_count: self.elevations.len() * self.columns as usize,
            line_len: self.elevations.len(),
            lines: Lines::Columns,
            seconds: self.revolutions_per_second.recip(),
        }
    }

    pub(super) fn directions(&self) -> Vec<Vec3> {
        let column = |column: u32| {
            let azimuth = f64::from(column) / f64::from(self.columns) * TAU - PI;
            self.elevations.iter().map(move |elevation| direction(azimuth, *elevation))
        };
        (0..self.columns).flat_map(column).collect()
    }
}

/// `count` values spread evenly from `first` to `last`, both included; the middle for one.
pub fn evenly(first: f64, last: f64, count: u32) -> Vec<f64> {
    let share = |idx: u32| if count > 1 { f64::from(idx) / f64::from(count - 1) } else { 0.5 };
    (0..count).map(|idx| first + share(idx) * (last - first)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_go_from_back_over_left_ahead_and_right() {
        let elevations = vec![0.5, 0.0];
        let spinning = Spinning { elevations, columns: 4, revolutions_per_second: 10.0 };
        let directions = spinning.directions();
        let expected = [Vec3::Z, Vec3::NEG_X, Vec3::NEG_Z, Vec3::X];
        for (column, expected) in expected.into_iter().enumerate() {
            assert!((directions[2 * column + 1] - expected).length() < 1e-6, "{directions:?}");
            assert!((f64::from(directions[2 * column].y) - 0.5_f64.sin()).abs() < 1e-6);
        }
    }

    #[test]
    fn even_values_include_both_ends() {
        assert_eq!(evenly(1.0, -1.0, 3), [1.0, 0.0, -1.0]);
        assert_eq!(evenly(1.0, -1.0, 1), [0.0]);
    }
}
