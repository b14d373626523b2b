//! Formatting of numbers and times in text.

use crate::run::decimal::{fixed, raised, with_power};
use std::ops::Range;

/// Exponents of numbers without a power of ten.
const PLAIN: Range<i32> = -3..6;

/// The exponent of a number that is rounded to `digits` significant digits: 9.996 with three digits is 10.0.
fn exponent(value: f64, digits: usize) -> i32 {
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    scientific
        .rsplit_once('e')
        .and_then(|(_, exponent)| exponent.parse().ok())
        .unwrap_or(0)
}

/// A number rounded to `digits` significant digits; very small and very large numbers with a power of ten.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return format!("{value}").replace('-', "−");
    }
    let exponent = exponent(value, digits);
    if PLAIN.contains(&exponent) {
        // Negative for large numbers, which have no decimals.
        let decimals = digits as i32 - 1 - exponent;
        fixed(value, usize::try_from(decimals).unwrap_or(0))
    } else {
        with_power(value, digits)
    }
}

/// Two values of a quantity, for "from … to …": both with the decimals and the power of ten that give the larger one
/// `digits` significant digits. Each by itself if the smaller one would be zero.
pub(crate) fn pair(values: [f64; 2], digits: usize) -> [String; 2] {
    let largest = values.map(f64::abs).into_iter().fold(0.0, f64::max);
    let leading = exponent(largest, digits);
    let last = leading + 1 - digits as i32;
    let vanishes = values
        .iter()
        .any(|value| *value != 0.0 && exponent(*value, 1) < last);
    if largest == 0.0 || !largest.is_finite() || vanishes {
        return values.map(|value| significant(value, digits));
    }
    if PLAIN.contains(&leading) {
        let decimals = usize::try_from(-last).unwrap_or(0);
        return values.map(|value| fixed(value, decimals));
    }
    let power = raised(leading);
    // As text and back, so that the mantissas are those of the decimal numbers.
    values.map(|value| {
        let mantissa = format!("{value:e}")
            .split_once('e')
            .and_then(|(digits, own)| {
                format!("{digits}e{}", own.parse::<i32>().ok()? - leading)
                    .parse()
                    .ok()
            })
            .unwrap_or_default();
        format!("{} × {power}", fixed(mantissa, digits.saturating_sub(1)))
    })
}

/// A number with its unit.
pub(crate) fn quantity(value: f64, digits: usize, unit: &str) -> String {
    let number = significant(value, digits);
    if unit.is_empty() {
        number
    } else {
        format!("{number} {unit}")
    }
}

/// The zero of the potential energy in recordings, wherever an energy and not its change is shown.
pub(crate) const ENERGY_ZERO: &str = "zero at the height of the peg's centre";

/// More digits show the error of the integration.
const MAX_DIGITS: usize = 9;

/// Two values of a quantity with their unit, for "from … to …"; with more than `digits` if they would look equal. The
/// unit follows the second one, or both if only one has a power of ten.
pub(crate) fn quantities(values: [f64; 2], digits: usize, unit: &str) -> [String; 2] {
    let [first, last] = (digits..=MAX_DIGITS)
        .map(|digits| pair(values, digits))
        .find(|[first, last]| first != last)
        .unwrap_or_else(|| pair(values, digits));
    if has_power(&first) == has_power(&last) {
        [first, format!("{last} {unit}")]
    } else {
        [first, last].map(|number| format!("{number} {unit}"))
    }
}

/// Whether a number has a power of ten.
fn has_power(number: &str) -> bool {
    number.contains('×')
}

/// Two values of a quantity, each with its unit, for different parts of a sentence; with more than `digits` if they
/// would look equal.
pub(crate) fn separate_quantities(values: [f64; 2], digits: usize, unit: &str) -> [String; 2] {
    (digits..=MAX_DIGITS)
        .map(|digits| values.map(|value| quantity(value, digits, unit)))
        .find(|[first, last]| first != last)
        .unwrap_or_else(|| values.map(|value| quantity(value, digits, unit)))
}

