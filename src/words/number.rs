//! Numbers as they are written: rounded, with a typographic minus, and with a power of ten where they are very small or very
//! large.

use std::ops::Range;

/// Exponents of numbers without a power of ten.
const PLAIN: Range<i32> = -3..6;

/// Digits of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Digits {
    /// So many decimals; from 10¹⁵ on so many after the first digit, because more would be those of the binary number.
    Decimals(usize),
    /// So many significant digits.
    Significant(usize),
    /// At most so many significant digits, without zeros at the end.
    AtMost(usize),
    /// At most so many decimals, without zeros at the end.
    AtMostDecimals(usize),
    /// So many significant digits, and a power of ten.
    Power(usize),
}

/// Writes a number.
pub fn format(value: f64, digits: Digits) -> String {
    if !value.is_finite() {
        return value.to_string().replace('-', "−");
    }
    match digits {
        Digits::Decimals(decimals) => fixed(value, decimals),
        Digits::AtMostDecimals(decimals) => without_zeros(&fixed(value, decimals)),
        Digits::Significant(_) | Digits::AtMost(_) | Digits::Power(_) if value == 0.0 => {
            "0".to_owned()
        }
        Digits::Power(digits) => with_power(value, digits),
        Digits::Significant(digits) => {
            let exponent = exponent(value, digits);
            if PLAIN.contains(&exponent) {
                fixed(value, decimals(digits, exponent))
            } else {
                with_power(value, digits)
            }
        }
        Digits::AtMost(digits) => {
            let exponent = exponent(value, digits);
            if PLAIN.contains(&exponent) {
                without_zeros(&fixed(value, decimals(digits, exponent)))
            } else {
                with_power(value, digits)
            }
        }
    }
}

/// A number with `decimals` decimals.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = if value.is_finite() && value.abs() >= 1e15 {
        format!("{value:.decimals$e}")
    } else {
        format!("{value:.decimals$}")
    };
    match text.strip_prefix('-') {
        // A value that rounds to zero has no sign.
        Some(zero) if zero.chars().all(|digit| matches!(digit, '0' | '.')) => zero.to_owned(),
        Some(magnitude) => format!("−{magnitude}"),
        None => text,
    }
}

/// A number with `digits` significant digits.
pub fn significant(value: f64, digits: usize) -> String {
    format(value, Digits::Significant(digits))
}

/// A number with at most `digits` significant digits, without zeros at the end.
pub fn rounded(value: f64, digits: usize) -> String {
    format(value, Digits::AtMost(digits))
}

/// Decimals that give a number with this exponent `digits` significant digits; none for large numbers.
fn decimals(digits: usize, exponent: i32) -> usize {
    usize::try_from(digits as i32 - 1 - exponent).unwrap_or(0)
}

/// A decimal number without zeros after the last digit of its fraction. Very large numbers keep them before their exponent.
fn without_zeros(text: &str) -> String {
    if text.contains('.') && !text.contains('e') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text.to_owned()
    }
}

/// A number with `digits` significant digits and a power of ten: "−2.20 × 10⁻⁴".
pub fn with_power(value: f64, digits: usize) -> String {
    let text = format!("{value:.*e}", digits.saturating_sub(1));
    // An infinite number has no exponent.
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let exponent = exponent.parse().unwrap_or_default();
    format!("{} × {}", mantissa.replace('-', "−"), raised(exponent))
}

/// A power of ten: "10⁻⁴".
pub fn raised(exponent: i32) -> String {
    let digits: String = exponent.to_string().chars().map(superscript).collect();
    format!("10{digits}")
}

fn superscript(sign: char) -> char {
    match sign {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        _ => '⁰',
    }
}

/// The exponent of a number that is rounded to `digits` significant digits: 9.996 with three digits is 10.0.
fn exponent(value: f64, digits: usize) -> i32 {
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    scientific
        .rsplit_once('e')
        .and_then(|(_, exponent)| exponent.parse().ok())
        .unwrap_or(0)
}

/// A text with the numbers of programs instead of those of people: "-4.66e-6" for "−4.66 × 10⁻⁶".
pub fn plain(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut parts = text.split(" × 10");
    plain.push_str(parts.next().unwrap_or_default());
    for part in parts {
        let rest = part.trim_start_matches(|character| from_superscript(character).is_some());
        let exponent = part[..part.len() - rest.len()].chars();
        plain.push_str(if rest.len() < part.len() {
            "e"
        } else {
            " × 10"
        });
        plain.extend(exponent.filter_map(from_superscript));
        plain.push_str(rest);
    }
    plain.replace('−', "-")
}

fn from_superscript(character: char) -> Option<char> {
    ('0'..='9')
        .chain(['-'])
        .find(|sign| superscript(*sign) == character)
}

/// Decimals that show two digits of a standard deviation.
pub fn decimals_of_error(error: f64) -> usize {
    decimals(2, exponent(error, 2)).min(17)
}

