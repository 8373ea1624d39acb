//! From light to the numbers of a display: exposure, then sRGB or AgX, then eight bits.
//!
//! | Tone map | Use it when |
//! |---|---|
//! | [`ToneMap::Srgb`] | values should come out as they went in, and may clip (comparisons, data) |
//! | [`ToneMap::Agx`] | bright lights should fade to white as on film (pictures to look at) |

mod agx;

use std::fmt;
use std::str::FromStr;

use glam::Vec3;
use rayon::prelude::*;
use thiserror::Error;

use crate::Film;

/// How radiance becomes the brightness of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ToneMap {
    /// Clips at 1 and applies the sRGB transfer function.
    #[default]
    Srgb,
    /// Compresses sixteen stops as film does (AgX, T. Sobotka).
    Agx,
}

/// The name is not that of a tone map.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("unknown tone map \"{0}\"; there are: srgb, agx")]
pub struct UnknownToneMap(String);

impl ToneMap {
    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Srgb => "srgb",
            Self::Agx => "agx",
        }
    }

    /// The display value, `0..=1` and encoded for sRGB, of linear radiance `color`. Negative
    /// values and NaN count as 0.
    pub fn encode(self, color: Vec3) -> Vec3 {
        let color = color.max(Vec3::ZERO);
        let linear = match self {
            Self::Srgb => color,
            Self::Agx => agx::compress(color),
        };
        linear.min(Vec3::ONE).map(srgb_from_linear)
    }
}

impl fmt::Display for ToneMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for ToneMap {
    type Err = UnknownToneMap;

    fn from_str(name: &str) -> Result<Self, UnknownToneMap> {
        [Self::Srgb, Self::Agx]
            .into_iter()
            .find(|tone_map| tone_map.name() == name)
            .ok_or_else(|| UnknownToneMap(name.to_owned()))
    }
}

/// The film as red, green and blue bytes, rows from the top; three bytes a pixel.
///
/// `exposure_stops` brightens by powers of two: 1 doubles, -1 halves.
pub fn to_srgb8(film: &Film, exposure_stops: f32, tone_map: ToneMap) -> Vec<u8> {
    let exposure = exposure_stops.exp2();
    let mut bytes = vec![0; 3 * film.pixels().len()];
    let rows = film.pixels().par_chunks(ROW_PIXELS).zip(bytes.par_chunks_mut(3 * ROW_PIXELS));
    rows.for_each(|(pixels, bytes)| {
        for (pixel, bytes) in pixels.iter().zip(bytes.chunks_exact_mut(3)) {
            let display = tone_map.encode(exposure * Vec3::from(*pixel));
            bytes.copy_from_slice(&display.to_array().map(quantized));
        }
    });
    bytes
}

/// Pixels that one task encodes.
const ROW_PIXELS: usize = 1024;

fn quantized(value: f32) -> u8 {
    // The cast saturates and takes NaN to 0.
    (value * 255.0 + 0.5) as u8
}

/// The sRGB transfer function (IEC 61966-2-1) for `linear` in `0..=1`.
fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOTH: [ToneMap; 2] = [ToneMap::Srgb, ToneMap::Agx];

    #[test]
    fn srgb_has_the_values_of_the_standard() {
        for (linear, encoded) in [(0.0, 0), (0.002, 7), (0.214, 127), (0.5, 188), (1.0, 255)] {
            assert_eq!(quantized(srgb_from_linear(linear)), encoded);
        }
    }

    #[test]
    fn brighter_light_is_never_darker_on_the_display() {
        for tone_map in BOTH {
            let grey = |stop: i32| tone_map.encode(Vec3::splat((stop as f32 / 8.0).exp2()));
            for stop in -120..120 {
                let (darker, brighter) = (grey(stop), grey(stop + 1));
                assert!(brighter.cmpge(darker).all(), "{tone_map} at {stop}/8 stops");
            }
        }
    }

    #[test]
    fn exposure_is_in_stops() {
        let mut film = Film::new(1, 1);
        film.pixels_mut()[0] = [0.1, 0.2, 0.05];
        let once = to_srgb8(&film, 1.0, ToneMap::Srgb);
        film.pixels_mut()[0] = [0.2, 0.4, 0.1];
        assert_eq!(once, to_srgb8(&film, 0.0, ToneMap::Srgb));
    }

    #[test]
    fn extremes_stay_in_range() {
        for tone_map in BOTH {
            for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 0.0, f32::MAX] {
                let display = tone_map.encode(Vec3::new(value, 0.0, 1.0));
                assert!(display.cmpge(Vec3::ZERO).all() && display.cmple(Vec3::ONE).all());
            }
        }
    }

    #[test]
    fn names_round_trip() {
        for tone_map in BOTH {
            assert_eq!(tone_map.name().parse(), Ok(tone_map));
        }
        assert!("filmic".parse::<ToneMap>().is_err());
    }
}
