//! Built-in scenarios: the paper's run and its variations.

use super::definition::Scenario;
use super::error::ScenarioError;
use super::key::{Key, Value};
use super::keys::KEYS;
use super::values::Values;
use crate::run::suggestion::suggestion;
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
    /// Its name, which is the scenario's `name`.
    pub name: String,
    /// Its description.
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
        let is_text = |key: &Key| matches!(key.path, "format" | "name" | "description");
        let keys = KEYS.iter().filter(move |key| !is_text(key));
        let changes = keys.map(|key| (key, self.value(key.path)));
        changes.filter(|(key, value)| *value != from.get(key.path))
    }

    /// The name, followed by up to two keys that differ from the preset of that name, e.g. `paper, friction.k = 0.02`.
    pub fn title(&self) -> String {
        let preset = PRESETS.iter().find(|preset| preset.name == self.name());
        match preset.map(Preset::values) {
            Some(Ok(preset)) => self.title_from(&preset),
            _ => self.name().to_owned(),
        }
    }

    /// The name, followed by up to two keys that differ from `base`.
    pub fn title_from(&self, base: &Values) -> String {
        let change = |(key, value): (&Key, Option<&Value>)| match value {
            Some(value) => format!(", {} = {}", key.path, value.to_set_notation()),
            None => format!(", without {}", key.path),
        };
        let changes: Vec<_> = self.changes(base).map(change).collect();
        let changes = match changes.len() {
            0..=2 => changes.concat(),
            count => format!(", {count} keys changed"),
        };
        format!("{}{changes}", self.name())
    }
}

impl Preset {
    /// The preset with this name.
    ///
    /// # Errors
    /// [`ScenarioError`], which lists all presets.
    pub fn find(name: &str) -> Result<&'static Self, ScenarioError> {
        let found = PRESETS.iter().find(|preset| preset.name == name);
        found.ok_or_else(|| {
            let names: Vec<_> = PRESETS.iter().map(|preset| preset.name.as_str()).collect();
            let hint = suggestion(name, names.iter().copied());
            let allowed = names.join(", ");
            ScenarioError(format!(
                "unknown preset {name:?}{hint}; presets: {allowed}. For a scenario file, give the path, e.g. ./{name}.toml"
            ))
        })
    }

    /// Its keys and values.
    ///
    /// # Errors
    /// Never for built-in presets; a test reads them all.
    pub fn values(&self) -> Result<Values, ScenarioError> {
        let mut values = Values::from_toml(PAPER)?;
        values.set_value("name", self.name.as_str())?;
        values.set_value("description", self.description.as_str())?;
        for key in &self.without {
            values.set(key, "")?;
        }
        values.change(self.changes.clone())?;
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
