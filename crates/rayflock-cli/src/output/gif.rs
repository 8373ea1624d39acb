//! Animated GIF.
//!
//! One palette serves the whole film, so that what stands still does not change its colour from
//! frame to frame: pixels sampled evenly from all frames are quantised in Oklab by Wu's method.
//! Frames are then dithered to it, in parallel, by Floyd-Steinberg error diffusion at part of its
//! strength: enough to hide bands, little enough not to shimmer.
//!
//! **Cost.** Every frame is read twice; one block of frames is held at a time.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use anyhow::{Result, anyhow};
use gif::{Encoder, Frame, Repeat};
use quantette::color_map::NearestNeighborColorMap;
use quantette::color_space::{oklab_to_srgb8, srgb8_to_oklab};
use quantette::deps::palette::{Oklab, Srgb};
use quantette::dither::FloydSteinberg;
use quantette::{Image, PaletteBuf, Pipeline};
use rayon::prelude::*;

use super::film::Reel;

/// Pixels that the palette is made from, over all frames.
const SAMPLE_COUNT: usize = 1 << 20;

/// Share of the error that is passed on to neighbours.
const DITHER_STRENGTH: f32 = 0.6;

/// Pixels dithered at once, in whole frames.
const BLOCK_PIXELS: usize = 1 << 24;

/// Hundredths of a second: the clock of GIF.
const CLOCK_RATE: f64 = 100.0;

/// The shortest delay that browsers honour; they take shorter ones for a tenth of a second.
const MIN_DELAY: i64 = 2;

/// Writes an endlessly repeating GIF.
pub(super) fn write(path: &Path, reel: &Reel<'_>) -> Result<()> {
    let palette = common_palette(reel)?;
    let colors: Vec<u8> = oklab_to_srgb8(&palette)
        .into_iter()
        .flat_map(|color| [color.red, color.green, color.blue])
        .collect();
    let colormap = NearestNeighborColorMap::new(palette);

    let (width, height) = (reel.size.width as u16, reel.size.height as u16);
    let mut file = BufWriter::new(File::create(path)?);
    let mut encoder = Encoder::new(&mut file, width, height, &colors)?;
    encoder.set_repeat(Repeat::Infinite)?;
    let block_len = (BLOCK_PIXELS / reel.pixel_count()).max(1);
    for (block_idx, block) in reel.frames.chunks(block_len).enumerate() {
        let frames: Result<Vec<_>> =
            block.par_iter().map(|frame| dithered(reel, frame, &colormap)).collect();
        for (idx, mut frame) in frames?.into_iter().enumerate() {
            frame.delay = delay(reel, block_idx * block_len + idx);
            encoder.write_lzw_pre_encoded_frame(&frame)?;
        }
    }
    encoder.into_inner()?;
    Ok(file.flush()?)
}

type ColorMap = NearestNeighborColorMap<Oklab, f32, 3>;

/// The palette that suits all frames together.
fn common_palette(reel: &Reel<'_>) -> Result<PaletteBuf<Oklab>> {
    let step = (reel.frames.len() * reel.pixel_count()).div_ceil(SAMPLE_COUNT);
    let samples: Result<Vec<_>> = reel
        .frames
        .par_iter()
        .map(|frame| Ok(load_colors(reel, frame)?.into_iter().step_by(step).collect::<Vec<_>>()))
        .collect();
    let samples = samples?.concat();
    Ok(Pipeline::new().input_slice(&samples)?.output_oklab_palette())
}

/// One frame as indices into the palette, compressed.
fn dithered(reel: &Reel<'_>, path: &Path, colormap: &ColorMap) -> Result<Frame<'static>> {
    let (width, height) = (reel.size.width, reel.size.height);
    let colors = srgb8_to_oklab(&load_colors(reel, path)?);
    let picture =
        Image::new(width, height, colors.as_slice()).map_err(|error| anyhow!("{error}"))?;
    let ditherer = FloydSteinberg::with_error_diffusion(DITHER_STRENGTH).unwrap_or_default();
    let (_, indices) = ditherer.dither_image_to_indexed(picture, colormap.clone()).into_parts();
    let mut frame = Frame::from_indexed_pixels(width as u16, height as u16, indices, None);
    frame.make_lzw_pre_encoded();
    Ok(frame)
}

fn load_colors(reel: &Reel<'_>, path: &Path) -> Result<Vec<Srgb<u8>>> {
    let bytes = reel.load(path)?;
    Ok(bytes.chunks_exact(3).map(|rgb| Srgb::new(rgb[0], rgb[1], rgb[2])).collect())
}

/// How long frame `idx` is shown. Frames begin at the clock tick nearest to their time, so that
/// the film keeps its pace where the rate does not divide 100.
fn delay(reel: &Reel<'_>, idx: usize) -> u16 {
    let delay = reel.start(idx + 1, CLOCK_RATE) - reel.start(idx, CLOCK_RATE);
    u16::try_from(delay.max(MIN_DELAY)).unwrap_or(u16::MAX)
}
