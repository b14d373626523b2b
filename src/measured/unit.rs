//! Units of measured columns.

use super::error::DataError;
use crate::words::sentence;
use std::f64::consts::{PI, TAU};

/// What a column measures, as far as units are concerned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Dimension {
    Time,
    Angle,
    AngularRate,
    AngularAcceleration,
    Length,
    Speed,
    Number,
}

/// A unit: names, dimension and size in SI units.
type Unit = (&'static [&'static str], Dimension, f64);

#[rustfmt::skip]
const UNITS: &[Unit] = &[
    (&["s", "sec", "secs", "second", "seconds"], Dimension::Time, 1.0),
    (&["ms", "msec", "milliseconds"], Dimension::Time, 1e-3),
    (&["µs", "μs", "us", "microseconds"], Dimension::Time, 1e-6),
    (&["ns", "nanoseconds"], Dimension::Time, 1e-9),
    (&["min", "minutes"], Dimension::Time, 60.0),
    (&["rad", "radian", "radians"], Dimension::Angle, 1.0),
    (&["mrad"], Dimension::Angle, 1e-3),
    (&["deg", "°", "degree", "degrees"], Dimension::Angle, PI / 180.0),
    (&["rev", "turn", "turns", "revolutions"], Dimension::Angle, TAU),
    (&["rad/s", "rad s^-1", "rad·s⁻¹", "rad/sec", "1/s"], Dimension::AngularRate, 1.0),
    (&["mrad/s"], Dimension::AngularRate, 1e-3),
    (&["deg/s", "°/s", "dps", "deg/sec", "degrees/s"], Dimension::AngularRate, PI / 180.0),
    (&["rpm", "rev/min", "1/min"], Dimension::AngularRate, TAU / 60.0),
    (&["rev/s", "rps", "hz"], Dimension::AngularRate, TAU),
    (&["rad/s²", "rad/s^2", "rad/s2", "rad/s/s"], Dimension::AngularAcceleration, 1.0),
    (&["deg/s²", "deg/s^2", "deg/s2", "°/s²", "°/s^2"], Dimension::AngularAcceleration, PI / 180.0),
    (&["m"], Dimension::Length, 1.0),
    (&["cm"], Dimension::Length, 1e-2),
    (&["mm"], Dimension::Length, 1e-3),
    (&["m/s"], Dimension::Speed, 1.0),
    (&["cm/s"], Dimension::Speed, 1e-2),
    (&["mm/s"], Dimension::Speed, 1e-3),
];

/// Brackets around units.
const BRACKETS: [(char, char); 2] = [('(', ')'), ('[', ']')];

impl Dimension {
    /// The dimension of a field with this SI unit.
    pub(crate) fn from_si(unit: &str) -> Self {
        match unit {
            "s" => Self::Time,
            "rad" => Self::Angle,
            "rad/s" => Self::AngularRate,
            "rad/s²" => Self::AngularAcceleration,
            "m" => Self::Length,
            "m/s" => Self::Speed,
            _ => Self::Number,
        }
    }

    /// Units in which values are often given without saying so: names, and sizes in SI units.
    pub(crate) fn mistakable(self) -> &'static [(&'static str, f64)] {
        match self {
            Self::Angle => &[("deg", PI / 180.0)],
            Self::AngularRate => &[("deg/s", PI / 180.0), ("rpm", TAU / 60.0)],
            Self::Time | Self::AngularAcceleration | Self::Length | Self::Speed | Self::Number => {
                &[]
            }
        }
    }

    /// The quantity in words.
    pub(super) fn meaning(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Angle => "angle",
            Self::AngularRate => "angular velocity",
            Self::AngularAcceleration => "angular acceleration",
            Self::Length => "length",
            Self::Speed => "speed",
            Self::Number => "a pure number",
        }
    }

    /// Size of a unit of this dimension in SI units; 1 for no unit.
    pub(super) fn factor(self, unit: &str, column: &str) -> Result<f64, DataError> {
        if unit.is_empty() {
            return Ok(1.0);
        }
        match find(unit) {
            Some((_, dimension, factor)) if *dimension == self => Ok(*factor),
            Some(_) | None => {
                let units = UNITS.iter().filter(|(_, dimension, _)| *dimension == self);
                let allowed: Vec<&str> = units.map(|(names, ..)| names[0]).collect();
                let problem = sentence!(
                    "{} is not a unit of {}; allowed: {}",
                    format!("{unit:?}"),
                    self.meaning(),
                    allowed.join(", ")
                );
                Err(DataError::new(problem).in_column(column))
            }
        }
    }
}

