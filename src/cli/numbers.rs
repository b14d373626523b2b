//! Numbers in reports.

use crate::run::decimal::fixed;
use crate::run::plural::{counted, grouped};

/// Formats a number with `digits` decimals and a typographic minus; huge numbers in scientific notation.
pub(super) fn format_fixed(value: f64, digits: usize) -> String {
    fixed(value, digits)
}

/// Formats a number with `digits` significant digits, without trailing zeros.
pub(super) fn format_significant(value: f64, digits: usize) -> String {
    let rounded = format!("{value:.*e}", digits.saturating_sub(1));
    // Written as a number again, it has as few digits as it needs.
    rounded
        .parse()
        .map_or(rounded, |value: f64| value.to_string())
}

/// Formats an integer with thousands separators.
pub(super) fn format_integer(value: u64) -> String {
    grouped(value)
}

/// Formats a count with its noun: "1 sample", "2 samples".
pub(super) fn format_count(number: u64, noun: &str) -> String {
    counted(number, noun)
}

/// Formats a number of bytes.
pub(super) fn format_size(value: u64) -> String {
    match value {
        0..1_000 => format!("{value} B"),
        1_000..1_000_000 => format!("{:.1} kB", value as f64 / 1e3),
        1_000_000..1_000_000_000 => format!("{:.1} MB", value as f64 / 1e6),
        _ => format!("{:.2} GB", value as f64 / 1e9),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_numbers() {
        assert_eq!(format_integer(0), "0");
        assert_eq!(format_integer(999), "999");
        assert_eq!(format_integer(24_720), "24,720");
        assert_eq!(format_integer(1_000_000), "1,000,000");
        assert_eq!(format_count(1, "run"), "1 run");
        assert_eq!(format_count(0, "run"), "0 runs");
        assert_eq!(format_size(999), "999 B");
        assert_eq!(format_size(31_400_000), "31.4 MB");
        // The rate for a period of 10 µs.
        assert_eq!(format_significant(1.0 / 1e-5, 6), "100000");
        assert_eq!(format_significant(1.0 / 3e-3, 6), "333.333");
        assert_eq!(format_significant(0.25, 6), "0.25");
    }
}
