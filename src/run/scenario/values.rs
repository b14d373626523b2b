//! Unvalidated keys and values.

use super::error::ScenarioError;
use super::key::{Key, Kind, Presence, Value, short_number};
use super::keys::KEYS;
use super::laws::{LAWS, Law};
use crate::run::suggestion::{similarity, suggestion, suggestion_from};
use std::collections::BTreeMap;

/// Maximum length of a syntax error, bytes.
const MAX_SYNTAX_LENGTH: usize = 1000;

/// Maximum length of a value quoted in an error, characters.
const MAX_EXCERPT_LENGTH: usize = 100;

/// Keys and type-checked values; combinations are not checked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Values(BTreeMap<&'static str, Value>);

impl Values {
    /// Parses a scenario file and checks each key, but not completeness.
    ///
    /// # Errors
    /// Malformed TOML, an unknown key, a value of the wrong type or out of range.
    pub fn from_toml(text: &str) -> Result<Self, ScenarioError> {
        let table = text.parse().map_err(|error| syntax(text, &error))?;
        let mut values = Self::default();
        values.change(table)?;
        Ok(values)
    }

    /// Sets the keys of a scenario file.
    pub(super) fn change(&mut self, table: toml::Table) -> Result<(), ScenarioError> {
        for (name, value) in table {
            if let toml::Value::Table(section) = value {
                for (inner, value) in section {
                    self.set_value(&format!("{name}.{inner}"), value)?;
                }
            } else {
                self.set_value(&name, value)?;
            }
        }
        Ok(())
    }

    /// Sets one key from `text`, a TOML value whose quotes may be omitted. An empty text removes the key.
    ///
    /// # Errors
    /// An unknown key, a value of the wrong type or out of range.
    pub fn set(&mut self, path: &str, text: &str) -> Result<(), ScenarioError> {
        let key = find_key(path)?;
        if text.is_empty() {
            self.0.remove(key.path);
            return Ok(());
        }
        let value = match format!("value = {text}").parse::<toml::Table>() {
            Ok(mut table) if table.len() == 1 => table.remove("value"),
            _ => None,
        };
        let value = match value {
            Some(value) if value.is_str() || !key.kind.is_text() => value,
            _ if key.kind.is_text() => toml::Value::from(text),
            // Accept numbers such as `.5` and `1.`, which are not valid TOML.
            _ => text
                .parse()
                .map_or_else(|_| toml::Value::from(text), toml::Value::Float),
        };
        self.set_value(path, value)
    }

    /// Sets one key to a number or a string.
    ///
    /// # Errors
    /// An unknown key, a value of the wrong type or out of range.
    pub fn set_value(
        &mut self,
        path: &str,
        value: impl Into<toml::Value>,
    ) -> Result<(), ScenarioError> {
        let key = find_key(path)?;
        self.0.insert(key.path, checked(key, &value.into())?);
        Ok(())
    }

    /// Removes a key that has its default value.
    pub(super) fn remove(&mut self, path: &str) {
        self.0.remove(path);
    }

    /// The value of a key.
    pub fn get(&self, path: &str) -> Option<&Value> {
        self.0.get(path)
    }

    pub(super) fn number(&self, path: &'static str) -> Result<f64, ScenarioError> {
        self.optional_number(path).ok_or_else(|| missing(&[path]))
    }

    pub(super) fn optional_number(&self, path: &str) -> Option<f64> {
        match self.get(path) {
            Some(Value::Number(number)) => Some(*number),
            _ => None,
        }
    }

    pub(super) fn text(&self, path: &'static str) -> Result<&str, ScenarioError> {
        match self.get(path) {
            Some(Value::Text(text)) => Ok(text),
            _ => Err(missing(&[path])),
        }
    }

    /// The error of a key's value.
    pub(super) fn invalid(&self, key: &str, reason: &str) -> ScenarioError {
        let value = self.get(key).map(Value::to_set_notation);
        ScenarioError::of_value(key, &value.unwrap_or_default(), reason)
    }