/// Two values of a quantity, for "from … to …": both with the decimals that give the larger one `digits` significant
/// digits. Each by itself if the larger one has a power of ten, or the smaller one would be zero.
pub fn pair(values: [f64; 2], digits: usize) -> [String; 2] {
    let largest = values.map(f64::abs).into_iter().fold(0.0, f64::max);
    let leading = exponent(largest, digits);
    let last = leading + 1 - digits as i32;
    let vanishes = values
        .iter()
        .any(|value| *value != 0.0 && exponent(*value, 1) < last);
    if largest > 0.0 && largest.is_finite() && PLAIN.contains(&leading) && !vanishes {
        values.map(|value| fixed(value, decimals(digits, leading)))
    } else {
        values.map(|value| significant(value, digits))
    }
}

/// The number of digits from `digits` on with which two values look different; `digits` if those that are known don't
/// show a difference.
pub(super) fn distinct_digits(values: [f64; 2], digits: usize) -> usize {
    /// More digits show the error of the integration.
    const MAX_DIGITS: usize = 9;
    (digits..=MAX_DIGITS)
        .find(|digits| {
            let [first, last] = pair(values, *digits);
            first != last
        })
        .unwrap_or(digits)
}

/// Probabilities below this are not distinguished.
pub const MIN_PROBABILITY: f64 = 1e-6;

/// A probability: "0.02", "4.1 × 10⁻⁵", "< 10⁻⁶".
pub fn probability(p: f64) -> String {
    if p < MIN_PROBABILITY {
        format!("< {}", raised(-6))
    } else if p < 0.01 {
        with_power(p, 2)
    } else {
        format!("{p:.2}")
    }
}

/// A number of bytes: "31.4 MB".
pub fn bytes(count: u64) -> String {
    match count {
        0..1_000 => format!("{count} B"),
        1_000..1_000_000 => format!("{:.1} kB", count as f64 / 1e3),
        1_000_000..1_000_000_000 => format!("{:.1} MB", count as f64 / 1e6),
        _ => format!("{:.2} GB", count as f64 / 1e9),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_decimals() {
        for (value, digits, expected) in [
            (-0.2969, 3, "−0.297"),
            (170.0, 2, "170.00"),
            (-0.0, 2, "0.00"),
            (-4e-5, 4, "0.0000"),
            (f64::NEG_INFINITY, 4, "−inf"),
            (f64::NAN, 4, "NaN"),
            (-1.5e300, 2, "−1.50e300"),
        ] {
            assert_eq!(fixed(value, digits), expected);
        }
    }

    #[test]
    fn formats_significant_digits() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "0"),
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
    }

    #[test]
    fn leaves_out_zeros_at_the_end() {
        for (value, digits, text) in [
            (0.0, 3, "0"),
            (-2.0, 3, "−2"),
            (0.25, 6, "0.25"),
            (100.0, 3, "100"),
            (1.0 / 3e-3, 6, "333.333"),
            (1e5, 6, "100000"),
            (2e-4, 1, "2 × 10⁻⁴"),
        ] {
            assert_eq!(rounded(value, digits), text);
        }
    }

    #[test]
    fn powers_are_raised() {
        for (value, digits, expected) in [
            (2.2e-4, 3, "2.20 × 10⁻⁴"),
            (-7.6e-15, 2, "−7.6 × 10⁻¹⁵"),
            (1e-6, 1, "1 × 10⁻⁶"),
            (1.5e9, 3, "1.50 × 10⁹"),
            (9.996e20, 3, "1.00 × 10²¹"),
        ] {
            assert_eq!(with_power(value, digits), expected);
        }
    }

    #[test]
    fn pairs_have_one_notation_without_powers() {
        for (values, expected) in [
            ([0.005_900_4, 2.2e-4], ["0.005900", "0.000220"]),
            ([5.9e-5, 2.2e-6], ["5.900 × 10⁻⁵", "2.200 × 10⁻⁶"]),
            ([0.5, 0.02], ["0.5000", "0.0200"]),
            ([-1.5e9, 2.26e7], ["−1.500 × 10⁹", "2.260 × 10⁷"]),
            ([0.0, 3e-9], ["0", "3.000 × 10⁻⁹"]),
            ([0.0, 0.0], ["0", "0"]),
            ([0.25, 3e-9], ["0.2500", "3.000 × 10⁻⁹"]),
        ] {
            assert_eq!(pair(values, 4), expected);
        }
    }

    #[test]
    fn plain_numbers_are_those_of_programs() {
        for (text, expected) in [
            ("−4.66 × 10⁻⁶ ± 3.3 × 10⁻⁸", "-4.66e-6 ± 3.3e-8"),
            ("1.50 × 10⁹ rad", "1.50e9 rad"),
            ("n × e_N, 2 × 10", "n × e_N, 2 × 10"),
            ("−0.25", "-0.25"),
        ] {
            assert_eq!(plain(text), expected);
        }
    }

    #[test]
    fn formats_sizes() {
        assert_eq!(bytes(999), "999 B");
        assert_eq!(bytes(31_400_000), "31.4 MB");
    }
}
