//! The bar beside a picture that tells which colour means how much.
//!
//! ```text
//!  hours
//!  [##]- 15.67     the most
//!  [##]- 11.75
//!  [##]-  7.83     tick marks at quarters
//!  [##]-  3.92
//!  [##]-  0.00     the least
//! ```

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};
use rayflock::render::Film;

use super::ColorScale;

/// Pixels that the bar takes, with its words, at the right of the picture.
pub(crate) const WIDTH: u32 = 112;
/// The least height of a picture that has room for the words.
pub(crate) const LEAST_HEIGHT: u32 = 160;

const FONT: RasterHeight = RasterHeight::Size16;
const WEIGHT: FontWeight = FontWeight::Regular;
const FONT_HEIGHT: usize = FONT.val();
/// Pixels from the edges of the strip to the bar.
const MARGIN: usize = 14;
const BAR_WIDTH: usize = 22;
/// Where the bar begins, below the word over it.
const BAR_TOP: usize = MARGIN + 2 * FONT_HEIGHT;
const TICK_WIDTH: usize = 5;
/// Parts between tick marks.
const TICK_PARTS: usize = 4;
const INK: f32 = 0.02;

/// Draws the bar into the rightmost [`WIDTH`] pixels of `film`.
pub(crate) fn draw(film: &mut Film, scale: &ColorScale, unit: &str) {
    let left = film.width().saturating_sub(WIDTH as usize) + MARGIN;
    let height = film.height().saturating_sub(BAR_TOP + MARGIN + FONT_HEIGHT / 2).max(2);
    let share_at = |row: usize| 1.0 - row as f64 / (height - 1) as f64;
    for row in 0..height {
        let color = scale.linear(scale.value_at(share_at(row)));
        for x in left..left + BAR_WIDTH {
            put(film, (x, BAR_TOP + row), color);
        }
    }

    write(film, (left, MARGIN), unit);
    let label_left = left + BAR_WIDTH + TICK_WIDTH + 4;
    for part in 0..=TICK_PARTS {
        let row = part * (height - 1) / TICK_PARTS;
        for x in left + BAR_WIDTH..left + BAR_WIDTH + TICK_WIDTH {
            put(film, (x, BAR_TOP + row), [INK; 3]);
        }
        let share = 1.0 - part as f64 / TICK_PARTS as f64;
        let top = (BAR_TOP + row).saturating_sub(FONT_HEIGHT / 2);
        write(film, (label_left, top), &label(scale.value_at(share)));
    }
}

/// A number in seven characters at most, up to a million.
fn label(value: f64) -> String {
    match value {
        ..100.0 => format!("{value:.2}"),
        ..1000.0 => format!("{value:.1}"),
        _ => format!("{value:.0}"),
    }
}

/// Writes `text` with its upper left corner at a pixel; characters that the font lacks leave a gap.
fn write(film: &mut Film, (left, top): (usize, usize), text: &str) {
    let advance = get_raster_width(WEIGHT, FONT);
    for (place, character) in text.chars().enumerate() {
        let Some(raster) = get_raster(character, WEIGHT, FONT) else { continue };
        for (y, row) in raster.raster().iter().enumerate() {
            for (x, coverage) in row.iter().enumerate() {
                let at = (left + place * advance + x, top + y);
                ink(film, at, f32::from(*coverage) / 255.0);
            }
        }
    }
}

/// Covers a share of a pixel with ink.
fn ink(film: &mut Film, at: (usize, usize), coverage: f32) {
    if coverage > 0.0 && at.0 < film.width() && at.1 < film.height() {
        let below = film.pixel(at.0, at.1);
        put(film, at, below.map(|value| value + coverage * (INK - value)));
    }
}

/// Sets a pixel, if the film has it.
fn put(film: &mut Film, (x, y): (usize, usize), color: [f32; 3]) {
    let width = film.width();
    if x < width && y < film.height() {
        film.pixels_mut()[y * width + x] = color;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_fit_beside_the_bar() {
        let room = WIDTH as usize - MARGIN - BAR_WIDTH - TICK_WIDTH - 4;
        for value in [0.0, 9.994, 15.67, 99.999, 365.25, 999.99, 4383.0, 999_999.0] {
            let text = label(value);
            assert!(text.len() * get_raster_width(WEIGHT, FONT) <= room, "{text}");
        }
    }

    #[test]
    fn the_bar_is_bright_at_the_top_and_leaves_the_scene_alone() {
        let mut film = Film::new(300, LEAST_HEIGHT as usize);
        draw(&mut film, &ColorScale::new(0.0, 8.0), "hours");
        let scene_width = film.width() - WIDTH as usize;
        for y in 0..film.height() {
            assert!((0..scene_width).all(|x| film.pixel(x, y) == [0.0; 3]));
        }
        let bar = scene_width + MARGIN + BAR_WIDTH / 2;
        let scale = ColorScale::new(0.0, 8.0);
        assert_eq!(film.pixel(bar, BAR_TOP), scale.linear(8.0));
        let bottom = (0..film.height()).rev().find(|y| film.pixel(bar, *y) != [0.0; 3]);
        assert_eq!(bottom.map(|y| film.pixel(bar, y)), Some(scale.linear(0.0)));
    }
}
