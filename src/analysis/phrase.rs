//! Numbers, times and symbols as they stand in sentences.

/// A number rounded to `digits` significant digits; very small and very large numbers with a power of ten.
#[must_use]
pub(crate) fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}").replace('-', "−");
    }
    // The exponent after rounding: 9.996 with three digits is 10.0.
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    let exponent: i32 = scientific
        .rsplit_once('e')
        .and_then(|(_, e)| e.parse().ok())
        .unwrap_or(0);
    let decimals = digits as i32 - 1 - exponent;
    let text = if (-3..6).contains(&exponent) {
        format!("{value:.*}", usize::try_from(decimals).unwrap_or(0))
    } else {
        scientific
    };
    match text.strip_prefix('-') {
        Some(rest) => format!("−{rest}"),
        None => text,
    }
}

/// A number with its unit.
#[must_use]
pub(crate) fn quantity(value: f64, digits: usize, unit: &str) -> String {
    let number = significant(value, digits);
    if unit.is_empty() {
        number
    } else {
        format!("{number} {unit}")
    }
}

/// The magnitude of a time, in the unit that fits.
#[must_use]
pub(crate) fn duration(seconds: f64) -> String {
    let size = seconds.abs();
    let (factor, unit) = match size {
        0.0 => (1.0, "s"),
        _ if size < 1e-6 => (1e9, "ns"),
        _ if size < 1e-3 => (1e6, "µs"),
        _ if size < 1.0 => (1e3, "ms"),
        _ => (1.0, "s"),
    };
    quantity(size * factor, 3, unit)
}

/// A point in time, s.
#[must_use]
pub(crate) fn moment(seconds: f64) -> String {
    format!("{seconds:.4} s")
}

/// The symbol of a field of the table.
#[must_use]
pub(crate) fn symbol(field: &str) -> &str {
    match field {
        "phi" => "φ",
        "theta" | "theta_mean" => "θ",
        "psi" => "ψ",
        "theta_dot" | "theta_dot_mean" => "θ̇",
        "phi_dot" | "phi_dot_mean" => "φ̇",
        "psi_dot" | "psi_dot_mean" => "ψ̇",
        other => other,
    }
}

/// A list of items, with commas and an "and".
#[must_use]
pub(crate) fn list(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [others @ .., last] => format!("{} and {last}", others.join(", ")),
    }
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
            (-4.655_75e-6, "−4.66e-6"),
            (24.719_386, "24.7"),
            (123_456.0, "123456"),
            (1.5e9, "1.50e9"),
        ] {
            assert_eq!(significant(value, 3), text);
        }
        assert_eq!(duration(-0.011_554_6), "11.6 ms");
        assert_eq!(duration(3e-10), "0.300 ns");
        assert_eq!(duration(0.0), "0 s");
    }
}
