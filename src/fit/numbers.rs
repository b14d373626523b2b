//! Numbers in reports of fits.

use crate::run::decimal::{fixed, raised, with_power};

/// p-values below this are printed as a bound.
pub(crate) const MIN_PRINTED_P: f64 = 1e-6;
const MIN_PRINTED_EXPONENT: i32 = -6;

/// Formats a p-value with its symbol; tiny ones as a bound.
pub(crate) fn format_probability(p: f64) -> String {
    if p < MIN_PRINTED_P {
        format!("p {}", format_small_probability())
    } else {
        format!("p = {}", format_printable_probability(p))
    }
}

/// The bound for tiny p-values.
pub(crate) fn format_small_probability() -> String {
    format!("< {}", raised(MIN_PRINTED_EXPONENT))
}

/// Formats a p-value that is not tiny.
pub(crate) fn format_printable_probability(p: f64) -> String {
    if p < 0.01 {
        with_power(p, 2)
    } else {
        format!("{p:.2}")
    }
}

/// Formats a time in seconds to the microsecond, without trailing zeros.
pub(crate) fn format_time(value: f64) -> String {
    let text = format!("{value:.6}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    short.replace('-', "−")
}

/// Decimals that show two digits of a standard deviation.
pub(crate) fn decimals(sd: f64) -> usize {
    // The exponent of the rounded number: 0.0996 with two digits is 0.10.
    let scientific = format!("{sd:.1e}");
    let exponent: i32 = scientific
        .rsplit_once('e')
        .and_then(|(_, exponent)| exponent.parse().ok())
        .unwrap_or_default();
    usize::try_from(1 - exponent).unwrap_or_default().min(17)
}

/// Formats an estimate and its standard deviation with the digits that are known.
pub(crate) fn format_estimate(value: f64, sd: f64) -> String {
    let digits = decimals(sd);
    format!("{} ± {}", fixed(value, digits), fixed(sd, digits))
}

/// Formats a number with significant digits, tiny and huge ones with a power of ten.
pub(crate) fn format_rounded(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let scientific = format!("{value:.*e}", digits - 1);
    let rounded: f64 = scientific.parse().unwrap_or(value);
    let text = if (1e-4..1e6).contains(&rounded.abs()) {
        rounded.to_string()
    } else {
        return with_power(value, digits);
    };
    text.replacen('-', "−", usize::from(value < 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_estimates_to_their_errors() {
        for (value, sd, expected) in [
            (0.0517144, 1.507e-5, "0.051714 ± 0.000015"),
            (-0.1203, 0.0047, "−0.1203 ± 0.0047"),
            (231.0009, 0.0996, "231.00 ± 0.10"),
            (1234.0, 56.0, "1234 ± 56"),
            (4.8823442e-16, 0.00017, "0.00000 ± 0.00017"),
        ] {
            assert_eq!(format_estimate(value, sd), expected);
        }
        assert_eq!(format_rounded(0.00001234, 3), "1.23 × 10⁻⁵");
        assert_eq!(format_rounded(-2.0, 3), "−2");
    }
}
