//! Where the beams of a sweep go, in the sensor's frame.

use glam::{DVec3, Vec3};

/// The beams of a sweep, line by line, in the sensor's frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Beams {
    /// From the sensor's origin, in these unit directions.
    FromPoint(Vec<Vec3>),
    /// Along -Z, from these points.
    Parallel(Vec<Vec3>),
}

impl Beams {
    /// The start and the unit direction of a beam.
    pub(crate) fn get(&self, beam_idx: usize) -> (Vec3, Vec3) {
        match self {
            Self::FromPoint(directions) => (Vec3::ZERO, directions[beam_idx]),
            Self::Parallel(origins) => (origins[beam_idx], Vec3::NEG_Z),
        }
    }
}

/// The direction at an azimuth, to the right of straight ahead, and an elevation, in radians.
pub(crate) fn direction(azimuth: f64, elevation: f64) -> Vec3 {
    let (sin, cos) = azimuth.sin_cos();
    let level = elevation.cos();
    DVec3::new(level * sin, elevation.sin(), -level * cos).as_vec3()
}

/// The middle of cell `idx` of `count` equal cells, from -0.5 to 0.5.
pub(crate) fn cell_middle(idx: u32, count: u32) -> f64 {
    (f64::from(idx) + 0.5) / f64::from(count) - 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn azimuths_turn_right_and_elevations_up() {
        use std::f64::consts::FRAC_PI_2;
        let near = |found: Vec3, expected: Vec3| (found - expected).length() < 1e-7;
        assert!(near(direction(0.0, 0.0), Vec3::NEG_Z));
        assert!(near(direction(FRAC_PI_2, 0.0), Vec3::X));
        assert!(near(direction(1.0, FRAC_PI_2), Vec3::Y));
        assert_eq!([0, 1].map(|idx| cell_middle(idx, 2)), [-0.25, 0.25]);
    }
}
