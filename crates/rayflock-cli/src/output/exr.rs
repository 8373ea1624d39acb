//! OpenEXR: 32-bit floats, linear sRGB, without exposure or tone map.

use std::path::Path;

use anyhow::Result;
use rayflock::render::Film;

/// Writes the light of `film`.
pub(super) fn write(path: &Path, film: &Film) -> Result<()> {
    let (width, height, pixels) = (film.width(), film.height(), film.pixels());
    exr::prelude::write_rgb_file(path, width, height, |x, y| {
        let [red, green, blue] = pixels[y * width + x];
        (red, green, blue)
    })?;
    Ok(())
}