/// Units with their scale factors, largest first.
type Units = [(f64, &'static str); 4];

/// A magnitude with three digits in the largest suitable unit.
fn in_units(value: f64, units: &Units) -> String {
    let size = value.abs();
    let (factor, unit) = match size {
        0.0 => units[0],
        // With three digits, 0.9995 is 1.00.
        _ => *units
            .iter()
            .find(|(factor, _)| size * factor >= 0.9995)
            .unwrap_or(&units[3]),
    };
    quantity(size * factor, 3, unit)
}

/// A duration without sign, in a suitable unit.
pub(crate) fn duration(seconds: f64) -> String {
    in_units(
        seconds,
        &[(1.0, "s"), (1e3, "ms"), (1e6, "µs"), (1e9, "ns")],
    )
}

/// A signed time, in a suitable unit.
pub(crate) fn signed_duration(seconds: f64) -> String {
    match seconds {
        0.0 => "0".to_owned(),
        _ if seconds > 0.0 => format!("+{}", duration(seconds)),
        _ => format!("−{}", duration(seconds)),
    }
}

/// The causes of a loss of energy: friction at the point of contact, air drag and impacts, where they act; friction if
/// none does.
pub(crate) fn works([has_friction, has_air_drag, has_impacts]: [bool; 3]) -> &'static str {
    match (has_friction, has_air_drag, has_impacts) {
        (_, false, false) => "friction",
        (true, true, true) => "friction, air drag and impacts",
        (true, true, false) => "friction and air drag",
        (true, false, true) => "friction and impacts",
        (false, true, true) => "air drag and impacts",
        (false, true, false) => "air drag",
        (false, false, true) => "impacts",
    }
}

/// A text with a capital first letter.
pub(crate) fn capitalized(text: &str) -> String {
    let mut characters = text.chars();
    match characters.next() {
        Some(first) => first.to_uppercase().chain(characters).collect(),
        None => String::new(),
    }
}

/// A point in time, s.
pub(crate) fn moment(seconds: f64) -> String {
    format!("{seconds:.4} s")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_their_significant_digits() {
        for (value, text) in [
            (0.0, "0"),
            (0.011_554_6, "0.0116"),
            (9.996, "10.0"),
            (999.6, "1000"),
            (-4.655_75e-6, "−4.66 × 10⁻⁶"),
            (24.719_386, "24.7"),
            (123_456.0, "123456"),
            (1.5e9, "1.50 × 10⁹"),
        ] {
            assert_eq!(significant(value, 3), text);
        }
        assert_eq!(duration(-0.011_554_6), "11.6 ms");
        assert_eq!(duration(3e-10), "0.300 ns");
        assert_eq!(duration(0.0), "0 s");
        assert_eq!(duration(9.9999e-4), "1.00 ms");
        assert_eq!(significant(-0.0, 3), "0");
    }

    #[test]
    fn values_that_differ_look_different() {
        for (values, expected) in [
            ([0.5, 0.02], ["0.5000", "0.0200 m"]),
            (
                [1.113_04e-4, 1.112_96e-4],
                ["1.11304 × 10⁻⁴", "1.11296 × 10⁻⁴ m"],
            ),
            ([0.020_000_1, 0.02], ["0.0200001", "0.0200000 m"]),
            ([0.5, 0.5], ["0.5000", "0.5000 m"]),
            ([0.5, 2.0e-10], ["0.5000 m", "2.000 × 10⁻¹⁰ m"]),
        ] {
            assert_eq!(quantities(values, 4, "m"), expected);
        }
        for (values, expected) in [
            ([-0.5, 0.0], ["−0.5000 m", "0 m"]),
            ([0.020_000_1, 0.02], ["0.0200001 m", "0.0200000 m"]),
        ] {
            assert_eq!(separate_quantities(values, 4, "m"), expected);
        }
    }

    #[test]
    fn pairs_have_one_notation() {
        for (values, expected) in [
            ([0.005_900_4, 2.2e-4], ["0.005900", "0.000220"]),
            ([5.9e-5, 2.2e-6], ["5.900 × 10⁻⁵", "0.220 × 10⁻⁵"]),
            ([0.5, 0.02], ["0.5000", "0.0200"]),
            ([-1.5e9, 2.26e7], ["−1.500 × 10⁹", "0.023 × 10⁹"]),
            ([0.0, 3e-9], ["0.000 × 10⁻⁹", "3.000 × 10⁻⁹"]),
            ([0.0, 0.0], ["0", "0"]),
            ([0.25, 3e-9], ["0.2500", "3.000 × 10⁻⁹"]),
        ] {
            assert_eq!(pair(values, 4), expected);
        }
    }
}
