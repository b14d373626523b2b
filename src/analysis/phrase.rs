//! Formatting of numbers and times in text.

/// A number rounded to `digits` significant digits; very small and very large numbers with a power of ten.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return format!("{value}").replace('-', "−");
    }
    // The exponent after rounding: 9.996 with three digits is 10.0.
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    let exponent: i32 = scientific
        .rsplit_once('e')
        .and_then(|(_, e)| e.parse().ok())
        .unwrap_or(0);
    // Negative for large numbers, which have no decimals.
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
pub(crate) fn quantity(value: f64, digits: usize, unit: &str) -> String {
    let number = significant(value, digits);
    if unit.is_empty() {
        number
    } else {
        format!("{number} {unit}")
    }
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
        assert_eq!(duration(9.9999e-4), "1.00 ms");
        assert_eq!(significant(-0.0, 3), "0");
    }
}
