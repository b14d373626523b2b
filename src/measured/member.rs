//! Members of JSON messages.

use super::error::DataError;
use super::name::{ColumnName, unit_of};
use super::text::cut;
use super::unit::{Dimension, Unit};
use serde_json::Value as Json;
use thiserror::Error;

/// The path of a member: names from the outside in. The last one may have a unit as in a header.
pub(super) struct MemberPath(Vec<String>);

/// Why a member of a JSON message is no number.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub(super) enum Lack {
    /// There is no such member, or it has members itself.
    #[error("the messages have: {}", known.join(", "))]
    Absent {
        /// Paths of the members where it should be.
        known: Vec<String>,
    },
    #[error("they are texts, e.g. {0:?}, not numbers")]
    Text(String),
    #[error("they are null")]
    Null,
    #[error("the messages are no JSON")]
    NoJson,
    #[error("they are true or false, not numbers")]
    Boolean,
}

/// A time in a message.
pub(super) enum Stamp {
    /// Since some epoch, ns.
    Nanoseconds(i128),
    Seconds(f64),
}

impl MemberPath {
    pub(super) fn parse(text: &str) -> Self {
        Self(text.split('.').map(str::to_owned).collect())
    }

    fn last(&self) -> &str {
        self.0.last().map_or("", String::as_str)
    }

    /// The stated unit, which must be of a dimension.
    pub(super) fn unit(&self, dimension: Dimension) -> Result<Option<&'static Unit>, DataError> {
        dimension.unit(unit_of(self.last()))
    }

    /// Whether it is the path of the same member, also if only one of them has a unit.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        self.0.len() == other.0.len()
            && self
                .0
                .iter()
                .zip(&other.0)
                .all(|(a, b)| a == b || ColumnName::parse(a).is_called(&ColumnName::parse(b)))
    }

    /// The value in a message.
    fn find<'a>(&self, message: &'a Json) -> Result<&'a Json, Lack> {
        let mut value = message;
        for (depth, name) in self.0.iter().enumerate() {
            value = step(value, name).ok_or_else(|| Lack::Absent {
                known: member_names(value, &self.0[..depth]),
            })?;
        }
        Ok(value)
    }

    /// The number in a message.
    pub(super) fn number(&self, message: &Json) -> Result<f64, Lack> {
        match self.find(message)? {
            Json::Number(number) => number.as_f64().ok_or(Lack::Null),
            Json::Null => Err(Lack::Null),
            Json::String(text) => Err(Lack::Text(cut(text))),
            Json::Bool(_) => Err(Lack::Boolean),
            value @ (Json::Object(_) | Json::Array(_)) => Err(Lack::Absent {
                known: member_names(value, &self.0),
            }),
        }
    }

    /// The time in a message: a number, or an object such as `{"sec": 1, "nsec": 500}`.
    pub(super) fn time(&self, message: &Json, unit: Option<&Unit>) -> Result<Stamp, Lack> {
        let value = self.find(message)?;
        if let Json::Object(members) = value {
            let part = |names: &[&str]| names.iter().find_map(|name| members.get(*name)?.as_i64());
            let whole = part(&["sec", "secs", "seconds"]);
            let fraction = part(&["nsec", "nsecs", "nanosec", "nanoseconds"]);
            if let (Some(whole), Some(fraction)) = (whole, fraction) {
                let whole = i128::from(whole) * 1_000_000_000;
                return Ok(Stamp::Nanoseconds(whole + i128::from(fraction)));
            }
        }
        // As a double, nanoseconds since 1970 would be right to 256 ns.
        if let (Some(ticks), Some(unit)) = (value.as_i64(), unit) {
            let length = (unit.factor * 1e9).round() as i128;
            return Ok(Stamp::Nanoseconds(i128::from(ticks) * length));
        }
        let factor = unit.map_or(1.0, |unit| unit.factor);
        Ok(Stamp::Seconds(factor * self.number(message)?))
    }
}

/// The member of a value. A name that no member has may be that of one with a unit added.
fn step<'a>(value: &'a Json, name: &str) -> Option<&'a Json> {
    match value {
        Json::Object(members) => members.get(name).or_else(|| {
            let given = ColumnName::parse(name);
            let mut members = members.iter();
            let (_, member) = members.find(|(key, _)| ColumnName::parse(key).is_called(&given))?;
            Some(member)
        }),
        Json::Array(items) => {
            let index = name.split([' ', '(', '[']).next()?;
            items.get(index.parse::<usize>().ok()?)
        }
        Json::Null | Json::Bool(_) | Json::Number(_) | Json::String(_) => None,
    }
}

/// Names of the members of a value, below the members `outer`.
pub(super) fn member_names(value: &Json, outer: &[String]) -> Vec<String> {
    /// Maximum number of names: messages may have thousands of members.
    const MAX_NAMES: usize = 20;
    let inner: Vec<String> = match value {
        Json::Object(members) => members.keys().take(MAX_NAMES).cloned().collect(),
        Json::Array(items) => (0..items.len().min(MAX_NAMES))
            .map(|index| index.to_string())
            .collect(),
        Json::Null | Json::Bool(_) | Json::Number(_) | Json::String(_) => Vec::new(),
    };
    inner
        .into_iter()
        .map(|name| [outer, &[name]].concat().join("."))
        .collect()
}

/// Reads a message, in which Python may have written NaN for a missing value.
pub(super) fn parse(message: &[u8]) -> Option<Json> {
    serde_json::from_slice(message).ok().or_else(|| {
        let text = std::str::from_utf8(message).ok()?;
        serde_json::from_str(&with_null(text)).ok()
    })
}

/// A JSON text with null for each NaN outside strings.
fn with_null(text: &str) -> String {
    let mut replaced = String::new();
    // Texts between quotes are every other part; an escaped quote does not end one.
    let mut is_string = false;
    let mut is_escaped = false;
    let mut rest = text;
    while let Some(letter) = rest.chars().next() {
        if !is_string && rest.starts_with("NaN") {
            replaced += "null";
            rest = &rest[3..];
            continue;
        }
        is_string ^= letter == '"' && !is_escaped;
        is_escaped = letter == '\\' && !is_escaped;
        replaced.push(letter);
        rest = &rest[letter.len_utf8()..];
    }
    replaced
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_nan_as_null() {
        let message = parse(br#"{"note": "a \"NaN\"", "tilt": NaN, "az": 1}"#).unwrap();
        assert_eq!(message["note"], "a \"NaN\"");
        assert_eq!(message["tilt"], Json::Null);
        assert!(parse(b"{bad").is_none());
        assert!(parse(br#"{"tilt": Infinity}"#).is_none());
    }

    #[test]
    fn reads_times_of_any_kind() {
        let message = parse(
            br#"{"stamp": {"sec": 1700000000, "nsec": 5}, "ms": 1700000000123, "t": 0.5, "x": "a"}"#,
        )
        .unwrap();
        for (path, unit, expected) in [
            ("stamp", None, Some(1_700_000_000_000_000_005_i128)),
            ("ms", Unit::find("ms"), Some(1_700_000_000_123_000_000)),
        ] {
            let Ok(Stamp::Nanoseconds(time)) = MemberPath::parse(path).time(&message, unit) else {
                panic!("{path}");
            };
            assert_eq!(Some(time), expected, "{path}");
        }
        let time = MemberPath::parse("t").time(&message, Unit::find("ms"));
        assert!(matches!(time, Ok(Stamp::Seconds(time)) if time == 0.5e-3));
        assert!(MemberPath::parse("x").time(&message, None).is_err());
    }
}
