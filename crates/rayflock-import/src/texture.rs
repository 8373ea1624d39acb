//! Images: decoded within bounds, and made linear.
//!
//! A PNG can unfold to a thousand times its size and both headers can claim any size, so an image
//! may have [`LARGEST_SIDE`] pixels a side and, whatever it claims, [`RATIO_LIMIT`] times as many
//! bytes as its file plus [`BASE_LIMIT`]. All images of an import together may have
//! [`PIXEL_LIMIT`] pixels.

use std::io::Cursor;
use std::sync::Arc;

use glam::Vec3;
use image::{ImageReader, Limits, RgbImage};
use rayflock_scene::Texture;

/// Largest width and height in pixels.
const LARGEST_SIDE: u32 = 8192;
/// Decoded bytes for each byte of the file: what deflate reaches at most.
const RATIO_LIMIT: u64 = 1032;
/// Decoded bytes that any file may have: 1 MiB.
const BASE_LIMIT: u64 = 1 << 20;
/// Pixels of all images of an import: as textures they take 1.5 GiB.
pub(crate) const PIXEL_LIMIT: u64 = 1 << 27;
/// Bytes that a decoder may allocate: 1 GiB.
const DECODER_LIMIT: u64 = 1 << 30;

/// Decodes a PNG, JPEG or PNM (which PPM is), or says why it cannot be read. Takes its pixels from `pixels_left`.
pub(crate) fn decode(bytes: &[u8], pixels_left: &mut u64) -> Result<RgbImage, String> {
    let reader = || {
        let mut reader = ImageReader::new(Cursor::new(bytes))
            .with_guessed_format()
            .map_err(|error| error.to_string())?;
        let mut limits = Limits::default();
        limits.max_image_width = Some(LARGEST_SIDE);
        limits.max_image_height = Some(LARGEST_SIDE);
        limits.max_alloc = Some(DECODER_LIMIT);
        reader.limits(limits);
        if reader.format().is_none() {
            return Err("found no PNG, JPEG or PNM".to_owned());
        }
        Ok(reader)
    };
    let (width, height) = reader()?.into_dimensions().map_err(|error| error.to_string())?;
    let limit = BASE_LIMIT + RATIO_LIMIT * bytes.len() as u64;
    let pixel_count = u64::from(width) * u64::from(height);
    if pixel_count == 0 || pixel_count * 3 > limit {
        return Err(format!("{width} x {height} pixels in {} bytes", bytes.len()));
    }
    *pixels_left = pixels_left.checked_sub(pixel_count).ok_or_else(|| {
        format!("{width} x {height} pixels, more than all images together may have")
    })?;
    Ok(reader()?.decode().map_err(|error| error.to_string())?.into_rgb8())
}

/// The image as a texture in linear sRGB.
pub(crate) fn texture(name: String, image: &RgbImage) -> Texture {
    let table: Vec<f32> = (0..=255_u8).map(|code| linear(f32::from(code) / 255.0)).collect();
    let texels: Arc<[[f32; 3]]> =
        image.pixels().map(|pixel| pixel.0.map(|code| table[usize::from(code)])).collect();
    Texture { name, width: image.width() as usize, height: image.height() as usize, texels }
}

/// The mean of each channel as stored, 0 to 1.
pub(crate) fn mean(image: &RgbImage) -> Vec3 {
    let mut sums = [0_u64; 3];
    for pixel in image.pixels() {
        sums.iter_mut().zip(pixel.0).for_each(|(sum, code)| *sum += u64::from(code));
    }
    let pixel_count = u64::from(image.width()) * u64::from(image.height());
    Vec3::from(sums.map(|sum| sum as f32 / (pixel_count as f32 * 255.0)))
}

/// Linear sRGB from encoded sRGB, both 0 to 1 (IEC 61966-2-1).
pub(crate) fn linear(encoded: f32) -> f32 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
pub(crate) mod tests {
    use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};

    use super::*;

    /// A PNG of one colour.
    pub(crate) fn png(width: u32, height: u32, color: [u8; 3]) -> Vec<u8> {
        let pixels: Vec<u8> = color.repeat((width * height) as usize);
        let mut bytes = Vec::new();
        PngEncoder::new(&mut bytes)
            .write_image(&pixels, width, height, ExtendedColorType::Rgb8)
            .unwrap();
        bytes
    }

    #[test]
    fn texels_become_linear() {
        let image = decode(&png(2, 1, [255, 0, 188]), &mut { PIXEL_LIMIT }).unwrap();
        let texture = texture("a".into(), &image);
        assert_eq!((texture.width, texture.height, texture.texels.len()), (2, 1, 2));
        let [r, g, b] = texture.texels[0];
        assert_eq!((r, g), (1.0, 0.0));
        assert!((b - 0.502_886).abs() < 1e-4, "{b}");
        assert!(mean(&image).abs_diff_eq(Vec3::new(1.0, 0.0, 188.0 / 255.0), 1e-6));
    }

    #[test]
    fn wrong_images_say_why() {
        assert_eq!(
            decode(b"garbage", &mut { PIXEL_LIMIT }).unwrap_err(),
            "found no PNG, JPEG or PNM"
        );
        let whole = png(64, 64, [1, 2, 3]);
        assert!(decode(&whole[..whole.len() / 2], &mut { PIXEL_LIMIT }).is_err());
    }

    #[test]
    fn a_header_that_claims_too_much_is_refused() {
        // The IHDR of a PNG of 8000 x 8000 pixels with nothing behind it.
        let mut claims = png(1, 1, [0; 3]);
        claims[16..20].copy_from_slice(&8000_u32.to_be_bytes());
        claims[20..24].copy_from_slice(&8000_u32.to_be_bytes());
        assert!(decode(&claims, &mut { PIXEL_LIMIT }).is_err());
        assert!(decode(&png(8193, 1, [0; 3]), &mut { PIXEL_LIMIT }).is_err());
    }

    #[test]
    fn images_share_a_limit() {
        let mut left = 10;
        assert!(decode(&png(3, 3, [0; 3]), &mut left).is_ok());
        assert_eq!(left, 1);
        assert!(decode(&png(2, 1, [0; 3]), &mut left).unwrap_err().contains("together"));
    }
}
