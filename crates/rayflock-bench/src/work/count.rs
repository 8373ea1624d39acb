//! Counts as people write them: `64K`.

use crate::BenchError;

/// Reads a count: a whole number above 0, where `K` stands for 1024 and `M` for 1024 times 1024.
///
/// # Errors
/// [`BenchError::Count`] when it is anything else or too large to be counted by 32 bits.
pub fn parse_count(text: &str) -> Result<usize, BenchError> {
    let (digits, unit) = match text.trim().as_bytes() {
        [.., b'K' | b'k'] => (&text.trim()[..text.trim().len() - 1], 1 << 10),
        [.., b'M' | b'm'] => (&text.trim()[..text.trim().len() - 1], 1 << 20),
        _ => (text.trim(), 1),
    };
    let count = digits.parse::<u32>().ok().and_then(|number| number.checked_mul(unit));
    match count {
        Some(count @ 1..) => Ok(count as usize),
        _ => Err(BenchError::Count(text.to_owned())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_powers_of_two() {
        for (text, expected) in [("1K", 1024), ("64k", 65536), (" 1M ", 1 << 20), ("1000", 1000)] {
            assert_eq!(parse_count(text).unwrap(), expected);
        }
    }

    #[test]
    fn what_is_no_count_is_an_error_that_repeats_it() {
        for text in ["", "K", "0", "0K", "-1", "1.5K", "1G", "5000M", "1KK"] {
            let message = parse_count(text).unwrap_err().to_string();
            assert!(message.contains(&format!("{text:?}")), "{message}");
        }
    }
}
