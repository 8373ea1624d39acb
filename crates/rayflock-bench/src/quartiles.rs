//! The middle of a few measurements and how far they lie apart.

use serde::Serialize;

/// The quartiles of a set of measurements.
///
/// Between two measurements they are interpolated linearly (R. J. Hyndman, Y. Fan, *Sample
/// Quantiles in Statistical Packages*, The American Statistician 50(4), 1996, definition 7).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Quartiles {
    /// A quarter of the measurements lie below.
    pub lower: f64,
    /// Half of the measurements lie below.
    pub median: f64,
    /// Three quarters of the measurements lie below.
    pub upper: f64,
}

impl Quartiles {
    /// The quartiles of `values`, in any order; zero where there are none.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = values.into_iter().collect();
        sorted.sort_by(f64::total_cmp);
        let at = |share| quantile(&sorted, share);
        Self { lower: at(0.25), median: at(0.5), upper: at(0.75) }
    }

    /// Distance of the outer quartiles as a share of the median; 0 where the median is.
    pub fn spread(&self) -> f64 {
        if self.median > 0.0 { (self.upper - self.lower) / self.median } else { 0.0 }
    }
}

fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last_idx) = sorted.len().checked_sub(1) else { return 0.0 };
    let position = share * last_idx as f64;
    let below = position as usize;
    let above = (below + 1).min(last_idx);
    sorted[below] + (sorted[above] - sorted[below]) * position.fract()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_are_interpolated_between_measurements_in_any_order() {
        let quartiles = Quartiles::of([4.0, 1.0, 3.0, 2.0]);
        assert_eq!(quartiles, Quartiles { lower: 1.75, median: 2.5, upper: 3.25 });
        assert_eq!(quartiles.spread(), 0.6);
        assert_eq!(Quartiles::of([5.0, 9.0, 7.0]).median, 7.0);
    }

    #[test]
    fn one_measurement_has_no_spread_and_none_is_zero() {
        let one = Quartiles::of([8.0]);
        assert_eq!((one.lower, one.median, one.upper, one.spread()), (8.0, 8.0, 8.0, 0.0));
        assert_eq!(Quartiles::of([]), Quartiles::default());
        assert_eq!(Quartiles::default().spread(), 0.0);
    }
}
