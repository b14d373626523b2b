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
}
