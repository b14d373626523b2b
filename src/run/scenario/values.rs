//! Unvalidated keys and values.

use super::error::{Problem, ScenarioError, excerpt};
use super::key::{Key, Presence, Value};
use super::keys::KEYS;
use super::laws::{FORMULA, LAWS, Law};
use super::parse::{check_value, parse_value};
use crate::physics::formula::{Formula, FormulaError, FormulaProblem};
use crate::run::suggestion::{most_similar, similar_names, similarity};
use std::collections::BTreeMap;

/// Maximum length of a syntax error, bytes.
const MAX_SYNTAX_LENGTH: usize = 1000;

/// Whether a key has to be set, given the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Need {
    Required,
    Optional,
    Excluded,
}

/// Keys and type-checked values; combinations are not checked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Values(BTreeMap<&'static str, Value>);

impl Values {
    /// Parses a scenario file and checks each key, but not completeness.
    ///
    /// # Errors
    /// Malformed TOML, an unknown key, a value of the wrong type or out of range.
    pub fn from_toml(text: &str) -> Result<Self, ScenarioError> {
        let table = text.parse().map_err(|error| syntax_error(text, &error))?;
        let mut values = Self::default();
        values.merge(table)?;
        Ok(values)
    }

    /// Sets the keys of a scenario file.
    pub(super) fn merge(&mut self, table: toml::Table) -> Result<(), ScenarioError> {
        for (name, value) in table {
            if let toml::Value::Table(section) = value {
                // Keys have one section; a table in it is refused as a value.
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
        self.set_value(path, parse_value(key, text))
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
        self.0.insert(key.path, check_value(key, &value.into())?);
        Ok(())
    }

    /// Sets a key to a value that was checked.
    pub(super) fn insert(&mut self, key: &Key, value: Value) {
        self.0.insert(key.path, value);
    }

    /// Removes a key.
    pub(super) fn remove(&mut self, path: &str) {
        self.0.remove(path);
    }

    /// The value of a key.
    pub fn get(&self, path: &str) -> Option<&Value> {
        self.0.get(path)
    }

    /// Whether a key is set.
    pub(super) fn has(&self, path: &str) -> bool {
        self.0.contains_key(path)
    }

    /// The first of some keys that is set.
    pub(super) fn first_set(&self, paths: [&'static str; 2]) -> Option<&'static str> {
        paths.into_iter().find(|path| self.has(path))
    }

    /// The number of a key that is required.
    pub(super) fn required_number(&self, path: &'static str) -> Result<f64, ScenarioError> {
        self.optional_number(path)
            .ok_or_else(|| missing_keys(&[path]))
    }

    /// The number of a key, if it is set.
    pub(super) fn optional_number(&self, path: &str) -> Option<f64> {
        match self.get(path) {
            Some(Value::Number(number)) => Some(*number),
            Some(Value::Text(_)) | None => None,
        }
    }

    /// The number of an optional key whose default is 0.
    pub(super) fn number_or_zero(&self, path: &str) -> f64 {
        self.optional_number(path).unwrap_or_default()
    }

    /// The text of a key that is required.
    pub(super) fn required_text(&self, path: &'static str) -> Result<&str, ScenarioError> {
        self.optional_text(path)
            .ok_or_else(|| missing_keys(&[path]))
    }

    /// The text of a key, if it is set.
    pub(super) fn optional_text(&self, path: &str) -> Option<&str> {
        match self.get(path) {
            Some(Value::Text(text)) => Some(text),
            Some(Value::Number(_)) | None => None,
        }
    }

    /// The meaning of the word of a key, if it is set.
    pub(super) fn optional_choice<T>(
        &self,
        path: &'static str,
        find: fn(&str) -> Option<T>,
    ) -> Result<Option<T>, ScenarioError> {
        let Some(word) = self.optional_text(path) else {
            return Ok(None);
        };
        match find(word) {
            Some(meaning) => Ok(Some(meaning)),
            None => Err(self.not_allowed(path)),
        }
    }

    /// The meaning of the word of a key.
    pub(super) fn choice<T>(
        &self,
        path: &'static str,
        find: fn(&str) -> Option<T>,
    ) -> Result<T, ScenarioError> {
        self.optional_choice(path, find)?
            .ok_or_else(|| missing_keys(&[path]))
    }

    /// The error of a value that the key can never have.
    pub(super) fn not_allowed(&self, path: &str) -> ScenarioError {
        match find_key(path) {
            Ok(key) => self.invalid(path, Problem::not_allowed(key, None)),
            Err(error) => error,
        }
    }

    /// The error of a key's value.
    pub(super) fn invalid(&self, path: &str, problem: Problem) -> ScenarioError {
        match self.get(path) {
            Some(value) => ScenarioError::with_value(path, &value.to_set_notation(), problem),
            None => ScenarioError::with_key(path, problem),
        }
    }

    /// Checks that required keys are set and inapplicable keys are not.
    pub(super) fn check_presence(&self) -> Result<(), ScenarioError> {
        let mut absent = Vec::new();
        let formula = self.formula()?;
        for key in KEYS {
            let is_set = self.has(key.path);
            match self.need(key, formula.as_ref()) {
                Need::Required if !is_set => absent.push(key.path),
                Need::Excluded if is_set => {
                    let Presence::RequiredWithKey(other) = key.presence else {
                        return Err(self.inapplicable(key));
                    };
                    absent.push(other);
                }
                Need::Required | Need::Optional | Need::Excluded => {}
            }
        }
        if absent.is_empty() {
            return Ok(());
        }
        Err(missing_keys(&absent))
    }

    /// Whether a key has to be set; `formula` is that of the friction law, if it has one.
    pub(super) fn need(&self, key: &Key, formula: Option<&Formula>) -> Need {
        let is_law = |words: &[&str]| self.has_one_of("friction.law", words);
        let (required, optional) = match key.presence {
            Presence::Required => (true, true),
            Presence::Optional => (false, true),
            Presence::RequiredWith(other, words) => (self.has_one_of(other, words), false),
            Presence::RequiredWithKey(other) => (self.has(other), false),
            Presence::OptionalWith(other, words) => (false, self.has_one_of(other, words)),
            Presence::OfLaws(required, optional) => (is_law(required), is_law(optional)),
            Presence::Parameter(laws) => {
                let applies = formula.is_none_or(|formula| formula.uses(key.name()));
                (applies && is_law(laws), false)
            }
        };
        match (required, optional) {
            (true, _) => Need::Required,
            (false, true) => Need::Optional,
            (false, false) => Need::Excluded,
        }
    }

    /// The formula of the friction law, if it has one.
    pub(super) fn formula(&self) -> Result<Option<Formula>, ScenarioError> {
        if !self.has_one_of("friction.law", FORMULA) {
            return Ok(None);
        }
        let text = self.required_text("friction.formula")?;
        Formula::parse(text)
            .map(Some)
            .map_err(|error| self.invalid_formula(error))
    }

    /// The error of the formula.
    pub(super) fn invalid_formula(&self, error: FormulaError) -> ScenarioError {
        let mut similar = Vec::new();
        if let FormulaProblem::UnknownName(name) = &error.problem {
            similar = similar_names(&excerpt(name), Formula::names());
        }
        self.invalid("friction.formula", Problem::Formula { error, similar })
    }

    /// Whether a key has one of these values.
    pub(super) fn has_one_of(&self, path: &str, words: &[&str]) -> bool {
        self.optional_text(path)
            .is_some_and(|value| words.contains(&value))
    }

    /// The error for a key that doesn't apply with the others.
    fn inapplicable(&self, key: &Key) -> ScenarioError {
        let (other, needed) = match key.presence {
            Presence::RequiredWith(other, words) | Presence::OptionalWith(other, words) => {
                (other, vec![words])
            }
            Presence::OfLaws(required, optional) => ("friction.law", vec![required, optional]),
            Presence::Parameter(_) if self.has_one_of("friction.law", FORMULA) => {
                return ScenarioError::with_key(key.path, Problem::NotInFormula);
            }
            Presence::Parameter(laws) => ("friction.law", vec![laws]),
            // The other key is missing instead.
            Presence::RequiredWithKey(other) => (other, Vec::new()),
            Presence::Required | Presence::Optional => ("", Vec::new()),
        };
        let problem = Problem::Inapplicable {
            other,
            current: self.optional_text(other).map(str::to_owned),
            needed: needed.concat(),
        };
        ScenarioError::with_key(key.path, problem)
    }
}

/// The error for missing keys.
fn missing_keys(paths: &[&'static str]) -> ScenarioError {
    let keys: Vec<&'static Key> = KEYS
        .iter()
        .filter(|key| paths.contains(&key.path))
        .collect();
    let typical = LAWS
        .iter()
        .find(|law| keys.iter().any(|key| is_only_of(key, law)))
        .map(|law| law.typical);
    ScenarioError {
        key: keys.first().map(|key| key.path.to_owned()),
        value: None,
        problem: Box::new(Problem::Missing { keys, typical }),
    }
}

/// Whether a key is a parameter of this friction law and of no other.
fn is_only_of(key: &Key, law: &Law) -> bool {
    matches!(key.presence, Presence::RequiredWith("friction.law", [word]) if *word == law.name)
}

/// The key with this path.
pub(crate) fn find_key(path: &str) -> Result<&'static Key, ScenarioError> {
    KEYS.iter()
        .find(|key| key.path == path)
        .ok_or_else(|| unknown_key(path))
}

/// The error for a key that scenarios don't have.
fn unknown_key(path: &str) -> ScenarioError {
    let key = excerpt(path);
    let mut allowed: Vec<_> = match path.rsplit_once('.') {
        Some((section, _)) => KEYS
            .iter()
            .filter(|key| key.section() == section)
            .map(|key| key.path)
            .collect(),
        None => Vec::new(),
    };
    if allowed.is_empty() {
        allowed = KEYS.iter().map(|key| key.path).collect();
    }
    let similar = similar_keys(&key);
    ScenarioError::with_key(path, Problem::UnknownKey { similar, allowed })
}

/// Keys similar to an unknown one; those of its section, if it has one. Tables have `_` for the dots of paths.
fn similar_keys(wrong: &str) -> Vec<&'static str> {
    let has_section = wrong.contains('.');
    let column = wrong.replace('.', "_");
    most_similar(KEYS.iter().map(|key| {
        // With a section, only the whole path counts: `top.k` is no misspelling of `friction.k`.
        let whole = similarity(&column, &key.path.replace('.', "_"));
        let score = if has_section {
            whole
        } else {
            whole.max(similarity(wrong, key.name()))
        };
        (score, key.path)
    }))
}

/// The error for invalid TOML.
fn syntax_error(source: &str, error: &toml::de::Error) -> ScenarioError {
    let text = error.to_string();
    let message = if text.len() <= MAX_SYNTAX_LENGTH {
        text
    } else {
        // Omit the source line that the parser repeats, because it is too long.
        let before = error.span().and_then(|span| source.get(..span.start));
        let line = before.map_or(1, |before| 1 + before.matches('\n').count());
        format!("in line {line}: {}", excerpt(error.message()))
    };
    ScenarioError::without_key(Problem::Syntax(message))
}
