//! Numbers as people read them.

/// A count as people write it.
pub(crate) fn count(count: usize) -> String {
    match count {
        0 => "0".to_owned(),
        _ if count.is_multiple_of(1 << 20) => format!("{}M", count >> 20),
        _ if count.is_multiple_of(1 << 10) => format!("{}K", count >> 10),
        _ => count.to_string(),
    }
}

/// Three digits that say something.
pub(crate) fn short(value: f64) -> String {
    match value {
        _ if value >= 99.95 => format!("{value:.0}"),
        _ if value >= 9.995 => format!("{value:.1}"),
        _ if value >= 0.9995 => format!("{value:.2}"),
        _ => format!("{value:.3}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_short_where_that_is_exact() {
        let counts = [0, 1, 1000, 1 << 10, 3 << 19, 1 << 20, 9952].map(count);
        assert_eq!(counts, ["0", "1", "1000", "1K", "1536K", "1M", "9952"]);
    }

    #[test]
    fn three_digits_are_kept() {
        let values = [0.0123, 0.5, 1.0, 9.999, 12.34, 99.96, 1234.5].map(short);
        assert_eq!(values, ["0.012", "0.500", "1.00", "10.0", "12.3", "100", "1234"]);
    }
}
