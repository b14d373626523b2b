//! Keys of a scenario: name, its unit, and the values that it takes.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Value of a key of a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// A name, a choice or a text.
    Text(String),
    /// A number in SI units or radians.
    Number(f64),
}

impl fmt::Display for Value {
    /// As TOML.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(text) => write!(f, "{}", toml::Value::from(text.as_str())),
            Self::Number(number) => write!(f, "{number:?}"),
        }
    }
}

impl Value {
    /// The value as one would type it in `--set`: a word without quotes, a number without rows of zeros.
    #[must_use]
    pub fn typed(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Number(number) => typed(*number),
        }
    }
}

impl From<Value> for toml::Value {
    fn from(value: Value) -> Self {
        match value {
            Value::Text(text) => Self::from(text),
            Value::Number(number) => Self::from(number),
        }
    }
}

/// A number as one would type it: without rows of zeros.
pub(super) fn typed(number: f64) -> String {
    let size = number.abs();
    if size == 0.0 || (1e-3..1e15).contains(&size) {
        number.to_string()
    } else {
        format!("{number:e}")
    }
}

/// Which values a key takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Any text.
    Text,
    /// A word that can be part of a file's name.
    Name,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// Any finite number.
    Any,
    /// A finite number not less than the first and not larger than the second.
    Between(f64, f64),
    /// A whole number of nanoseconds from 1 ns to one hour, in seconds.
    Nanoseconds,
}

impl Kind {
    /// Whether the values are texts; otherwise they are numbers.
    #[must_use]
    pub fn is_text(self) -> bool {
        matches!(self, Self::Text | Self::Name | Self::Choice(_))
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text => write!(f, "a text"),
            Self::Name => write!(
                f,
                "a name of at most 100 letters, digits, '-', '_' and '.', not beginning with '.'"
            ),
            Self::Choice(words) => write!(f, "one of {}", words.join(", ")),
            Self::Any => write!(f, "a finite number"),
            Self::Between(low, high) => {
                write!(f, "a number from {} to {}", typed(*low), typed(*high))
            }
            Self::Nanoseconds => write!(f, "a time in whole nanoseconds from 1e-9 to 3600"),
        }
    }
}

/// The condition under which a scenario has to, or may, have a key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Presence {
    /// Always.
    Required,
    /// May be left out.
    Optional,
    /// Exactly when another key has one of these values.
    With(&'static str, &'static [&'static str]),
    /// Exactly when this other key is there.
    Beside(&'static str),
    /// Only when another key has this value; may be left out then too.
    OptionalWith(&'static str, &'static str),
}

/// One row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// The section and name, as in `top.mass`; a name alone stands before the first section.
    pub path: &'static str,
    /// Unit, empty where there is none.
    pub unit: &'static str,
    /// Allowed values.
    pub kind: Kind,
    /// The condition under which it is there.
    pub presence: Presence,
    /// Its meaning.
    pub meaning: &'static str,
    /// The values from which one would choose, in its unit, as a slider has them; none for words and texts.
    pub typical: Option<[f64; 2]>,
}

impl Key {
    /// With this range to choose from.
    pub(super) const fn typically(self, low: f64, high: f64) -> Self {
        Self {
            typical: Some([low, high]),
            ..self
        }
    }

    /// Whether the range to choose from spans decades, so that a slider is logarithmic.
    #[must_use]
    pub fn is_logarithmic(&self) -> bool {
        self.typical
            .is_some_and(|[low, high]| low > 0.0 && high >= 50.0 * low)
    }

    /// The symbol that its meaning gives it, as in `v_0`; none if it has none. What ends a run has that of another quantity.
    #[must_use]
    pub fn symbol(&self) -> Option<&'static str> {
        let is_symbol = |word: &&str| {
            let mut letters = word.chars();
            let is_letter = letters.next().is_some_and(char::is_alphabetic);
            let rest = letters.as_str();
            is_letter && (rest.is_empty() || rest.starts_with('_') || rest == "\u{307}")
        };
        let is_end = self.path.starts_with("stop.");
        let mut words = self.meaning.split_whitespace();
        words
            .find(is_symbol)
            .filter(|_| !is_end && !self.kind.is_text())
    }

    /// Its unit in brackets, after a space; empty if it has none.
    #[must_use]
    pub fn in_unit(&self) -> String {
        match self.unit {
            "" => String::new(),
            unit => format!(" [{unit}]"),
        }
    }
}
