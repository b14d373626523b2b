//! Numbers, times and symbols as they stand in sentences.

/// A number rounded to `digits` significant digits; very small and very large numbers with a power of ten.
#[must_use]
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

/// How many times as large one thing is as another, to two digits.
#[must_use]
pub(crate) fn times(ratio: f64) -> String {
    // Up to here zeros at the end are read as such.
    const LARGEST: f64 = 1e4;
    let scientific = format!("{ratio:.1e}");
    match scientific.parse::<f64>() {
        Ok(rounded) if rounded.abs() < LARGEST => significant(rounded, 2),
        _ => scientific,
    }
}

/// Two numbers, each with as many digits as it takes to see how they differ: four at least, twelve at most.
#[must_use]
pub(crate) fn pair(values: [f64; 2]) -> [String; 2] {
    // Decimals down to the third digit of the difference.
    let decimals = match exponent((values[1] - values[0]).abs()) {
        Some(exponent) => 2 - exponent,
        None => 0,
    };
    values.map(|value| {
        let digits = exponent(value).map_or(4, |exponent| exponent + 1 + decimals);
        significant(value, usize::try_from(digits.clamp(4, 12)).unwrap_or(4))
    })
}

/// The power of ten in a number; none of zero.
fn exponent(value: f64) -> Option<i32> {
    // Rounded: 1.7541 − 1.754 is a little less than 1e-4.
    let scientific = format!("{value:.2e}");
    let (_, exponent) = scientific.rsplit_once('e')?;
    exponent.parse().ok().filter(|_| value != 0.0)
}

