//! What a sweep found, for everything that tells it.

use rayflock::render::sensor::{Pattern, Sweep};

use crate::false_color::ColorScale;

/// What a sweep found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scan<'a> {
    /// The points.
    pub(super) sweep: &'a Sweep,
    /// The pattern of its beams.
    pub(super) pattern: &'a Pattern,
}

impl Scan<'_> {
    /// The colours of numbers, from the least to the most.
    pub(super) fn color_scale(values: impl Iterator<Item = f32>) -> ColorScale {
        let (least, most) = values
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(least, most), value| {
                (least.min(value), most.max(value))
            });
        match least <= most {
            true => ColorScale::new(f64::from(least), f64::from(most)),
            false => ColorScale::new(0.0, 0.0),
        }
    }
}
