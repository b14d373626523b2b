//! Values of keys: parsed and checked one by one.

use super::error::{Hint, Problem, ScenarioError, excerpt};
use super::key::{Key, Kind, Value, short_number};
use crate::run::suggestion::similar_names;

/// Parses a TOML value whose quotes may be omitted. What isn't valid is returned as text, for the error message.
pub(super) fn parse_value(key: &Key, text: &str) -> toml::Value {
    // Only a text in quotes is one in TOML: any other is what it says, however long it is.
    if key.kind.is_text() && !text.trim_start().starts_with(['"', '\'']) {
        return toml::Value::from(text);
    }
    let parsed = match format!("value = {text}").parse::<toml::Table>() {
        // A text with line breaks could hold more keys.
        Ok(mut table) if table.len() == 1 => table.remove("value"),
        Ok(_) | Err(_) => None,
    };
    match parsed {
        Some(value) => value,
        None if key.kind.is_text() => toml::Value::from(text),
        // Accept numbers such as `.5` and `1.`, which are not valid TOML.
        None => text
            .parse()
            .map_or_else(|_| toml::Value::from(text), toml::Value::Float),
    }
}

/// Checks type and range of a value.
pub(super) fn check_value(key: &Key, value: &toml::Value) -> Result<Value, ScenarioError> {
    let typed = typed_value(key, value).ok_or_else(|| wrong_type(key, value))?;
    if is_allowed(key.kind, &typed) {
        return Ok(typed);
    }
    let text = typed.to_set_notation();
    let hint = match key.kind {
        Kind::Choice(words) => Hint::similar(similar_names(&excerpt(&text), words.iter().copied())),
        Kind::Text
        | Kind::Name
        | Kind::Formula
        | Kind::Any
        | Kind::Between(..)
        | Kind::Nanoseconds => None,
    };
    Err(ScenarioError::with_value(
        key.path,
        &text,
        Problem::not_allowed(key, hint),
    ))
}

/// The value as the type of the key: text or number.
fn typed_value(key: &Key, value: &toml::Value) -> Option<Value> {
    if key.kind.is_text() {
        return Some(Value::Text(value.as_str()?.to_owned()));
    }
    // People write `1` for `1.0`, which TOML tells apart.
    let whole = value.as_integer().map(|number| number as f64);
    value.as_float().or(whole).map(Value::Number)
}

/// The error of a value of the wrong type.
fn wrong_type(key: &Key, value: &toml::Value) -> ScenarioError {
    let text = value
        .as_float()
        .map_or_else(|| value.to_string(), short_number);
    let problem = Problem::not_allowed(key, unit_hint(key, value));
    ScenarioError::with_value(key.path, &text, problem)
}

/// Whether a value is one of those that a key may have.
pub(super) fn is_allowed(kind: Kind, value: &Value) -> bool {
    match value {
        Value::Text(text) => match kind {
            // A formula has to be parsed with its parameters.
            Kind::Text | Kind::Formula => true,
            Kind::Name => is_name(text),
            Kind::Choice(words) => words.contains(&text.as_str()),
            Kind::Any | Kind::Between(..) | Kind::Nanoseconds => false,
        },
        Value::Number(number) => match kind {
            Kind::Any => number.is_finite(),
            Kind::Between(low, high) => (low..=high).contains(number),
            Kind::Nanoseconds => nanoseconds(*number).is_some(),
            Kind::Text | Kind::Name | Kind::Formula | Kind::Choice(_) => false,
        },
    }
}

/// A hint for values in degrees or with a decimal comma.
fn unit_hint(key: &Key, value: &toml::Value) -> Option<Hint> {
    let text = value.as_str()?;
    if let Some((whole, part)) = text.split_once(',') {
        let number = format!("{whole}.{part}");
        if number.parse::<f64>().is_ok() {
            return Some(Hint::DecimalPoint(number));
        }
    }
    if key.unit != "rad" {
        return None;
    }
    let number = ["°", "deg", "degrees"]
        .iter()
        .find_map(|unit| text.strip_suffix(unit))?;
    let degrees: f64 = number.trim().parse().ok()?;
    Some(Hint::Degrees {
        text: excerpt(text),
        radians: degrees.to_radians(),
    })
}

/// Whether a string is a portable file name that is not hidden.
fn is_name(text: &str) -> bool {
    !text.is_empty() && text.len() <= 100 && !text.starts_with('.') && text.chars().all(is_portable)
}

/// Whether file names on every system may have this character.
fn is_portable(character: char) -> bool {
    character.is_ascii_alphanumeric() || matches!(character, '-' | '_' | '.')
}

/// Converts seconds to nanoseconds, if they are a whole number from 1 ns to one hour.
///
/// A decimal number with at most nine places is parsed as the double nearest to `ns / 1e9`, and the division is
/// correctly rounded, so both are equal.
pub(super) fn nanoseconds(seconds: f64) -> Option<u64> {
    let rounded = (seconds * 1e9).round();
    let is_whole = (1.0..=3.6e12).contains(&rounded) && rounded / 1e9 == seconds;
    is_whole.then_some(rounded as u64)
}
