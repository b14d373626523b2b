//! A scenario in a request.

use serde::Deserialize;
use std::collections::BTreeMap;
use toprise::run::scenario::{Preset, Scenario, ScenarioError, Values};

/// A scenario: a preset and the keys that are set in it, as on the command line.
#[derive(Deserialize)]
pub struct ScenarioRequest {
    pub preset: String,
    pub set: BTreeMap<String, String>,
}

impl ScenarioRequest {
    /// The values of the preset.
    pub fn preset(&self) -> Result<Values, ScenarioError> {
        Preset::find(&self.preset).and_then(Preset::values)
    }

    pub fn values(&self) -> Result<Values, ScenarioError> {
        let mut values = self.preset()?;
        for (key, value) in &self.set {
            values.set(key, value)?;
        }
        Ok(values)
    }

    pub fn scenario(&self) -> Result<Scenario, ScenarioError> {
        Scenario::new(self.values()?)
    }
}
