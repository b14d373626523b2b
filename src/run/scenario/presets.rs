//! Built-in scenarios: the paper's run and its variations.

use super::definition::Scenario;
use super::error::{Problem, ScenarioError};
use super::key::{Key, Value};
use super::keys::KEYS;
use super::values::Values;
use crate::run::suggestion::similar_names;
use serde::Deserialize;
use std::collections::HashMap;
use std::sync::LazyLock;

/// The paper's run (V. Tanrıverdi, arXiv:2204.14060, section 3): the base of all presets.
const PAPER: &str = include_str!("paper.toml");

/// The presets, as `[[preset]]` with the keys that differ.
const PRESETS_FILE: &str = include_str!("presets.toml");

/// A named scenario: the paper's with some keys changed.
#[derive(Debug, Deserialize)]
pub struct Preset {
    /// The name, which is the scenario's `name`.
    pub name: String,
    /// The title, for readers who don't type names.
    pub title: String,
    /// The description.
    pub description: String,
    /// Keys of the paper's scenario that it does not have.
    #[serde(default)]
    without: Vec<String>,
    /// Keys that it adds or changes, as in a scenario file.
    #[serde(flatten)]
    changes: toml::Table,
}

/// All presets.
pub static PRESETS: LazyLock<Vec<Preset>> = LazyLock::new(|| {
    let mut file: HashMap<String, Vec<Preset>> =
        toml::from_str(PRESETS_FILE).expect("the presets of this program are valid");
    file.remove("preset").unwrap_or_default()
});

impl Scenario {
    /// The keys that differ from those of `from`, with their values (`None` if removed). Name and description are
    /// ignored.
    pub fn changes<'a>(
        &'a self,
        from: &'a Values,
    ) -> impl Iterator<Item = (&'static Key, Option<&'a Value>)> {
        KEYS.iter()
            // They say nothing about the motion.
            .filter(|key| !matches!(key.path, "format" | "name" | "description"))
            .map(|key| (key, self.value(key.path)))
            .filter(|(key, value)| *value != from.get(key.path))
    }

    /// The name, followed by up to two keys that differ from the preset of that name, e.g. `paper, friction.k = 0.02`.
    pub fn title(&self) -> String {
        match self.preset_values() {
            Some(preset) => self.title_from(&preset),
            None => self.name().to_owned(),
        }
    }

    /// The description, if it is about this scenario: that of a preset does not hold once keys are changed.
    pub fn valid_description(&self) -> Option<&str> {
        let description = self.description();
        let is_of_other = self.preset_values().is_some_and(|preset| {
            preset.optional_text("description") == Some(description)
                && self.changes(&preset).next().is_some()
        });
        (!description.is_empty() && !is_of_other).then_some(description)
    }

    /// The values of the preset of this name.
    fn preset_values(&self) -> Option<Values> {
        let preset = PRESETS.iter().find(|preset| preset.name == self.name())?;
        preset.values().ok()
    }

    /// The name, followed by up to two keys that differ from `base`.
    pub fn title_from(&self, base: &Values) -> String {
        let changes: Vec<_> = self.changes(base).collect();
        if changes.len() > 2 {
            return format!("{}, {} keys changed", self.name(), changes.len());
        }
        let mut title = self.name().to_owned();
        for (key, value) in changes {
            title += &match value {
                Some(value) => format!(", {} = {}", key.path, value.to_set_notation()),
                None => format!(", without {}", key.path),
            };
        }
        title
    }
}

impl Preset {
    /// The preset with this name.
    ///
    /// # Errors
    /// [`ScenarioError`], which names the similar presets, or all.
    pub fn find(name: &str) -> Result<&'static Self, ScenarioError> {
        PRESETS
            .iter()
            .find(|preset| preset.name == name)
            .ok_or_else(|| {
                let presets: Vec<_> = PRESETS.iter().map(|preset| preset.name.as_str()).collect();
                ScenarioError::without_key(Problem::UnknownPreset {
                    name: name.to_owned(),
                    similar: similar_names(name, presets.iter().copied()),
                    presets,
                })
            })
    }

    /// The keys and values.
    ///
    /// # Errors
    /// Never for built-in presets; a test reads them all.
    pub fn values(&self) -> Result<Values, ScenarioError> {
        let mut values = Values::from_toml(PAPER)?;
        values.set_value("name", self.name.as_str())?;
        values.set_value("description", self.description.as_str())?;
        for key in &self.without {
            // An empty text removes a key.
            values.set(key, "")?;
        }
        values.merge(self.changes.clone())?;
        Ok(values)
    }

    /// The scenario.
    ///
    /// # Errors
    /// Never for built-in presets; a test reads them all.
    pub fn scenario(&self) -> Result<Scenario, ScenarioError> {
        Scenario::new(self.values()?)
    }
}
