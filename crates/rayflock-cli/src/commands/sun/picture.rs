//! The scene in false colours.

use std::path::PathBuf;

use anyhow::Result;
use glam::Vec3;
use rayflock::render::sun::{Seen, SunMeter};
use rayflock::render::tonemap::ToneMap;
use rayflock::render::{Film, View};

use super::hours::SunHours;
use crate::false_color::{ColorScale, color_bar};
use crate::output::{Look, PictureFormat, picture};
use crate::plan::PlannedCamera;
use crate::size::Size;

/// Rays through each pixel, for smooth edges.
const SAMPLES_PER_PIXEL: u32 = 4;
/// What lies behind the scene, and beside the colour bar.
const PAPER: Vec3 = Vec3::splat(0.9);
/// What has no hours.
const UNMEASURED: Vec3 = Vec3::splat(0.4);

/// A picture to be drawn.
#[derive(Debug)]
pub(super) struct PlannedPicture {
    /// Where it goes.
    pub(super) path: PathBuf,
    /// The part of it that shows the scene; the colour bar is at the right of that.
    pub(super) scene_size: Size,
    /// Where the scene is seen from.
    pub(super) camera: PlannedCamera,
}

/// Draws the hours on what `meter` holds, as seen from `view`.
pub(super) fn write(
    planned: &PlannedPicture,
    view: &View,
    meter: &mut SunMeter,
    hours: &SunHours<'_>,
) -> Result<()> {
    let scale = hours.color_scale();
    let Size { width, height } = planned.scene_size;
    let colors = scene_colors(meter, view, planned.scene_size, &scale, hours.hours_per_second);

    let mut film = Film::new((width + color_bar::WIDTH) as usize, height as usize);
    film.pixels_mut().fill(PAPER.to_array());
    let film_width = film.width();
    let rows = film.pixels_mut().chunks_exact_mut(film_width);
    for (row, colors) in rows.zip(colors.chunks_exact(width as usize)) {
        for (pixel, color) in row.iter_mut().zip(colors) {
            *pixel = color.to_array();
        }
    }
    color_bar::draw(&mut film, &scale, hours.unit());
    let look = Look { exposure: 0.0, tone_map: ToneMap::Srgb };
    picture::write(&planned.path, PictureFormat::Png8, &film, look)
}

/// The colours of the scene as linear light, rows from the top.
fn scene_colors(
    meter: &mut SunMeter,
    view: &View,
    size: Size,
    scale: &ColorScale,
    hours_per_second: f64,
) -> Vec<Vec3> {
    let (width, height) = (size.width as usize, size.height as usize);
    let mut colors = vec![Vec3::ZERO; width * height];
    for sample_idx in 0..SAMPLES_PER_PIXEL {
        let seen = meter.see(view, (width, height), sample_idx);
        for (color, seen) in colors.iter_mut().zip(seen) {
            *color += match seen {
                Seen::Nothing => PAPER,
                Seen::Unmeasured => UNMEASURED,
                Seen::Seconds(seconds) => Vec3::from(scale.linear(seconds * hours_per_second)),
            };
        }
    }
    colors.iter_mut().for_each(|color| *color /= SAMPLES_PER_PIXEL as f32);
    colors
}
