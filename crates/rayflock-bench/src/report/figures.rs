//! Numbers as people read them on a page.

use crate::text;

/// A number of things as in the definitions, `1K` for 1024; others in groups of three digits.
pub(super) fn count(count: u64) -> String {
    if count.is_multiple_of(1024) { text::count(count as usize) } else { grouped(count) }
}

/// A number in groups of three digits.
pub(super) fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (idx, digit) in digits.chars().enumerate() {
        if idx > 0 && (digits.len() - idx).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A time.
pub(super) fn milliseconds(value: f64) -> String {
    text::short(value)
}

/// A ratio with two digits that say something, more where it is long.
pub(super) fn factor(value: f64) -> String {
    match value {
        _ if value < 0.0995 => format!("{value:.3}"),
        _ if value < 9.95 => format!("{value:.2}"),
        _ if value < 99.5 => format!("{value:.1}"),
        _ => format!("{value:.0}"),
    }
}

/// A number of bytes.
pub(super) fn bytes(bytes: usize) -> String {
    let mib = bytes as f64 / f64::from(1 << 20);
    if mib < 0.1 { format!("{:.1} KiB", bytes as f64 / 1024.0) } else { format!("{mib:.1} MiB") }
}

/// A share in percent.
pub(super) fn percent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

/// The word for one thing or several.
pub(super) fn plural(count: usize, one: &str, several: &str) -> String {
    format!("{} {}", grouped(count as u64), if count == 1 { one } else { several })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_written_as_in_the_definitions() {
        let counts = [0, 1024, 65_536, 1 << 20, 9_952, 1_234_567].map(count);
        assert_eq!(counts, ["0", "1K", "64K", "1M", "9,952", "1,234,567"]);
    }

    #[test]
    fn numbers_keep_the_digits_that_say_something() {
        let times = [0.0463, 1.357, 36.54, 575.9].map(milliseconds);
        assert_eq!(times, ["0.046", "1.36", "36.5", "576"]);
        let factors = [0.0344, 0.5, 1.0, 6.04, 15.26, 120.4].map(factor);
        assert_eq!(factors, ["0.034", "0.50", "1.00", "6.04", "15.3", "120"]);
        assert_eq!((bytes(512), bytes(3 << 20)), ("0.5 KiB".to_owned(), "3.0 MiB".to_owned()));
    }
}
