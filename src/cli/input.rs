//! Opens the runs named on the command line, with overrides.

use super::arguments::Override;
use crate::analysis::subject::Subject;
use crate::archive::input::{Input, read_file};
use crate::archive::recording::Recording;
use crate::archive::supplements::about::About;
use crate::run::scenario::{Scenario, Values};
use anyhow::{Context as _, Error, bail};
use std::path::Path;

/// A run on the command line.
pub(super) enum OpenRun {
    /// A recording that is read.
    Recording(Box<Recording>),
    /// A scenario to simulate.
    Scenario {
        scenario: Box<Scenario>,
        /// See [`run_name`].
        name: String,
    },
}

impl OpenRun {
    pub(super) fn subject(&self) -> Subject<'_> {
        match self {
            Self::Recording(recording) => Subject::Recording(recording),
            Self::Scenario { scenario, .. } => Subject::Scenario(scenario),
        }
    }

    /// The name of the run in reports.
    pub(super) fn name(&self) -> String {
        match self {
            Self::Recording(recording) => Subject::Recording(recording).name(),
            Self::Scenario { name, .. } => name.clone(),
        }
    }

    pub(super) fn is_recording(&self) -> bool {
        matches!(self, Self::Recording(_))
    }

    /// Size of the recording, bytes; 0 for a scenario.
    pub(super) fn bytes(&self) -> u64 {
        match self {
            Self::Recording(recording) => recording.size(),
            Self::Scenario { .. } => 0,
        }
    }
}

/// Opens the run that a word names.
///
/// `common` overrides are ignored for recordings; `own` overrides are an error for them.
pub(super) fn open(word: &Path, common: &[Override], own: &[Override]) -> Result<OpenRun, Error> {
    let input = Input::open(word)?;
    if let Input::Recording(recording) = input {
        if let Some((key, _)) = own.first() {
            let name = recording.path().display();
            bail!("{name} is a recording: {key} can only be set for a preset or scenario file");
        }
        return Ok(OpenRun::Recording(recording));
    }
    let overrides = [common, own].concat();
    let scenario = checked(&input, input.values()?, &overrides)?;
    Ok(OpenRun::Scenario {
        name: run_name(&input, &scenario, &overrides),
        scenario: Box::new(scenario),
    })
}

/// Opens the scenario that a word names, with overrides.
pub(super) fn open_scenario(word: &Path, overrides: &[Override]) -> Result<Scenario, Error> {
    let input = Input::open(word)?;
    checked(&input, input.values()?, overrides)
}

/// Reads what a file says about a recording.
pub(super) fn read_about(path: &Path) -> Result<About, Error> {
    let name = || path.display().to_string();
    let text = read_file(path).with_context(name)?;
    About::from_toml(&text).with_context(name)
}

/// The name of a run in reports and of its files: the one that was set, or the stem of the scenario's file, or the name in
/// the scenario.
pub(super) fn run_name(input: &Input, scenario: &Scenario, overrides: &[Override]) -> String {
    let is_set = overrides.iter().any(|(key, _)| key == "name");
    match input.stem() {
        Some(stem) if !is_set => stem.to_owned(),
        Some(_) | None => scenario.name().to_owned(),
    }
}

/// The validated scenario with these values and overrides; `input` is named in errors.
pub(super) fn checked(
    input: &Input,
    mut values: Values,
    overrides: &[Override],
) -> Result<Scenario, Error> {
    for (key, value) in overrides {
        values.set(key, value)?;
    }
    Scenario::new(values).with_context(|| input.word().display().to_string())
}
