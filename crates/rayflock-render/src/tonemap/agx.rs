//! AgX: a picture formation that compresses sixteen stops and lets bright colours fade to white.
//!
//! The primaries are drawn inward (inset), each channel is compressed by a sigmoid over its
//! logarithm, and the primaries are drawn out again.
//!
//! **Source**: T. J. Sobotka, *AgX* (2022), for the method, the inset and the range of 10 stops
//! below and 6.5 above middle grey; the sigmoid is J. Smith's, as Sobotka publishes it. The inset
//! for sRGB primaries is the one in B. Wrensch, *Minimal AgX Implementation* (2022).
//!
//! **Departures**: the sigmoid is evaluated as such, with slope 2 at the pivot and power 3 on
//! both sides, where Wrensch fits a polynomial to it (they differ by less than 0.005); the outset
//! is the exact inverse of the inset.

use glam::{Mat3, Vec3};

/// Draws sRGB primaries inward; rows sum to 1, so greys stay grey.
const INSET: Mat3 = Mat3::from_cols(
    Vec3::new(0.842_479_06, 0.042_328_242, 0.042_375_655),
    Vec3::new(0.078_433_6, 0.878_468_64, 0.078_433_6),
    Vec3::new(0.079_223_745, 0.079_166_13, 0.879_143),
);
const MIDDLE_GREY: f32 = 0.18;
const STOPS_BELOW: f32 = 10.0;
const STOPS_ABOVE: f32 = 6.5;
/// Where middle grey lies in the range of stops, and on the display.
const PIVOT: (f32, f32) = (STOPS_BELOW / (STOPS_BELOW + STOPS_ABOVE), 0.5);
const SLOPE: f32 = 2.0;
/// The gamma of the display that the sigmoid is made for.
const DISPLAY_GAMMA: f32 = 2.2;

/// Linear display light in `0..=1` for linear radiance that is not negative.
pub(super) fn compress(color: Vec3) -> Vec3 {
    let stops = (INSET * color.min(Vec3::splat(f32::MAX / 4.0))).map(|c| (c / MIDDLE_GREY).log2());
    let position = (stops + STOPS_BELOW) / (STOPS_BELOW + STOPS_ABOVE);
    let compressed = position.clamp(Vec3::ZERO, Vec3::ONE).map(sigmoid);
    let outset = INSET.inverse() * compressed;
    outset.clamp(Vec3::ZERO, Vec3::ONE).map(|c| c.powf(DISPLAY_GAMMA))
}

/// A curve through (0, 0), the pivot, and (1, 1).
fn sigmoid(x: f32) -> f32 {
    let (pivot_x, pivot_y) = PIVOT;
    if x < pivot_x {
        pivot_y - branch(pivot_x - x, pivot_x, pivot_y)
    } else {
        pivot_y + branch(x - pivot_x, 1.0 - pivot_x, 1.0 - pivot_y)
    }
}

/// One half of the curve: leaves the pivot with `SLOPE` and has risen by `height` after `width`.
fn branch(x: f32, width: f32, height: f32) -> f32 {
    let inverse_cube = |value: f32| 1.0 / (value * value * value);
    let scale = (inverse_cube(height) - inverse_cube(SLOPE * width)).cbrt().recip();
    let t = SLOPE * x / scale;
    scale * t / (1.0 + t * t * t).cbrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sigmoid_meets_its_three_points() {
        for (x, y) in [(0.0, 0.0), (PIVOT.0, PIVOT.1), (1.0, 1.0)] {
            assert!((sigmoid(x) - y).abs() < 1e-5);
        }
    }

    #[test]
    fn greys_stay_grey_and_bright_colours_fade() {
        let grey = compress(Vec3::splat(0.18));
        assert!((grey - Vec3::splat(0.5_f32.powf(DISPLAY_GAMMA))).abs().max_element() < 1e-3);
        let saturation = |c: Vec3| (c.max_element() - c.min_element()) / c.max_element();
        let red = Vec3::new(1.0, 0.02, 0.02);
        assert!(saturation(compress(red)) > 0.8);
        assert!(saturation(compress(100.0 * red)) < 0.3);
    }
}
