//! What a sweep saw, in false colours.

use std::path::Path;

use anyhow::{Result, bail, ensure};
use glam::Vec3;
use rayflock::render::Film;
use rayflock::render::sensor::{Pattern, Rosette, Sweep};
use rayflock::render::tonemap::ToneMap;

use super::output::sweep_names;
use super::scan::Scan;
use crate::args::Shown;
use crate::false_color::{ColorScale, color_bar};
use crate::frames::FrameRange;
use crate::output::{FrameNames, Look, PictureFormat, picture};
use crate::size::Size;

/// Where nothing came back, and beside the colour bar.
const PAPER: [f32; 3] = [0.9; 3];
/// Rows that a picture has at least, if nobody says how many.
const LEAST_ROWS: u32 = 256;
/// Columns that it has at most then.
const MOST_COLUMNS: u32 = 1024;

/// A picture to be drawn of each sweep.
#[derive(Clone, Debug)]
pub(super) struct PlannedPicture {
    /// Where pictures go.
    pub(super) names: FrameNames,
    shown: Shown,
    /// The part that shows the beams; the colour bar is at the right of that.
    scene_size: Size,
}

impl PlannedPicture {
    /// A picture of `size` pixels, or as many as suit the pattern.
    pub(super) fn new(
        path: &Path,
        sweeps: FrameRange,
        shown: Shown,
        size: Option<Size>,
        pattern: &Pattern,
    ) -> Result<Self> {
        if path.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("png")) {
            bail!("cannot draw \"{}\": expected a .png file", path.display());
        }
        let scene_size = match size {
            Some(size) => scene_size(size)?,
            None => usual_size(pattern),
        };
        Ok(Self { names: sweep_names(path, sweeps), shown, scene_size })
    }

    /// Draws a sweep.
    pub(super) fn write(&self, sweep: u32, scan: &Scan<'_>) -> Result<()> {
        let points = scan.sweep;
        let value = |idx: usize| match self.shown {
            Shown::Range => points.range[idx],
            Shown::Depth => points.depth(idx),
            Shown::Intensity => points.intensity[idx],
        };
        let scale = Scan::color_scale((0..points.len()).map(value));
        let Size { width, height } = self.scene_size;
        let mut film = Film::new((width + color_bar::WIDTH) as usize, height as usize);
        film.pixels_mut().fill(PAPER);
        match scan.pattern {
            Pattern::Rosette(rosette) => self.draw_dots(&mut film, rosette, points, &scale, value),
            pattern => self.draw_cells(&mut film, pattern.shape(), points, &scale, value),
        }
        let unit = match self.shown {
            Shown::Range => "range",
            Shown::Depth => "depth",
            Shown::Intensity => "intensity",
        };
        color_bar::draw(&mut film, &scale, unit);
        let look = Look { exposure: 0.0, tone_map: ToneMap::Srgb };
        picture::write(&self.names.path(sweep), PictureFormat::Png8, &film, look)
    }

    /// Draws a beam as a cell at its row and column.
    fn draw_cells(
        &self,
        film: &mut Film,
        (rows, columns): (usize, usize),
        points: &Sweep,
        scale: &ColorScale,
        value: impl Fn(usize) -> f32,
    ) {
        let color = |idx| scale.linear(f64::from(value(idx)));
        let cells = points.picture((rows, columns), PAPER, color);
        let (width, height) = (self.scene_size.width as usize, self.scene_size.height as usize);
        let film_width = film.width();
        for (y, pixels) in film.pixels_mut().chunks_exact_mut(film_width).enumerate() {
            let first = y * rows / height * columns;
            for (x, pixel) in pixels.iter_mut().enumerate().take(width) {
                *pixel = cells[first + x * columns / width];
            }
        }
    }

    /// Draws a beam as a dot at its angle and in its direction from the middle.
    fn draw_dots(
        &self,
        film: &mut Film,
        rosette: &Rosette,
        points: &Sweep,
        scale: &ColorScale,
        value: impl Fn(usize) -> f32,
    ) {
        let (width, height) = (self.scene_size.width as usize, self.scene_size.height as usize);
        let pixels_per_radian = width.min(height) as f32 / rosette.field() as f32;
        let (film_width, pixels) = (film.width(), film.pixels_mut());
        for (idx, position) in points.position_in_sensor.iter().enumerate() {
            let angle = position.angle_between(Vec3::NEG_Z) * pixels_per_radian;
            let aside = position.truncate().normalize_or_zero() * angle;
            let (x, y) = (0.5 * width as f32 + aside.x, 0.5 * height as f32 - aside.y);
            // The casts take what is out of range to the nearest pixel, which is near.
            let (x, y) = ((x as usize).min(width - 1), (y as usize).min(height - 1));
            pixels[y * film_width + x] = scale.linear(f64::from(value(idx)));
        }
    }
}

/// What a picture of `size` leaves beside the colour bar.
fn scene_size(size: Size) -> Result<Size> {
    let [least_width, least_height] = [2 * color_bar::WIDTH, color_bar::LEAST_HEIGHT];
    ensure!(
        size.width >= least_width && size.height >= least_height,
        "--picture-size {size} has no room for the colour bar, expected \
         {least_width}x{least_height} at least"
    );
    Ok(Size { width: size.width - color_bar::WIDTH, height: size.height })
}

/// Whole pixels for a beam where there is room for them.
fn usual_size(pattern: &Pattern) -> Size {
    let (rows, columns) = match pattern {
        Pattern::Rosette(_) => return Size { width: 512, height: 512 },
        pattern => pattern.shape(),
    };
    let [rows, columns] = [rows, columns].map(|count| u32::try_from(count).unwrap_or(u32::MAX));
    let across = (MOST_COLUMNS / columns.max(1)).max(1);
    let down = match columns > rows {
        true => LEAST_ROWS.div_ceil(rows.max(1)).max(1),
        false => across,
    };
    Size {
        width: columns
            .saturating_mul(across)
            .clamp(color_bar::WIDTH, Size::MAX_EDGE - color_bar::WIDTH),
        height: rows.saturating_mul(down).clamp(color_bar::LEAST_HEIGHT, Size::MAX_EDGE),
    }
}
