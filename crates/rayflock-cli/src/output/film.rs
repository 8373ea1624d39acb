//! Finished frames become one file.
//!
//! Frames are read back from the lossless pictures that the render left, so a film is a function
//! of those alone: it does not matter whether they were rendered in one go.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::{atomic, gif, mp4, png, webp};
use crate::interrupt::Interrupt;
use crate::size::Size;

/// Formats of films.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Container {
    /// Animated GIF, one palette of 256 colours for the whole film, dithered.
    Gif,
    /// Animated WebP, lossy at high quality.
    Webp,
    /// H.264 in MP4, by way of ffmpeg.
    Mp4,
}

impl Container {
    /// The longest edge that the format can hold, in pixels.
    pub(crate) const fn max_edge(self) -> u32 {
        match self {
            Self::Webp => 16_383,
            Self::Gif | Self::Mp4 => Size::MAX_EDGE,
        }
    }
}

/// Frames on disk, ready to become a film.
#[derive(Debug)]
pub(crate) struct Reel<'a> {
    /// The paths of the frames, in order; one at least.
    pub(crate) frames: Vec<PathBuf>,
    /// The size of every frame.
    pub(crate) size: Size,
    /// Frames a second.
    pub(crate) fps: f64,
    /// Asked between frames.
    pub(crate) interrupt: &'a Interrupt,
}

impl Reel<'_> {
    /// The pixels of one frame: RGB bytes, rows from the top.
    pub(super) fn load(&self, frame: &Path) -> Result<Vec<u8>> {
        anyhow::ensure!(!self.interrupt.is_raised(), "stopped by Ctrl-C");
        png::read_8(frame, self.size.width, self.size.height)
    }

    /// Number of pixels of a frame.
    pub(super) const fn pixel_count(&self) -> usize {
        self.size.width as usize * self.size.height as usize
    }

    /// The time at which frame `idx` of the reel begins, in units of `1 / rate` seconds.
    pub(super) fn start(&self, idx: usize, rate: f64) -> i64 {
        (idx as f64 * rate / self.fps).round() as i64
    }
}

/// Writes the film, whole or not at all.
pub(crate) fn write(path: &Path, container: Container, reel: &Reel<'_>) -> Result<()> {
    atomic::write_whole(path, |partial| match container {
        Container::Gif => gif::write(partial, reel),
        Container::Webp => webp::write(partial, reel),
        Container::Mp4 => mp4::write(partial, reel),
    })
}
