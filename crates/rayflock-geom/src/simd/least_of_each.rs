//! The least lanes of several vectors at once.
//!
//! Vectors are interleaved two by two, and of what comes to stand side by side the lesser is kept,
//! until one vector is left.
//!
//! **Cost.** 45 operations for sixteen vectors, 24 for eight; a reduction takes some ten for one.

use super::{LANES, Simd, SimdBase, f32x16};

/// The least lane of each of eight or sixteen vectors: that of vector i stands in lane
/// `i * LANES / COUNT`.
#[inline(always)]
pub(super) fn least_of_each<S: Simd, const COUNT: usize>(
    mut vectors: [f32x16<S>; COUNT],
) -> f32x16<S> {
    let mut half = COUNT / 2;
    while half > 0 {
        for idx in 0..half {
            let (low, high) = vectors[idx].interleave(vectors[idx + half]);
            vectors[idx] = low.min(high);
        }
        half /= 2;
    }
    let mut left = LANES / COUNT;
    while left > 1 {
        let (low, high) = vectors[0].interleave(vectors[0]);
        vectors[0] = low.min(high);
        left /= 2;
    }
    vectors[0]
}

#[cfg(test)]
mod tests {
    use super::super::{SimdLevel, dispatch};
    use super::*;

    /// Every lane of every vector is the least once.
    #[test]
    fn each_vector_gives_its_least_lane() {
        for level in SimdLevel::available() {
            dispatch!(level.level(), simd => {
                for least_lane in 0..LANES {
                    let value = |idx: usize, lane: usize| {
                        let distance = (lane + LANES - (least_lane + idx) % LANES) % LANES;
                        (100 * idx + distance) as f32
                    };
                    let mut vectors = [f32x16::splat(simd, 0.0); LANES];
                    for (idx, vector) in vectors.iter_mut().enumerate() {
                        *vector = f32x16::from_fn(simd, |lane| value(idx, lane));
                    }
                    let all = least_of_each(vectors);
                    let [a, b, c, d, e, f, g, h, ..] = vectors;
                    let eight = least_of_each([a, b, c, d, e, f, g, h]);
                    for idx in 0..LANES {
                        assert_eq!(all[idx], (100 * idx) as f32, "{level}");
                        assert_eq!(eight[idx / 2 * 2], (100 * (idx / 2)) as f32, "{level}");
                    }
                }
            });
        }
    }
}
