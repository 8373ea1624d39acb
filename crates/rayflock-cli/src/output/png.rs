//! PNG.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use anyhow::{Context, Result, ensure};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

/// Writes RGB bytes, rows from the top; `rgb.len() == 3 * width * height`.
pub(super) fn write_8(path: &Path, width: u32, height: u32, rgb: &[u8]) -> Result<()> {
    encode(path, width, height, rgb, ExtendedColorType::Rgb8)
}

/// Writes 16-bit RGB values, rows from the top; `rgb.len() == 3 * width * height`.
pub(super) fn write_16(path: &Path, width: u32, height: u32, rgb: &[u16]) -> Result<()> {
    // The encoder takes the machine's byte order and turns it into that of the file.
    let bytes: Vec<u8> = rgb.iter().flat_map(|value| value.to_ne_bytes()).collect();
    encode(path, width, height, &bytes, ExtendedColorType::Rgb16)
}

/// Reads RGB bytes of a picture of the expected size.
pub(super) fn read_8(path: &Path, width: u32, height: u32) -> Result<Vec<u8>> {
    let read = || -> Result<Vec<u8>> {
        let picture = image::ImageReader::open(path)?.decode()?.into_rgb8();
        let (found_width, found_height) = picture.dimensions();
        ensure!(
            (found_width, found_height) == (width, height),
            "found a picture of {found_width}x{found_height}, expected {width}x{height}"
        );
        Ok(picture.into_raw())
    };
    read().with_context(|| format!("cannot read the frame {}", path.display()))
}

fn encode(
    path: &Path,
    width: u32,
    height: u32,
    bytes: &[u8],
    color: ExtendedColorType,
) -> Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    PngEncoder::new_with_quality(&mut file, CompressionType::Fast, FilterType::Adaptive)
        .write_image(bytes, width, height, color)?;
    Ok(file.flush()?)
}
