//! Cells with numbers.

use super::layout::Decimal;
use super::unit::Unit;
use std::borrow::Cow;

/// Texts that stand for a missing value, in lower case.
const MISSING: &[&str] = &["", "nan", "na", "n/a", "#n/a", "null", "none", "-", "--"];

/// The content of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cell {
    /// No value.
    Missing,
    /// A number, and its decimal mark if it has one.
    Number(f64, Option<Decimal>),
    /// Infinity.
    Infinite,
    /// Anything else.
    Text,
}

impl Cell {
    /// Reads a cell, which may end with the unit of its column.
    pub(super) fn parse(text: &str, unit: Option<&Unit>) -> Self {
        let parsed = Self::parse_number(text);
        let names = unit.map_or(&[][..], |unit| unit.names);
        for name in names.iter().filter(|_| parsed == Self::Text) {
            if let Some(number) = text.strip_suffix(name) {
                return Self::parse_number(number.trim_end());
            }
        }
        parsed
    }

    fn parse_number(text: &str) -> Self {
        if MISSING.contains(&&*text.to_lowercase()) {
            return Self::Missing;
        }
        // U+2212, as typesetters and this program write it.
        let mut text = Cow::Borrowed(text);
        if text.contains('−') {
            text = Cow::Owned(text.replace('−', "-"));
        }
        let decimal = [Decimal::Point, Decimal::Comma]
            .into_iter()
            .find(|decimal| text.contains(decimal.mark()));
        if decimal == Some(Decimal::Comma) {
            text = Cow::Owned(text.replacen(',', ".", 1));
        }
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Self::Number(number, decimal),
            Ok(_) => Self::Infinite,
            Err(_) => Self::Text,
        }
    }
}

/// Whether a cell has a number, with any decimal mark.
pub(super) fn is_number(text: &str) -> bool {
    matches!(Cell::parse(text, None), Cell::Number(..))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_numbers() {
        let [point, comma] = [Some(Decimal::Point), Some(Decimal::Comma)];
        let degrees = Unit::find("deg");
        for (text, expected) in [
            ("12", Cell::Number(12.0, None)),
            ("-0.5", Cell::Number(-0.5, point)),
            ("−0,5", Cell::Number(-0.5, comma)),
            ("1e−3", Cell::Number(1e-3, None)),
            ("1.250E+00", Cell::Number(1.25, point)),
            ("25,89°", Cell::Number(25.89, comma)),
            ("25.89 deg", Cell::Number(25.89, point)),
            ("25.89 rad", Cell::Text),
            ("#N/A", Cell::Missing),
            ("-", Cell::Missing),
            ("NaN", Cell::Missing),
            ("−", Cell::Text),
            ("1.234,5", Cell::Text),
            ("1,234.5", Cell::Text),
            ("1,234,567", Cell::Text),
            ("1 234", Cell::Text),
            ("inf", Cell::Infinite),
            ("1e999", Cell::Infinite),
            ("0x1F", Cell::Text),
            (".", Cell::Text),
        ] {
            assert_eq!(Cell::parse(text, degrees), expected, "{text}");
        }
    }
}
