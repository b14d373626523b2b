//! Units of measured columns, and the words of which names of columns and units consist.

use super::error::DataError;
use crate::words::sentence;
use std::f64::consts::{PI, TAU};

/// What a column measures, as far as units are concerned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dimension {
    Time,
    Angle,
    AngularRate,
    AngularAcceleration,
    Length,
    Speed,
    Number,
}

/// A unit.
#[derive(Debug, PartialEq)]
pub(super) struct Unit {
    /// Spellings, in lower case; the first one is written in reports.
    pub names: &'static [&'static str],
    pub dimension: Dimension,
    /// Size in SI units.
    pub factor: f64,
}

const fn unit(names: &'static [&'static str], dimension: Dimension, factor: f64) -> Unit {
    Unit {
        names,
        dimension,
        factor,
    }
}

#[rustfmt::skip]
const UNITS: &[Unit] = &[
    unit(&["s", "sec", "secs", "second", "seconds"], Dimension::Time, 1.0),
    unit(&["ms", "msec", "milliseconds"], Dimension::Time, 1e-3),
    unit(&["µs", "μs", "us", "microseconds"], Dimension::Time, 1e-6),
    unit(&["ns", "nanoseconds"], Dimension::Time, 1e-9),
    unit(&["minutes"], Dimension::Time, 60.0),
    unit(&["rad", "radian", "radians"], Dimension::Angle, 1.0),
    unit(&["mrad"], Dimension::Angle, 1e-3),
    unit(&["deg", "°", "degree", "degrees"], Dimension::Angle, PI / 180.0),
    unit(&["rev", "turn", "turns", "revolutions"], Dimension::Angle, TAU),
    unit(&["rad/s", "rad s^-1", "rad·s⁻¹", "rad/sec", "1/s"], Dimension::AngularRate, 1.0),
    unit(&["mrad/s"], Dimension::AngularRate, 1e-3),
    unit(&["deg/s", "°/s", "dps", "deg/sec", "degrees/s"], Dimension::AngularRate, PI / 180.0),
    unit(&["rpm", "rev/min", "1/min"], Dimension::AngularRate, TAU / 60.0),
    unit(&["rev/s", "rps", "hz"], Dimension::AngularRate, TAU),
    unit(&["rad/s²", "rad/s^2", "rad/s2", "rad/s/s"], Dimension::AngularAcceleration, 1.0),
    unit(&["deg/s²", "deg/s^2", "deg/s2", "°/s²", "°/s^2"], Dimension::AngularAcceleration, PI / 180.0),
    unit(&["m"], Dimension::Length, 1.0),
    unit(&["cm"], Dimension::Length, 1e-2),
    unit(&["mm"], Dimension::Length, 1e-3),
    unit(&["m/s"], Dimension::Speed, 1.0),
    unit(&["cm/s"], Dimension::Speed, 1e-2),
    unit(&["mm/s"], Dimension::Speed, 1e-3),
];

impl Unit {
    /// The unit with this name.
    pub(super) fn find(name: &str) -> Option<&'static Self> {
        let lower = name.trim().to_lowercase();
        UNITS.iter().find(|unit| unit.names.contains(&&*lower))
    }

    /// The longest unit with which some tokens begin, and the number of its tokens.
    pub(super) fn beginning(words: &[Token]) -> Option<(&'static Self, usize)> {
        let mut longest: Option<(&'static Self, usize)> = None;
        for unit in UNITS {
            for name in unit.names {
                let spelled = tokens(name);
                let is_longer = longest.is_none_or(|(_, length)| spelled.len() > length);
                if is_longer && words.starts_with(&spelled) {
                    longest = Some((unit, spelled.len()));
                }
            }
        }
        longest
    }

    /// The name in reports.
    pub(super) fn name(&self) -> &'static str {
        self.names[0]
    }
}

impl Dimension {
    /// The dimension of a field with this SI unit.
    pub(super) fn from_si(unit: &str) -> Self {
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

    /// The SI unit; empty for pure numbers.
    pub(super) fn si(self) -> &'static str {
        let mut own = UNITS.iter().filter(|unit| unit.dimension == self);
        own.find(|unit| unit.factor == 1.0).map_or("", Unit::name)
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

    /// The unit of this dimension with a name; `None` for no name, which stands for the SI unit.
    pub(super) fn unit(self, name: &str) -> Result<Option<&'static Unit>, DataError> {
        if name.is_empty() {
            return Ok(None);
        }
        match Unit::find(name) {
            Some(unit) if unit.dimension == self => Ok(Some(unit)),
            Some(_) | None => {
                let units = UNITS.iter().filter(|unit| unit.dimension == self);
                let allowed: Vec<&str> = units.map(Unit::name).collect();
                Err(DataError::new(sentence!(
                    "{} is not a unit of {}; allowed: {}",
                    format!("{name:?}"),
                    self.meaning(),
                    allowed.join(", ")
                )))
            }
        }
    }
}

/// A word in lower case, or a symbol that units have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Token(String);

impl Token {
    pub(super) fn text(&self) -> &str {
        &self.0
    }

    pub(super) fn is_word(&self) -> bool {
        self.0.chars().all(is_word_character)
    }

    pub(super) fn is_number(&self) -> bool {
        self.0.chars().all(|letter| letter.is_ascii_digit())
    }
}

/// Splits a name into words, at changes of case, too, and the symbols that units have.
pub(super) fn tokens(text: &str) -> Vec<Token> {
    const SYMBOLS: [char; 6] = ['/', '^', '°', '·', '⁻', '-'];
    let mut tokens: Vec<Token> = Vec::new();
    let mut before = ' ';
    for letter in text.chars() {
        let is_word = is_word_character(letter);
        let goes_on = is_word
            && is_word_character(before)
            && !(before.is_lowercase() && letter.is_uppercase());
        if !goes_on && (is_word || SYMBOLS.contains(&letter)) {
            tokens.push(Token(String::new()));
        }
        if let Some(Token(token)) = tokens.last_mut()
            && (is_word || SYMBOLS.contains(&letter))
        {
            token.extend(letter.to_lowercase());
        }
        before = letter;
    }
    tokens
}

/// Whether a character is part of a word: a letter, a digit, or a dot above a letter.
fn is_word_character(letter: char) -> bool {
    letter.is_alphanumeric() || ('\u{300}'..='\u{36f}').contains(&letter)
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
    fn splits_numbers_from_units() {
        assert_eq!(split_number("2mrad"), Some((2.0, "mrad")));
        assert_eq!(split_number("1e-3"), Some((1e-3, "")));
        assert_eq!(split_number("-0.5 deg/s"), Some((-0.5, "deg/s")));
        assert_eq!(split_number("abc"), None);
    }

    #[test]
    fn refuses_units_of_another_dimension() {
        let degrees = Dimension::Angle.unit("deg").unwrap().unwrap();
        assert!((180.0 * degrees.factor - PI).abs() < 1e-15);
        let error = Dimension::Angle.unit("rpm").unwrap_err().to_string();
        assert!(error.contains("\"rpm\" is not a unit of angle"), "{error}");
        assert!(error.contains("deg"), "{error}");
        assert_eq!(Dimension::AngularRate.si(), "rad/s");
        assert_eq!(Dimension::Number.si(), "");
    }
}
