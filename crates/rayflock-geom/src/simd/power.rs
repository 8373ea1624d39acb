//! Powers of numbers from 0 to 1, as highlights take of cosines, sixteen at a time.
//!
//! ```text
//!   base^exponent = 2^(exponent * log2 base)
//!   log2 (2^n m)  = n + 2 / ln 2 * (s + s^3/3 + s^5/5 + s^7/7),   s = (m - 1) / (m + 1)
//!   2^(n + r)     = 2^n * (the exponential series of r ln 2, up to the fifth power)
//! ```
//!
//! with m from the root of 1/2 to that of 2, so that s is at most 0.172, and r from -1/2 to 1/2.
//!
//! **Source.** W. J. Cody, W. Waite, *Software Manual for the Elementary Functions*, 1980, ch. 5, 6
//! and 7.
//!
//! **Departures.** Series cut off where highlights do not need more, not best approximations.
//!
//! **Invariants.** Without fused multiply-add: the same bits at every level. Off by less than 3e-5
//! of the power. (test)
//!
//! **Cost.** About 40 operations and a division.

use std::f32::consts::{LN_2, LOG2_E};

use super::{
    Bytes, Select, Simd, SimdBase, SimdCvtFloat, SimdCvtTruncate, SimdFloat, f32x16, u32x16,
};

/// The bits of the root of 1/2.
const ROOT: u32 = 0x3f35_04f3;
/// The bits of 1.
const ONE: u32 = 0x3f80_0000;
/// Bits of the fraction of a number.
const FRACTION_BITS: u32 = 23;
/// What the exponent of 1 is written as.
const BIAS: u32 = 127;
/// Powers of 2 below this one are 0.
const LEAST: f32 = -126.0;

/// `base ^ exponent` for bases from 0 to 1, others counting as the nearest of these, and exponents
/// from 0. No base but 0 has a power of exactly 0 unless that is below 2^-126.
#[inline(always)]
pub fn power<S: Simd>(simd: S, base: f32x16<S>, exponent: f32x16<S>) -> f32x16<S> {
    let zero = f32x16::splat(simd, 0.0);
    let is_nothing = base.simd_le(zero) & exponent.simd_gt(zero);
    is_nothing.select(zero, exp2(simd, exponent * log2(simd, base)))
}

/// The logarithm of a number from 0 to 1, at least -126.
#[inline(always)]
fn log2<S: Simd>(simd: S, x: f32x16<S>) -> f32x16<S> {
    let (splat, bits) = (f32x16::splat, u32x16::splat);
    let one = splat(simd, 1.0);
    let x = x.max(splat(simd, f32::MIN_POSITIVE)).min(one);

    // So many powers of two, biased, and the rest, close to 1.
    let shifted = x.bitcast::<u32x16<S>>() + bits(simd, ONE - ROOT);
    let whole = f32x16::float_from(shifted >> FRACTION_BITS) - splat(simd, BIAS as f32);
    let fraction = shifted & bits(simd, (1 << FRACTION_BITS) - 1);
    let rest: f32x16<S> = (fraction + bits(simd, ROOT)).bitcast();

    let s = (rest - one) / (rest + one);
    let squared = s * s;
    let series = splat(simd, 1.0 / 5.0) + squared * splat(simd, 1.0 / 7.0);
    let series = one + squared * (splat(simd, 1.0 / 3.0) + squared * series);
    whole + s * splat(simd, 2.0 * LOG2_E) * series
}

/// Two to a power from -infinity to 0, or to a little more.
#[inline(always)]
fn exp2<S: Simd>(simd: S, power: f32x16<S>) -> f32x16<S> {
    let splat = f32x16::splat;
    let (one, least) = (splat(simd, 1.0), splat(simd, LEAST));
    let in_range = power.max(least);
    let whole = in_range.round_ties_even();
    let y = (in_range - whole) * splat(simd, LN_2);
    let series = splat(simd, 1.0 / 24.0) + y * splat(simd, 1.0 / 120.0);
    let series = splat(simd, 0.5) + y * (splat(simd, 1.0 / 6.0) + y * series);
    let series = one + y * (one + y * series);
    let exponent = u32x16::truncate_from(whole + splat(simd, BIAS as f32));
    let scale: f32x16<S> = (exponent << FRACTION_BITS).bitcast();
    power.simd_lt(least).select(splat(simd, 0.0), scale * series)
}

#[cfg(test)]
mod tests {
    use super::super::{LANES, Lanes, SimdLevel, dispatch};
    use super::*;

    fn powers(base: &Lanes, exponent: f32) -> Lanes {
        let at_level = |level: SimdLevel| -> Lanes {
            dispatch!(level.level(), simd => {
                *power(simd, f32x16::from_slice(simd, base), f32x16::splat(simd, exponent))
            })
        };
        let found: Vec<_> = SimdLevel::available().into_iter().map(at_level).collect();
        for lanes in &found {
            assert_eq!(lanes.map(f32::to_bits), found[0].map(f32::to_bits));
        }
        found[0]
    }

    #[test]
    fn powers_are_nearly_what_they_are() {
        for exponent in [0.0, 0.3, 1.0, 2.0, 10.0, 77.0, 300.0, 10_000.0] {
            // From 0 to 1, most of them close to 1.
            for first in 0..40_u16 {
                let base: Lanes = std::array::from_fn(|lane| {
                    let share = (f32::from(first) * 16.0 + lane as f32) / 639.0;
                    1.0 - (1.0 - share).powi(3)
                });
                for (base, found) in base.iter().zip(powers(&base, exponent)) {
                    let expected = f64::from(*base).powf(f64::from(exponent));
                    let error = (f64::from(found) - expected).abs();
                    let most = 3e-5 * expected + 1e-37;
                    assert!(error <= most, "{base} to the {exponent} is {expected}, not {found}");
                }
            }
        }
    }

    #[test]
    fn bases_out_of_range_count_as_the_nearest() {
        let mut base = [2.0; LANES];
        base[1] = -1.0;
        let found = powers(&base, 8.0);
        assert_eq!((found[0], found[1]), (1.0, 0.0));
        assert_eq!(powers(&base, 0.0)[1], 1.0);
    }
}