/// The unit with this name.
fn find(name: &str) -> Option<&'static Unit> {
    let lower = name.trim().to_lowercase();
    UNITS.iter().find(|(names, ..)| names.contains(&&*lower))
}

/// Whether a text is the name of a unit.
pub(super) fn is_unit(text: &str) -> bool {
    find(text).is_some()
}

/// A unit without its brackets.
pub(super) fn bare_unit(cell: &str) -> &str {
    for (open, close) in BRACKETS {
        let inner = cell.strip_prefix(open);
        if let Some(unit) = inner.and_then(|inner| inner.strip_suffix(close)) {
            return unit.trim();
        }
    }
    cell
}

/// Whether a text is a unit in brackets.
pub(super) fn is_bracketed_unit(text: &str) -> bool {
    let bare = bare_unit(text);
    bare != text && is_unit(bare)
}

/// Splits a header such as `θ (deg)`, `Time [ms]`, `t / s` or `theta_deg` into name and unit; the unit may be empty.
pub(crate) fn split_header(text: &str) -> (&str, &str) {
    let header = text.trim();
    for (open, close) in BRACKETS {
        if let Some(inner) = header.strip_suffix(close)
            && let Some((name, unit)) = inner.rsplit_once(open)
        {
            return (name.trim(), unit.trim());
        }
    }
    // `rad/s` itself has a slash, names have underscores: `gyro_z_rad/s`.
    // Earlier ones are the surer signs of a unit.
    let splits = [
        header.split_once(" / "),
        header.split_once(" in "),
        header.rsplit_once('_'),
        header.split_once('/'),
    ];
    for (name, unit) in splits.into_iter().flatten() {
        if is_unit(unit) && !name.is_empty() {
            return (name.trim(), unit.trim());
        }
    }
    (header, "")
}

/// Splits a number with a unit, such as `2mrad` or `1e-3`.
pub(super) fn split_number(argument: &str) -> Option<(f64, &str)> {
    let text = argument.trim();
    // The longest beginning that is a number: `1e-3` is one, and `2mrad` has one.
    let mut longest = None;
    for end in (1..=text.len()).filter(|end| text.is_char_boundary(*end)) {
        if let Ok(number) = text[..end].parse::<f64>() {
            longest = Some((number, text[end..].trim()));
        }
    }
    longest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splits_headers_into_names_and_units() {
        for (header, expected) in [
            ("θ (deg)", ("θ", "deg")),
            ("Time (s)", ("Time", "s")),
            ("Gyroscope z (rad/s)", ("Gyroscope z", "rad/s")),
            ("t [ms]", ("t", "ms")),
            ("t / s", ("t", "s")),
            ("omega/rad/s", ("omega", "rad/s")),
            ("theta_deg", ("theta", "deg")),
            ("gyro_z_rad/s", ("gyro_z", "rad/s")),
            ("theta_dot", ("theta_dot", "")),
            ("phi", ("phi", "")),
        ] {
            assert_eq!(split_header(header), expected, "{header}");
        }
    }

    #[test]
    fn splits_numbers_from_units() {
        assert_eq!(split_number("2mrad"), Some((2.0, "mrad")));
        assert_eq!(split_number("1e-3"), Some((1e-3, "")));
        assert_eq!(split_number("-0.5 deg/s"), Some((-0.5, "deg/s")));
        assert_eq!(split_number("abc"), None);
    }

    #[test]
    fn refuses_units_of_another_dimension() {
        let factor = Dimension::Angle.factor("deg", "θ").unwrap();
        assert!((180.0 * factor - PI).abs() < 1e-15);
        let error = Dimension::Angle.factor("rpm", "θ").unwrap_err().to_string();
        assert!(error.contains("\"rpm\" is not a unit of angle"), "{error}");
        assert!(error.contains("deg"), "{error}");
    }
}
