//! How a wave is cut into runs, which are shaded in parallel.

use std::ops::Range;

use rayon::prelude::*;

use super::RUN;
use crate::wave::{Path, ShadedRun, Wave};

/// Empties all runs and has `shade` fill each from its rays of the wave, in parallel. Runs beyond
/// the wave, which are kept for longer ones, get no rays.
pub(crate) fn begin_runs(
    wave: &Wave,
    runs: &mut Vec<ShadedRun>,
    shade: impl Fn(Range<usize>, &mut ShadedRun) + Sync,
) {
    runs.resize_with(wave.len().div_ceil(RUN).max(runs.len()), ShadedRun::default);
    runs.par_iter_mut().enumerate().for_each(|(run_idx, run)| {
        run.clear(wave.bounce);
        let rays = rays_of(run_idx, wave);
        run.pixels = pixels_of(&wave.paths[rays.clone()]);
        shade(rays, run);
    });
}

/// The rays of a run.
pub(crate) fn rays_of(run_idx: usize, wave: &Wave) -> Range<usize> {
    let start = (run_idx * RUN).min(wave.len());
    start..(start + RUN).min(wave.len())
}

/// From the first to the last pixel of `paths`.
fn pixels_of(paths: &[Path]) -> Range<usize> {
    let pixels = paths.iter().map(|path| path.pixel_idx as usize);
    let (first, last) =
        pixels.fold((usize::MAX, 0), |(first, last), pixel| (first.min(pixel), last.max(pixel)));
    if paths.is_empty() { 0..0 } else { first..last + 1 }
}
