//! How far two pictures lie apart.

/// The difference between two pictures, over all channels of all pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageDifference {
    /// The largest absolute difference of one channel; infinite where just one side is NaN.
    pub max: f32,
    /// The mean absolute difference of a channel.
    pub mean: f64,
    /// Pixels with a channel that differs by more than the threshold.
    pub over_count: usize,
    /// The pixel with the largest difference; `None` when the pictures are equal.
    pub worst_idx: Option<usize>,
}

/// Compares two pictures of the same size, pixel by pixel in linear or display values alike.
///
/// Two NaN channels count as equal, so that two wrong pictures can be told from one.
///
/// # Panics
/// When the pictures differ in their number of pixels.
pub fn image_difference(left: &[[f32; 3]], right: &[[f32; 3]], threshold: f32) -> ImageDifference {
    assert_eq!(left.len(), right.len(), "only pictures of the same size can be compared");
    let mut found = ImageDifference { max: 0.0, mean: 0.0, over_count: 0, worst_idx: None };
    for (idx, (a, b)) in left.iter().zip(right).enumerate() {
        let by_channel = [0, 1, 2].map(|channel| channel_difference(a[channel], b[channel]));
        let worst = by_channel.into_iter().fold(0.0, f32::max);
        if worst > found.max {
            (found.max, found.worst_idx) = (worst, Some(idx));
        }
        found.over_count += usize::from(worst > threshold);
        found.mean += by_channel.into_iter().map(f64::from).sum::<f64>();
    }
    found.mean /= (3 * left.len()).max(1) as f64;
    found
}

fn channel_difference(a: f32, b: f32) -> f32 {
    match (a.is_nan(), b.is_nan()) {
        (true, true) => 0.0,
        (false, false) if a == b => 0.0,
        (false, false) => (a - b).abs(),
        _ => f32::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_and_sizes_the_differences() {
        let left = [[0.0; 3], [0.5, 0.5, 0.5], [1.0; 3]];
        let right = [[0.0; 3], [0.5, 0.75, 0.5], [0.875, 1.0, 1.0]];
        let found = image_difference(&left, &right, 0.2);
        assert_eq!((found.max, found.over_count, found.worst_idx), (0.25, 1, Some(1)));
        assert!((found.mean - 0.375 / 9.0).abs() < 1e-9);
    }

    #[test]
    fn a_nan_on_one_side_is_never_equal() {
        let (nan, zero) = ([[f32::NAN; 3]], [[0.0; 3]]);
        assert_eq!(image_difference(&nan, &zero, 1.0).max, f32::INFINITY);
        assert_eq!(image_difference(&nan, &nan, 1.0).worst_idx, None);
        assert_eq!(image_difference(&[], &[], 0.0).mean, 0.0);
    }
}
