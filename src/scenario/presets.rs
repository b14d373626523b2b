//! Scenarios that come with the program: the paper's run and its variations.

use super::{Scenario, ScenarioError, Values};

/// The paper's run (V. Tanrıverdi, arXiv:2204.14060, section 3): the base of all presets.
const PAPER: &str = include_str!("paper.toml");

/// A named scenario: the paper's with some keys set otherwise.
#[derive(Debug)]
pub struct Preset {
    /// Its name, which is the scenario's `name`.
    pub name: &'static str,
    description: &'static str,
    /// Keys and values as TOML; an empty value removes the key.
    differences: &'static [(&'static str, &'static str)],
}

/// All presets.
pub const PRESETS: &[Preset] = &[
    Preset {
        name: "paper",
        description: "The rise of the paper: equations (7) with k = 0.03 (figures 2 and 3)",
        differences: &[],
    },
    Preset {
        name: "paper-precession-term-only",
        description: "Equations (7) without the friction term in the spin's acceleration (figure 4a): rises late",
        differences: &[
            ("friction.dissipation", "precession-term-only"),
            ("stop.duration", "100.0"),
        ],
    },
    Preset {
        name: "paper-spin-term-only",
        description: "Equations (7) without the friction term in the precession's acceleration (figure 4b): falls",
        differences: &[("friction.dissipation", "spin-term-only")],
    },
    Preset {
        name: "full-coulomb",
        description: "The paper's top with the whole friction torque of equation (4)",
        differences: &[("friction.dissipation", "full")],
    },
    Preset {
        name: "frictionless",
        description: "The paper's top without friction: it neither rises nor falls",
        differences: &[
            ("friction.law", "none"),
            ("friction.k", ""),
            ("friction.dissipation", ""),
            ("stop.theta_risen", ""),
            ("stop.theta_fallen", ""),
            ("stop.duration", "20.0"),
        ],
    },
];

impl Preset {
    /// The preset with this name.
    ///
    /// # Errors
    /// [`ScenarioError::UnknownPreset`] naming those that exist.
    pub fn find(name: &str) -> Result<&'static Self, ScenarioError> {
        PRESETS
            .iter()
            .find(|preset| preset.name == name)
            .ok_or_else(|| ScenarioError::UnknownPreset {
                name: name.to_owned(),
                allowed: PRESETS
                    .iter()
                    .map(|p| p.name)
                    .collect::<Vec<_>>()
                    .join(", "),
            })
    }

    /// A sentence about it.
    #[must_use]
    pub fn description(&self) -> &'static str {
        self.description
    }

    /// Its keys and values.
    ///
    /// # Errors
    /// None for the presets of the table; a test reads them all.
    pub fn values(&self) -> Result<Values, ScenarioError> {
        let mut values = Values::from_toml(PAPER)?;
        values.set("name", self.name)?;
        values.set("description", self.description)?;
        for (key, value) in self.differences {
            values.set(key, value)?;
        }
        Ok(values)
    }

    /// The scenario.
    ///
    /// # Errors
    /// None for the presets of the table; a test reads them all.
    pub fn scenario(&self) -> Result<Scenario, ScenarioError> {
        Scenario::new(self.values()?)
    }
}