    /// Checks that required keys are set and inapplicable keys are not.
    pub(super) fn check_presence(&self) -> Result<(), ScenarioError> {
        let mut absent = Vec::new();
        for key in KEYS {
            let there = self.0.contains_key(key.path);
            match key.presence {
                Presence::Required if !there => absent.push(key.path),
                Presence::RequiredWith(other, words) => match self.has_one_of(other, words) {
                    true if !there => absent.push(key.path),
                    false if there => return Err(self.inapplicable(key, other, words)),
                    _ => {}
                },
                Presence::RequiredWithKey(other) if there != self.0.contains_key(other) => {
                    absent.push(if there { other } else { key.path });
                }
                Presence::OptionalWith(other, word)
                    if there && !self.has_one_of(other, &[word]) =>
                {
                    return Err(self.inapplicable(key, other, &[word]));
                }
                Presence::Required
                | Presence::Optional
                | Presence::RequiredWithKey(_)
                | Presence::OptionalWith(..) => {}
            }
        }
        if absent.is_empty() {
            return Ok(());
        }
        Err(missing(&absent))
    }

    /// Whether a key has one of these values.
    fn has_one_of(&self, path: &'static str, words: &[&str]) -> bool {
        self.text(path).is_ok_and(|value| words.contains(&value))
    }

    /// The error for a key that applies only if another key has one of these values.
    fn inapplicable(&self, key: &Key, other: &'static str, words: &[&str]) -> ScenarioError {
        let (key, needed) = (key.path, words.join(" or "));
        let circumstance = match self.text(other) {
            Ok(value) => format!("with {other} = {value:?}"),
            Err(_) => format!("without {other}"),
        };
        ScenarioError(format!(
            "{key} does not apply {circumstance}: set {other} = {needed}, or remove {key} (--set {key}=)"
        ))
    }
}

/// The error for missing keys.
fn missing(paths: &[&'static str]) -> ScenarioError {
    let keys = || KEYS.iter().filter(|key| paths.contains(&key.path));
    let about = |key: &Key| {
        let (path, unit) = (key.path, key.in_unit());
        format!("{path} ({}{unit}: {})", key.meaning, key.kind)
    };
    let mut missing = keys().map(about).collect::<Vec<_>>().join(", ");
    let of_one_law = |law: &&Law| {
        let is_its_own = |key: &Key| matches!(key.presence, Presence::RequiredWith("friction.law", [word]) if *word == law.name);
        keys().any(is_its_own)
    };
    if let Some(law) = LAWS.iter().find(of_one_law) {
        missing += &format!("; typical values: {}", law.typical);
    }
    ScenarioError(format!("missing: {missing}"))
}

/// The key with this path.
pub(crate) fn find_key(path: &str) -> Result<&'static Key, ScenarioError> {
    KEYS.iter().find(|key| key.path == path).ok_or_else(|| {
        let section = path.rsplit_once('.').map(|(section, _)| section);
        let in_section = |key: &&Key| {
            let own = key.path.rsplit_once('.').map(|(section, _)| section);
            section.is_some() && own == section
        };
        let mut allowed: Vec<_> = KEYS.iter().filter(in_section).map(|key| key.path).collect();
        if allowed.is_empty() {
            allowed = KEYS.iter().map(|key| key.path).collect();
        }
        let (key, allowed) = (excerpt(path), allowed.join(", "));
        let hint = key_hint(&key);
        ScenarioError(format!("unknown key {key}{hint}; allowed: {allowed}"))
    })
}

/// The error for invalid TOML.
fn syntax(source: &str, error: &toml::de::Error) -> ScenarioError {
    let text = error.to_string();
    if text.len() <= MAX_SYNTAX_LENGTH {
        return ScenarioError(format!("not valid TOML: {text}"));
    }
    // Omit the source line that the parser repeats, because it is too long.
    let before = error.span().and_then(|span| source.get(..span.start));
    let line = before.map_or(1, |before| 1 + before.matches('\n').count());
    let message = excerpt(error.message());
    ScenarioError(format!("not valid TOML: in line {line}: {message}"))
}

