//! `toprise presets`.

use crate::cli::input::open_scenario;
use crate::cli::report;
use crate::cli::status::Status;
use crate::run::scenario::{PRESETS, Scenario};
use crate::words::{Part, Section, Table};
use anyhow::Error;
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::PathBuf;

/// Arguments of `toprise presets`.
#[derive(Args, Debug, Default, PartialEq)]
pub(in crate::cli) struct PresetsArguments {
    /// Preset to print; or a recording or scenario file (-: standard input), whose scenario is printed
    name: Option<PathBuf>,
}

/// The listed presets.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct PresetsReport(Vec<PresetReport>);

/// A built-in scenario, or that of a file.
#[derive(Debug, Serialize, JsonSchema)]
struct PresetReport {
    /// Name on the command line.
    name: String,
    /// Description.
    description: String,
    /// Scenario file, TOML.
    scenario: String,
    /// The same as an object.
    keys: serde_json::Value,
}

/// Lists the presets, or prints a scenario as TOML.
pub(super) fn presets(arguments: &PresetsArguments) -> Result<Status, Error> {
    let mut scenarios = Vec::new();
    match &arguments.name {
        Some(name) => scenarios.push(PresetReport::new(&open_scenario(name, &[])?)),
        None => {
            for preset in PRESETS.iter() {
                scenarios.push(PresetReport::new(&preset.scenario()?));
            }
        }
    }
    let report = PresetsReport(scenarios);
    let is_one = arguments.name.is_some();
    report::print(&report, || report.page(is_one))?;
    Ok(Status::Success)
}

impl PresetReport {
    fn new(scenario: &Scenario) -> Self {
        Self {
            name: scenario.name().to_owned(),
            description: scenario.description().to_owned(),
            scenario: scenario.to_commented_toml(),
            keys: scenario.to_json(),
        }
    }
}

impl PresetsReport {
    fn page(&self, is_one: bool) -> Vec<Section> {
        let mut section = Section::default();
        if is_one {
            // Verbatim, so that the output is a scenario file.
            for preset in &self.0 {
                section.parts.push(Part::Code(preset.scenario.clone()));
            }
        } else {
            section.table(Table::from_facts(
                self.0
                    .iter()
                    .map(|preset| (preset.name.as_str(), preset.description.clone())),
            ));
        }
        vec![section]
    }
}
