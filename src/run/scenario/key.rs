//! Scenario keys: name, unit and allowed values.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Value of a key of a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// Text.
    Text(String),
    /// A number in SI units or radians.
    Number(f64),
}

impl fmt::Display for Value {
    /// As TOML.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(text) => write!(f, "{}", toml::Value::from(text.as_str())),
            // `Debug` writes a point or an exponent in every number, so TOML reads a float again.
            Self::Number(number) => write!(f, "{number:?}"),
        }
    }
}

impl Value {
    /// The value in `--set` notation: text without quotes, numbers like `1e-10`.
    pub fn to_set_notation(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Number(number) => short_number(*number),
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

/// A number in short notation, e.g. `1e-10`.
pub(in crate::run) fn short_number(number: f64) -> String {
    let size = number.abs();
    if size == 0.0 || (1e-3..1e15).contains(&size) {
        number.to_string()
    } else {
        format!("{number:e}")
    }
}

/// A usual formula: Coulomb's law, smoothed around zero slip.
pub(super) const EXAMPLE_FORMULA: &str = "k*tanh(v/a)";

/// Allowed values of a key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Any text.
    Text,
    /// A portable file name.
    Name,
    /// A formula: [`Formula`](crate::physics::formula::Formula).
    Formula,
    /// One of these strings.
    Choice(&'static [&'static str]),
    /// Any finite number.
    Any,
    /// A number in this closed interval.
    Between(f64, f64),
    /// A whole number of nanoseconds from 1 ns to one hour, in seconds.
    Nanoseconds,
}

impl Kind {
    /// Whether the values are text rather than numbers.
    pub fn is_text(self) -> bool {
        matches!(
            self,
            Self::Text | Self::Name | Self::Formula | Self::Choice(_)
        )
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
            Self::Formula => write!(
                f,
                "a formula of v, k, a, b, c and d, e.g. {EXAMPLE_FORMULA}"
            ),
            Self::Choice(words) => write!(f, "one of {}", words.join(", ")),
            Self::Any => write!(f, "a finite number"),
            Self::Between(low, high) => {
                let [low, high] = [low, high].map(|limit| short_number(*limit));
                write!(f, "a number from {low} to {high}")
            }
            Self::Nanoseconds => write!(f, "a time in whole nanoseconds from 1e-9 to 3600"),
        }
    }
}

/// Requirement of a key: required, optional, or dependent on another key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Presence {
    /// Always.
    Required,
    /// Never required.
    Optional,
    /// Required if another key has one of these values; otherwise not allowed.
    RequiredWith(&'static str, &'static [&'static str]),
    /// Required if this other key is set; otherwise not allowed.
    RequiredWithKey(&'static str),
    /// Optional if another key has one of these values; otherwise not allowed.
    OptionalWith(&'static str, &'static [&'static str]),
    /// Required with the first of these friction laws, optional with the second ones; otherwise not allowed.
    OfLaws(&'static [&'static str], &'static [&'static str]),
    /// Required with these friction laws, with a formula if it contains the name of the key; otherwise not allowed.
    Parameter(&'static [&'static str]),
}

/// A row of the table of keys.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// Section and name, e.g. `top.mass`; top-level keys have no section.
    pub path: &'static str,
    /// Unit; may be empty.
    pub unit: &'static str,
    /// Allowed values.
    pub kind: Kind,
    /// Requirement of the key.
    pub presence: Presence,
    /// Description.
    pub meaning: &'static str,
    /// The beginning of the description, without the symbol: next to a control, for which there is little room.
    pub label: &'static str,
    /// Symbol in formulas and figures, e.g. `v_0`.
    pub symbol: Option<&'static str>,
    /// Typical range, used for sliders; `None` for text and choices.
    pub typical: Option<[f64; 2]>,
    /// The word that applies where an optional choice is not set; `None` for other keys.
    pub default: Option<&'static str>,
}

impl Key {
    /// Sets the typical range.
    pub(super) const fn typically(self, low: f64, high: f64) -> Self {
        Self {
            typical: Some([low, high]),
            ..self
        }
    }

    /// Sets the label.
    pub(super) const fn named(self, label: &'static str) -> Self {
        Self { label, ..self }
    }

    /// Sets the symbol.
    pub(super) const fn denoted(self, symbol: &'static str) -> Self {
        Self {
            symbol: Some(symbol),
            ..self
        }
    }

    /// Sets the word that applies where the key is not set.
    pub(super) const fn or(self, default: &'static str) -> Self {
        Self {
            default: Some(default),
            ..self
        }
    }

    /// The section, e.g. `top`; empty for top-level keys.
    pub fn section(&self) -> &'static str {
        self.path
            .rsplit_once('.')
            .map_or("", |(section, _)| section)
    }

    /// The name without section, e.g. `mass`.
    pub fn name(&self) -> &'static str {
        self.path
            .rsplit_once('.')
            .map_or(self.path, |(_, name)| name)
    }

    /// Whether the typical range spans decades, so that a slider should be logarithmic.
    pub fn is_logarithmic(&self) -> bool {
        self.typical
            .is_some_and(|[low, high]| low > 0.0 && high >= 50.0 * low)
    }

    /// The unit in brackets with a leading space, or an empty string.
    pub fn in_unit(&self) -> String {
        match self.unit {
            "" => String::new(),
            unit => format!(" [{unit}]"),
        }
    }
}
