//! Decimal numbers in sentences and tables.

/// Formats a number with `digits` decimals and a typographic minus; huge numbers in scientific notation.
pub(crate) fn fixed(value: f64, digits: usize) -> String {
    // Above that the digits would be those of the binary representation.
    let text = if value.abs() < 1e15 {
        format!("{value:.digits$}")
    } else {
        format!("{value:.digits$e}")
    };
    match text.strip_prefix('-') {
        // A value that rounds to zero is printed without a sign.
        Some(zero) if zero.chars().all(|digit| matches!(digit, '0' | '.')) => zero.to_owned(),
        Some(magnitude) => format!("−{magnitude}"),
        None => text,
    }
}

/// Formats a number with `digits` significant digits and a power of ten: "−2.20 × 10⁻⁴".
pub(crate) fn with_power(value: f64, digits: usize) -> String {
    let text = format!("{value:.*e}", digits.saturating_sub(1));
    // An infinite number has no exponent.
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let exponent = exponent.parse().unwrap_or_default();
    format!("{} × {}", mantissa.replace('-', "−"), raised(exponent))
}

/// A power of ten: "10⁻⁴".
pub(crate) fn raised(exponent: i32) -> String {
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
}
