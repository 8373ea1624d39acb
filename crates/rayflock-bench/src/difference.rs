//! How much two pictures differ, to the eye and in radiance.
//!
//! **Source.** P. Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", HPG 2020,
//! by the authors' code.

use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool, flip};
use rayflock::render::Film;
use rayflock::render::tonemap::{ToneMap, to_srgb8};

/// How one picture differs from another.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Difference {
    /// Mean of FLIP over the pixels of the pictures as they are shown, from 0 to 1.
    pub mean_flip: f64,
    /// Root mean squared error of the radiance over its root mean square.
    pub relative_rmse: f64,
}

/// How `film` differs from a `reference` of the same size, shown as the program shows pictures
/// without further options.
pub fn difference(film: &Film, reference: &Film) -> Difference {
    if film.pixels().is_empty() {
        return Difference::default();
    }
    let values = |film: &Film| {
        film.pixels().as_flattened().iter().map(|&value| f64::from(value)).collect::<Vec<f64>>()
    };
    let (found, expected) = (values(film), values(reference));
    let squared: f64 = found.iter().zip(&expected).map(|(a, b)| (a - b) * (a - b)).sum();
    let scale: f64 = expected.iter().map(|value| value * value).sum();
    let relative_rmse = if squared > 0.0 { (squared / scale).sqrt() } else { 0.0 };
    let map = flip(shown(reference), shown(film), DEFAULT_PIXELS_PER_DEGREE);
    Difference { mean_flip: f64::from(FlipPool::from_image(&map).mean()), relative_rmse }
}

fn shown(film: &Film) -> FlipImageRgb8 {
    let bytes = to_srgb8(film, 0.0, ToneMap::Agx);
    FlipImageRgb8::with_data(film.width() as u32, film.height() as u32, &bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_picture_does_not_differ_and_a_darker_one_does() {
        let film = |grey: f32| {
            let mut film = Film::new(16, 12);
            film.pixels_mut().fill([grey; 3]);
            film
        };
        assert_eq!(difference(&film(0.5), &film(0.5)), Difference::default());
        let darker = difference(&film(0.4), &film(0.5));
        assert!((darker.relative_rmse - 0.2).abs() < 1e-6);
        let dark = difference(&film(0.0), &film(0.5));
        assert!(darker.mean_flip > 0.0 && dark.mean_flip > 2.0 * darker.mean_flip, "{dark:?}");
    }
}
