//! Animated WebP, lossy at high quality.

use std::fs;
use std::path::Path;

use anyhow::{Result, anyhow};
use webp_animation::{
    ColorMode, Encoder, EncoderOptions, EncodingConfig, EncodingType, LossyEncodingConfig,
};

use super::film::Reel;

/// From 0 to 100; at 90, loss is hard to see.
const QUALITY: f32 = 90.0;

/// Milliseconds: the clock of WebP.
const CLOCK_RATE: f64 = 1000.0;

/// Writes an endlessly repeating WebP.
pub(super) fn write(path: &Path, reel: &Reel<'_>) -> Result<()> {
    let encoding_config = EncodingConfig {
        encoding_type: EncodingType::Lossy(LossyEncodingConfig::default()),
        quality: QUALITY,
        method: 4,
    };
    let options = EncoderOptions {
        color_mode: ColorMode::Rgb,
        encoding_config: Some(encoding_config),
        ..EncoderOptions::default()
    };
    let dimensions = (reel.size.width, reel.size.height);
    let mut encoder =
        Encoder::new_with_options(dimensions, options).map_err(|error| explain(&error))?;
    for (idx, frame) in reel.frames.iter().enumerate() {
        encoder
            .add_frame(&reel.load(frame)?, timestamp(reel, idx)?)
            .map_err(|error| explain(&error))?;
    }
    let film =
        encoder.finalize(timestamp(reel, reel.frames.len())?).map_err(|error| explain(&error))?;
    Ok(fs::write(path, &*film)?)
}

fn timestamp(reel: &Reel<'_>, idx: usize) -> Result<i32> {
    Ok(i32::try_from(reel.start(idx, CLOCK_RATE))?)
}

fn explain(error: &webp_animation::Error) -> anyhow::Error {
    anyhow!("the WebP encoder failed: {error:?}")
}
