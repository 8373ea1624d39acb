//! One frame, one file.

use std::path::Path;

use anyhow::Result;
use glam::Vec3;
use rayflock::render::Film;
use rayflock::render::tonemap::{self, ToneMap};
use rayon::prelude::*;
use tracing::debug_span;

use super::{atomic, exr, png};

/// Formats of single pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PictureFormat {
    /// PNG, 8 bits a channel, tone-mapped sRGB.
    Png8,
    /// PNG, 16 bits a channel, tone-mapped sRGB.
    Png16,
    /// OpenEXR, 32-bit floats, linear sRGB, as the renderer left it.
    Exr,
}

impl PictureFormat {
    /// A name for messages and journals.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Png8 => "8-bit PNG",
            Self::Png16 => "16-bit PNG",
            Self::Exr => "EXR",
        }
    }
}

/// How light becomes colour on a screen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Look {
    /// Exposure in stops.
    pub(crate) exposure: f32,
    /// The curve after it.
    pub(crate) tone_map: ToneMap,
}

/// Writes `film` to `path`, whole or not at all.
pub(crate) fn write(path: &Path, format: PictureFormat, film: &Film, look: Look) -> Result<()> {
    let _span = debug_span!("write_picture").entered();
    let (width, height) = (film.width() as u32, film.height() as u32);
    atomic::write_whole(path, |partial| match format {
        PictureFormat::Png8 => {
            let rgb = tonemap::to_srgb8(film, look.exposure, look.tone_map);
            png::write_8(partial, width, height, &rgb)
        }
        PictureFormat::Png16 => png::write_16(partial, width, height, &to_srgb16(film, look)),
        PictureFormat::Exr => exr::write(partial, film),
    })
}

/// The film as in [`tonemap::to_srgb8`], with 16 bits a channel.
fn to_srgb16(film: &Film, look: Look) -> Vec<u16> {
    let exposure = look.exposure.exp2();
    let encode = |pixel: &[f32; 3]| {
        let display = look.tone_map.encode(exposure * Vec3::from(*pixel));
        display.to_array().map(|value| (value * 65535.0 + 0.5) as u16)
    };
    film.pixels().par_iter().flat_map_iter(encode).collect()
}
