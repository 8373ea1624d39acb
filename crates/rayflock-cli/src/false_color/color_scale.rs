//! From numbers to colours.

use colorgrad::{BasisGradient, Gradient};

/// Colours from the least to the most: viridis, which is even to the eye, to the colour-blind
/// one too, and on paper.
#[derive(Clone, Debug)]
pub(crate) struct ColorScale {
    gradient: BasisGradient,
    least: f64,
    most: f64,
}

impl ColorScale {
    /// A scale from `least` to `most`; where they are equal, all has the middle colour.
    pub(crate) fn new(least: f64, most: f64) -> Self {
        Self { gradient: colorgrad::preset::viridis(), least, most }
    }

    /// The number at this share of the way from the least to the most.
    pub(crate) fn value_at(&self, share: f64) -> f64 {
        self.least + share * (self.most - self.least)
    }

    /// Red, green and blue in sRGB.
    pub(crate) fn srgb8(&self, value: f64) -> [u8; 3] {
        let [red, green, blue, _] = self.gradient.at(self.share(value)).to_rgba8();
        [red, green, blue]
    }

    /// Red, green and blue as linear light.
    pub(crate) fn linear(&self, value: f64) -> [f32; 3] {
        let [red, green, blue, _] = self.gradient.at(self.share(value)).to_linear_rgba();
        [red, green, blue]
    }

    fn share(&self, value: f64) -> f32 {
        let range = self.most - self.least;
        if range > 0.0 { ((value - self.least) / range).clamp(0.0, 1.0) as f32 } else { 0.5 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_run_from_dark_to_bright() {
        let scale = ColorScale::new(2.0, 6.0);
        let brightness = |value| scale.linear(value).iter().sum::<f32>();
        let steps = [2.0, 3.0, 4.0, 5.0, 6.0].map(brightness);
        assert!(steps.is_sorted() && steps[4] > 4.0 * steps[0], "{steps:?}");
        assert_eq!((scale.srgb8(-1.0), scale.srgb8(9.0)), (scale.srgb8(2.0), scale.srgb8(6.0)));
        assert_eq!([0.0, 0.5, 1.0].map(|share| scale.value_at(share)), [2.0, 4.0, 6.0]);
    }

    #[test]
    fn a_scale_without_extent_has_one_colour() {
        let scale = ColorScale::new(0.0, 0.0);
        assert_eq!(scale.srgb8(0.0), ColorScale::new(0.0, 1.0).srgb8(0.5));
    }
}
