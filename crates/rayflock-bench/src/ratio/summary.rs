//! Many ratios in a few numbers.

/// What many ratios say together.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// The geometric mean; `None` where there are no ratios.
    pub mean: Option<f64>,
    /// The least.
    pub least: Option<f64>,
    /// The greatest.
    pub most: Option<f64>,
    /// Ratios of 1 and above.
    pub ahead: usize,
    /// Ratios below 1.
    pub behind: usize,
    /// Where there is no ratio, because a cell was skipped.
    pub skipped: usize,
}

impl Summary {
    /// Summarizes ratios, which are positive.
    pub fn of(ratios: impl Iterator<Item = Option<f64>>) -> Self {
        let all: Vec<Option<f64>> = ratios.collect();
        let present: Vec<f64> = all.iter().copied().flatten().collect();
        let ahead = present.iter().filter(|&&ratio| ratio >= 1.0).count();
        Self {
            mean: geometric_mean(&present),
            least: present.iter().copied().reduce(f64::min),
            most: present.iter().copied().reduce(f64::max),
            ahead,
            behind: present.len() - ahead,
            skipped: all.len() - present.len(),
        }
    }
}

/// The geometric mean of positive numbers; `None` where there are none.
pub fn geometric_mean(values: &[f64]) -> Option<f64> {
    let logarithms: f64 = values.iter().map(|value| value.ln()).sum();
    (!values.is_empty()).then(|| (logarithms / values.len() as f64).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twice_and_half_cancel_out() {
        assert_eq!(geometric_mean(&[2.0, 0.5]), Some(1.0));
        assert!((geometric_mean(&[1.0, 10.0, 100.0]).unwrap() - 10.0).abs() < 1e-12);
        assert_eq!(geometric_mean(&[]), None);
    }

    #[test]
    fn nothing_has_no_mean_and_no_extremes() {
        let summary = Summary::of([None, None].into_iter());
        assert_eq!(summary, Summary { skipped: 2, ..Summary::default() });
    }
}