/// A text truncated for a message.
fn excerpt(text: &str) -> String {
    match text.char_indices().nth(MAX_EXCERPT_LENGTH) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// A "did you mean" hint for an unknown key.
fn key_hint(wrong: &str) -> String {
    let has_section = wrong.contains('.');
    let score = |key: &Key| {
        let name = key.path.rsplit_once('.').map(|(_, name)| name);
        let name = name.filter(|_| !has_section).unwrap_or(key.path);
        similarity(wrong, key.path).max(similarity(wrong, name))
    };
    suggestion_from(KEYS.iter().map(|key| (score(key), key.path)))
}

/// Checks type and range of a value.
fn checked(key: &Key, value: &toml::Value) -> Result<Value, ScenarioError> {
    let wrong_type = || {
        let number = value.as_float().map(short_number);
        let text = number.unwrap_or_else(|| value.to_string());
        not_allowed(key, &text, &unit_hint(key, value))
    };
    let value = if key.kind.is_text() {
        Value::Text(value.as_str().ok_or_else(wrong_type)?.to_owned())
    } else {
        let integer = || value.as_integer().map(|number| number as f64);
        Value::Number(value.as_float().or_else(integer).ok_or_else(wrong_type)?)
    };
    let is_allowed = match (key.kind, &value) {
        (Kind::Name, Value::Text(text)) => is_name(text),
        (Kind::Choice(words), Value::Text(text)) => words.contains(&text.as_str()),
        (Kind::Between(low, high), Value::Number(number)) => (low..=high).contains(number),
        (Kind::Nanoseconds, Value::Number(number)) => nanoseconds(*number).is_some(),
        (_, Value::Number(number)) => number.is_finite(),
        (_, Value::Text(_)) => true,
    };
    if is_allowed {
        return Ok(value);
    }
    let text = value.to_set_notation();
    let hint = if let Kind::Choice(words) = key.kind {
        suggestion(&excerpt(&text), words.iter().copied())
    } else {
        String::new()
    };
    Err(not_allowed(key, &text, &hint))
}

/// The error of a value that a key can't have.
fn not_allowed(key: &Key, value: &str, hint: &str) -> ScenarioError {
    let reason = format!("must be {}{}{hint}", key.kind, key.in_unit());
    ScenarioError::of_value(key.path, &excerpt(value), &reason)
}

/// A hint for values in degrees or with a decimal comma; otherwise empty.
fn unit_hint(key: &Key, value: &toml::Value) -> String {
    let text = value.as_str().unwrap_or_default();
    if let [whole, part] = text.split(',').collect::<Vec<_>>()[..]
        && format!("{whole}.{part}").parse::<f64>().is_ok()
    {
        return format!(", with a decimal point, e.g. {whole}.{part}");
    }
    let number = ["°", "deg", "degrees"]
        .iter()
        .find_map(|unit| text.strip_suffix(unit));
    match number.and_then(|number| number.trim().parse::<f64>().ok()) {
        Some(degrees) if key.unit == "rad" => {
            format!(" ({text} is {:.4} rad)", degrees.to_radians())
        }
        _ => String::new(),
    }
}

/// Whether a string is a portable file name that is not hidden.
fn is_name(text: &str) -> bool {
    let allowed = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    !text.is_empty() && text.len() <= 100 && !text.starts_with('.') && text.chars().all(allowed)
}

/// Converts seconds to nanoseconds, if they are a whole number from 1 ns to one hour.
///
/// A decimal number with at most nine places is parsed as the double nearest to `ns / 1e9`, and the division is
/// correctly rounded, so both are equal.
pub(super) fn nanoseconds(seconds: f64) -> Option<u64> {
    let rounded = (seconds * 1e9).round();
    let whole = (1.0..=3.6e12).contains(&rounded) && rounded / 1e9 == seconds;
    whole.then_some(rounded as u64)
}
