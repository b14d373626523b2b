//! Pieces of sentences.

use super::count::counted;
use super::number::{Digits, decimals_of_error, distinct_digits, fixed, format, pair, probability};
use schemars::JsonSchema;
use serde::Serialize;
use std::borrow::Cow;
use std::fmt::{self, Display, Formatter};

/// A piece of a sentence.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Piece {
    /// Text that is the same on all interfaces.
    Text(Cow<'static, str>),
    /// A number with its unit.
    Number(Number),
    /// A value with its uncertainty.
    Estimate(Estimate),
    /// A point in time of a run, s.
    Time(Number),
    /// A count with its noun.
    Count(Count),
    /// A key of the scenario, such as `friction.k`.
    Key(Cow<'static, str>),
    /// A field of a recording, such as `/top/state.theta`.
    Field(Cow<'static, str>),
    /// An argument of the interface.
    Argument(Argument),
}

/// A number as it is written.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Number {
    /// The rounded number, with a typographic minus.
    pub text: String,
    /// The number.
    pub value: f64,
    /// Its unit; empty for a pure number.
    pub unit: Cow<'static, str>,
    /// Whether the unit follows the number. In "from 0.5 to 0.2 rad", the first number has none of its own.
    pub has_unit: bool,
}

/// A value with its uncertainty.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Estimate {
    /// The value, with the digits that are known.
    pub text: String,
    /// The uncertainty, with two digits.
    pub error_text: String,
    /// The value.
    pub value: f64,
    /// The uncertainty.
    pub error: f64,
    /// The unit of both; empty for a pure number.
    pub unit: Cow<'static, str>,
    /// Whether the unit follows the uncertainty.
    pub has_unit: bool,
}

/// A count with its noun.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Count {
    /// The count.
    pub count: u64,
    /// The noun in the singular.
    pub noun: &'static str,
}

/// An argument of the interface: an option of a command, an argument of a Python function, a control of the page.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Argument {
    /// Its name: that of the option, without dashes.
    pub name: &'static str,
    /// The values for it, where it has some; several where it is given several times.
    pub values: Vec<String>,
}

/// The way in which an interface writes an argument.
pub type ArgumentStyle = fn(&Argument) -> String;

impl Argument {
    /// The name and the values, for readers of no particular interface.
    pub fn plain(&self) -> String {
        if self.values.is_empty() {
            self.name.to_owned()
        } else {
            format!("{} = {}", self.name, self.values.join(", "))
        }
    }
}

impl Number {
    /// A number with the unit that follows it.
    pub fn new(value: f64, digits: Digits, unit: impl Into<Cow<'static, str>>) -> Self {
        Self::from_text(format(value, digits), value, unit.into())
    }

    fn from_text(text: String, value: f64, unit: Cow<'static, str>) -> Self {
        Self {
            text,
            value,
            has_unit: !unit.is_empty(),
            unit,
        }
    }

    /// The number with the unit that follows it.
    pub fn plain(&self) -> String {
        if self.has_unit {
            format!("{} {}", self.text, self.unit)
        } else {
            self.text.clone()
        }
    }

    fn has_power(&self) -> bool {
        self.text.contains('×')
    }
}

impl Piece {
    /// A number with `digits` significant digits.
    pub fn number(value: f64, digits: usize, unit: impl Into<Cow<'static, str>>) -> Self {
        Self::Number(Number::new(value, Digits::Significant(digits), unit))
    }

    /// A number with at most `digits` significant digits, without zeros at the end.
    pub fn rounded(value: f64, digits: usize, unit: impl Into<Cow<'static, str>>) -> Self {
        Self::Number(Number::new(value, Digits::AtMost(digits), unit))
    }

    /// A number with `decimals` decimals.
    pub fn fixed(value: f64, decimals: usize, unit: impl Into<Cow<'static, str>>) -> Self {
        Self::Number(Number::new(value, Digits::Decimals(decimals), unit))
    }

    /// A value with its uncertainty, which has two digits.
    pub fn estimate(value: f64, error: f64, unit: impl Into<Cow<'static, str>>) -> Self {
        let decimals = decimals_of_error(error);
        let unit = unit.into();
        Self::Estimate(Estimate {
            text: fixed(value, decimals),
            error_text: fixed(error, decimals),
            value,
            error,
            has_unit: !unit.is_empty(),
            unit,
        })
    }

    /// A probability.
    pub fn probability(p: f64) -> Self {
        Self::Number(Number::from_text(probability(p), p, Cow::Borrowed("")))
    }

    /// The number or estimate for a table whose head has the unit.
    #[must_use]
    pub fn without_unit(mut self) -> Self {
        match &mut self {
            Self::Number(number) | Self::Time(number) => number.has_unit = false,
            Self::Estimate(estimate) => estimate.has_unit = false,
            Self::Text(_) | Self::Count(_) | Self::Key(_) | Self::Field(_) | Self::Argument(_) => {}
        }
        self
    }

    /// A point in time, s.
    pub fn time(seconds: f64) -> Self {
        Self::Time(Number::new(seconds, Digits::Decimals(4), "s"))
    }

    /// A count with its noun.
    pub fn count(count: u64, noun: &'static str) -> Self {
        Self::Count(Count { count, noun })
    }

