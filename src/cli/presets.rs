//! `toprise presets`.

use super::page::{Part, Section};
use super::report;
use super::status::Status;
use super::table::Table;
use crate::run::scenario::{PRESETS, Preset};
use anyhow::Error;
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;

/// Arguments of `toprise presets`.
#[derive(Args, Debug, Default, PartialEq)]
pub(super) struct PresetsArguments {
    /// Preset to print
    name: Option<String>,
}

/// The listed presets.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct PresetsReport(Vec<PresetReport>);

/// A built-in scenario.
#[derive(Debug, Serialize, JsonSchema)]
struct PresetReport {
    /// Its name on the command line.
    name: &'static str,
    /// Its description.
    description: &'static str,
    /// Its scenario file, TOML.
    scenario: String,
}

/// Lists the presets, or prints one as TOML.
pub(super) fn presets(arguments: &PresetsArguments) -> Result<Status, Error> {
    let wanted = match &arguments.name {
        Some(name) => std::slice::from_ref(Preset::find(name)?),
        None => &PRESETS,
    };
    let presets = wanted.iter().map(|preset| {
        Ok::<_, Error>(PresetReport {
            name: &preset.name,
            description: &preset.description,
            scenario: preset.scenario()?.to_toml(),
        })
    });
    let report = PresetsReport(presets.collect::<Result<_, _>>()?);
    let is_one = arguments.name.is_some();
    report::print(&report, || report.page(is_one))?;
    Ok(Status::Success)
}

impl PresetsReport {
    fn page(&self, is_one: bool) -> Vec<Section> {
        let mut section = Section::default();
        if is_one {
            let code = |preset: &PresetReport| Part::Code(preset.scenario.clone());
            section.parts.extend(self.0.iter().map(code));
        } else {
            let fact = |preset: &PresetReport| (preset.name, preset.description.to_owned());
            section.table(Table::of_facts(self.0.iter().map(fact)));
        }
        vec![section]
    }
}