/// Units of a quantity: how many of one there are in its SI unit, with the name; the largest unit first.
type Units = [(f64, &'static str); 4];

/// A magnitude to three digits in the largest of some units of which there is at least one.
fn in_units(value: f64, units: &Units) -> String {
    let size = value.abs();
    let rounds_to_one = |(factor, _): &&(f64, &str)| size * factor >= 0.9995;
    let (factor, unit) = match size {
        0.0 => units[0],
        _ => *units.iter().find(rounds_to_one).unwrap_or(&units[3]),
    };
    quantity(size * factor, 3, unit)
}

/// The magnitude of a time, in the unit that fits.
#[must_use]
pub(crate) fn duration(seconds: f64) -> String {
    in_units(
        seconds,
        &[(1.0, "s"), (1e3, "ms"), (1e6, "µs"), (1e9, "ns")],
    )
}

/// The magnitude of a length, in the unit that fits.
#[must_use]
pub(crate) fn length(metres: f64) -> String {
    in_units(metres, &[(1.0, "m"), (1e3, "mm"), (1e6, "µm"), (1e9, "nm")])
}

/// A span of time, s: from when to when, when if that is one moment, or how long from when on where both read the same.
#[must_use]
pub(crate) fn span(from: f64, to: f64) -> String {
    let [begin, end] = [from, to].map(moment);
    if from == to {
        format!("At {begin}")
    } else if begin == end {
        format!("For {} from {begin} on", duration(to - from))
    } else {
        format!("From {begin} to {end}")
    }
}

/// A sentence with the minus signs of its numbers as they stand in other sentences, zeros having none; exponents keep theirs.
#[must_use]
pub(crate) fn with_minus_signs(sentence: &str) -> String {
    let told = sentence
        .split(' ')
        .map(|word| match word.strip_prefix('-') {
            Some(number) if number.starts_with(|first: char| first.is_ascii_digit()) => {
                let digits = number.trim_end_matches(|last: char| !last.is_ascii_digit());
                match digits.parse::<f64>() {
                    Ok(0.0) => number.to_owned(),
                    _ => format!("−{number}"),
                }
            }
            _ => word.to_owned(),
        });
    told.collect::<Vec<_>>().join(" ")
}

/// A time with its sign, in the unit that fits.
#[must_use]
pub(crate) fn signed_duration(seconds: f64) -> String {
    match seconds {
        0.0 => "0".to_owned(),
        _ if seconds > 0.0 => format!("+{}", duration(seconds)),
        _ => format!("−{}", duration(seconds)),
    }
}

/// A point in time, s.
#[must_use]
pub(crate) fn moment(seconds: f64) -> String {
    format!("{seconds:.4} s")
}

/// Whether a clock that shows this, ns, counts from 1970: no simulation runs for three years.
#[must_use]
pub(crate) fn counts_from_1970(time_ns: u64) -> bool {
    time_ns > 100_000_000_000_000_000
}

/// A time that a file's clock shows, ns: as a date if the clock counts from 1970, else in s.
#[must_use]
pub(crate) fn clock_time(time_ns: u64) -> String {
    if counts_from_1970(time_ns) {
        date(time_ns)
    } else {
        format!("{} s", time_ns as f64 / 1e9)
    }
}

/// The moment so many ns after the beginning of 1970, in UTC as of ISO 8601.
#[must_use]
pub(crate) fn date(time_ns: u64) -> String {
    let (seconds, ns) = (time_ns / 1_000_000_000, time_ns % 1_000_000_000);
    let (days, second) = (seconds / 86_400, seconds % 86_400);
    let (hour, minute) = (second / 3600, second / 60 % 60);
    // Years that begin with March have the day of leap years at their end; 400 of them are as long as the next 400.
    let day = days + 719_468;
    let (era, day) = (day / 146_097, day % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = 400 * era + year + u64::from(month <= 2);
    let second = second % 60;
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}.{ns:09}Z")
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

/// A number of things.
#[must_use]
pub(crate) fn counted(count: u64, thing: &str) -> String {
    let ending = if count == 1 { "" } else { "s" };
    format!("{count} {thing}{ending}")
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
        for (value, text) in [
            (3.94, "3.9"),
            (9.96, "10"),
            (148.2, "150"),
            (2992.0, "3000"),
            (507_894.0, "5.1e5"),
            (1.46e7, "1.5e7"),
        ] {
            assert_eq!(times(value), text);
        }
        assert_eq!(duration(-0.011_554_6), "11.6 ms");
        assert_eq!(duration(3e-10), "0.300 ns");
        assert_eq!(duration(0.0), "0 s");
        assert_eq!(duration(9.9999e-4), "1.00 ms");
        assert_eq!(length(0.999_999_999), "1.00 m");
        assert_eq!(length(0.001), "1.00 mm");
        assert_eq!(length(1.4e-5), "14.0 µm");
        assert_eq!(significant(-0.0, 3), "0");
        assert_eq!(span(0.0, 4.53e-6), "For 4.53 µs from 0.0000 s on");
        assert_eq!(span(0.5, 0.5), "At 0.5000 s");
        assert_eq!(span(1.0, 2.0), "From 1.0000 s to 2.0000 s");
        assert_eq!(
            with_minus_signs("re-runs at -170.00 rad/s, -1.2e-5 of it, -0.0000, at -0.00."),
            "re-runs at −170.00 rad/s, −1.2e-5 of it, 0.0000, at 0.00."
        );
        assert_eq!(pair([1.754, 1.7541]), ["1.754000", "1.754100"]);
        assert_eq!(pair([0.5, 0.0216]), ["0.5000", "0.02160"]);
        assert_eq!(pair([5.0, 5.0503]), ["5.0000", "5.0503"]);
        assert_eq!(pair([2.0, 2.0]), ["2.000", "2.000"]);
    }

    /// Against GNU date: `date -u -d @SECONDS +%FT%T`.
    #[test]
    fn val_dates_are_those_of_the_calendar() {
        for (seconds, text) in [
            (0, "1970-01-01T00:00:00"),
            (68_169_599, "1972-02-28T23:59:59"),
            (68_169_600, "1972-02-29T00:00:00"),
            (951_782_400, "2000-02-29T00:00:00"),
            (1_709_251_199, "2024-02-29T23:59:59"),
            (1_735_689_599, "2024-12-31T23:59:59"),
            (4_107_542_400, "2100-03-01T00:00:00"),
            (18_446_744_073, "2554-07-21T23:34:33"),
        ] {
            let text = format!("{text}.000000007Z");
            assert_eq!(date(seconds * 1_000_000_000 + 7), text);
        }
        assert_eq!(clock_time(1_500_000_000), "1.5 s");
    }
}
