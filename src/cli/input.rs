//! Opens the runs named on the command line, with overrides.

use super::arguments::Override;
use crate::analysis::subject::Subject;
use crate::archive::input::{file_stem, is_recording, values};
use crate::archive::recording::Recording;
use crate::run::scenario::{Scenario, Values};
use anyhow::{Context as _, Error, bail};
use std::path::Path;

/// A run on the command line.
pub(super) enum Input {
    /// A recording that is read.
    Recording(Box<Recording>),
    /// A scenario to simulate.
    Scenario {
        scenario: Box<Scenario>,
        /// See [`run_name`].
        name: String,
    },
}

impl Input {
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

/// Opens a run by name: a preset, a scenario file or a recording.
///
/// `common` overrides are ignored for recordings; `own` overrides are an error for them.
pub(super) fn open(word: &Path, common: &[Override], own: &[Override]) -> Result<Input, Error> {
    if !is_recording(word) {
        let overrides = [common, own].concat();
        let scenario = checked(word, values(word)?, &overrides)?;
        let name = run_name(word, &scenario, &overrides);
        let scenario = Box::new(scenario);
        return Ok(Input::Scenario { scenario, name });
    }
    let name = word.display();
    if let Some((key, _)) = own.first() {
        bail!("{name} is a recording: {key} can only be set for a preset or scenario file");
    }
    let recording = Recording::open(word).with_context(|| name.to_string())?;
    Ok(Input::Recording(Box::new(recording)))
}

/// The name of a run in reports and of its files: the one that was set, or the stem of the scenario's file, or the name in
/// the scenario.
pub(super) fn run_name(word: &Path, scenario: &Scenario, overrides: &[Override]) -> String {
    let is_set = overrides.iter().any(|(key, _)| key == "name");
    match file_stem(word) {
        Some(stem) if !is_set => stem,
        Some(_) | None => scenario.name().to_owned(),
    }
}

/// The validated scenario with these values and overrides; `word` is named in errors.
pub(super) fn checked(
    word: &Path,
    mut values: Values,
    overrides: &[Override],
) -> Result<Scenario, Error> {
    for (key, value) in overrides {
        values.set(key, value)?;
    }
    Scenario::new(values).with_context(|| word.display().to_string())
}