    /// A key of the scenario.
    pub fn key(path: impl Into<Cow<'static, str>>) -> Self {
        Self::Key(path.into())
    }

    /// A field of a recording.
    pub fn field(path: impl Into<Cow<'static, str>>) -> Self {
        Self::Field(path.into())
    }

    /// An argument of the interface.
    pub fn argument(name: &'static str) -> Self {
        Self::argument_with_all(name, Vec::new())
    }

    /// An argument of the interface with a value for it.
    pub fn argument_with(name: &'static str, value: impl Into<String>) -> Self {
        Self::argument_with_all(name, vec![value.into()])
    }

    /// An argument of the interface with several values for it.
    pub fn argument_with_all(name: &'static str, values: Vec<String>) -> Self {
        Self::Argument(Argument { name, values })
    }

    /// Two values of a quantity, for "from … to …": with the same decimals, and more than `digits` significant digits if
    /// they would look equal. The unit follows the second one, or both if only one has a power of ten.
    pub fn range(values: [f64; 2], digits: usize, unit: &'static str) -> [Self; 2] {
        let [first, last] = pair(values, distinct_digits(values, digits));
        let mut first = Number::from_text(first, values[0], Cow::Borrowed(unit));
        let last = Number::from_text(last, values[1], Cow::Borrowed(unit));
        first.has_unit &= first.has_power() != last.has_power();
        [first, last].map(Self::Number)
    }

    /// Two values of a quantity, each with its unit, for different parts of a sentence; with more than `digits` significant
    /// digits if they would look equal.
    pub fn distinct(values: [f64; 2], digits: usize, unit: &'static str) -> [Self; 2] {
        let digits = distinct_digits(values, digits);
        values.map(|value| Self::number(value, digits, unit))
    }

    /// A magnitude in s, ms, µs or ns, with three digits.
    pub fn duration(seconds: f64) -> Self {
        let (factor, unit) = unit_of_time(seconds);
        Self::number(seconds.abs() * factor, 3, unit)
    }

    /// Renders the piece as text; `arguments` are written as the interface does.
    pub fn text(&self, arguments: ArgumentStyle) -> Cow<'_, str> {
        match self {
            Self::Text(text) | Self::Key(text) | Self::Field(text) => Cow::Borrowed(text),
            Self::Number(number) | Self::Time(number) => number.plain().into(),
            Self::Estimate(estimate) => estimate.plain().into(),
            Self::Count(Count { count, noun }) => counted(*count, noun).into(),
            Self::Argument(argument) => arguments(argument).into(),
        }
    }
}

impl Estimate {
    fn plain(&self) -> String {
        let text = format!("{} ± {}", self.text, self.error_text);
        if self.has_unit {
            format!("{text} {}", self.unit)
        } else {
            text
        }
    }
}

/// The largest unit in which a time is at least 1, with the factor from seconds.
fn unit_of_time(seconds: f64) -> (f64, &'static str) {
    const UNITS: [(f64, &str); 4] = [(1.0, "s"), (1e3, "ms"), (1e6, "µs"), (1e9, "ns")];
    if seconds == 0.0 {
        return UNITS[0];
    }
    // With three digits, 0.9995 is 1.00.
    *UNITS
        .iter()
        .find(|(factor, _)| seconds.abs() * factor >= 0.9995)
        .unwrap_or(&UNITS[3])
}

/// Renders the piece for readers of no particular interface.
impl Display for Piece {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(Argument::plain))
    }
}

impl From<&str> for Piece {
    fn from(text: &str) -> Self {
        Self::from(text.to_owned())
    }
}

impl From<&String> for Piece {
    fn from(text: &String) -> Self {
        Self::from(text.clone())
    }
}

impl From<String> for Piece {
    fn from(text: String) -> Self {
        Self::Text(text.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(pieces: [Piece; 2]) -> [String; 2] {
        pieces.map(|piece| piece.text(Argument::plain).into_owned())
    }

    #[test]
    fn different_values_are_printed_differently() {
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
            assert_eq!(plain(Piece::range(values, 4, "m")), expected);
        }
        for (values, expected) in [
            ([-0.5, 0.0], ["−0.5000 m", "0 m"]),
            ([0.020_000_1, 0.02], ["0.0200001 m", "0.0200000 m"]),
        ] {
            assert_eq!(plain(Piece::distinct(values, 4, "m")), expected);
        }
    }

    #[test]
    fn durations_have_a_suitable_unit() {
        for (seconds, expected) in [
            (-0.011_554_6, "11.6 ms"),
            (3e-10, "0.300 ns"),
            (0.0, "0 s"),
            (9.9999e-4, "1.00 ms"),
        ] {
            assert_eq!(Piece::duration(seconds).text(Argument::plain), expected);
        }
    }

    #[test]
    fn estimates_have_two_digits_of_their_error() {
        for (value, error, expected) in [
            (0.029_983, 0.000_204, "0.02998 ± 0.00020"),
            (170.02, 0.0996, "170.02 ± 0.10"),
            (1234.5, 15.0, "1234 ± 15"),
        ] {
            let piece = Piece::estimate(value, error, "");
            assert_eq!(piece.text(Argument::plain), expected);
        }
    }
}
