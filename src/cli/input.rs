//! Opens the runs named on the command line, with overrides.

use super::arguments::Override;
use crate::analysis::subject::Subject;
use crate::archive::input::{is_recording, values};
use crate::archive::recording::Recording;
use crate::run::scenario::{Scenario, Values};
use anyhow::{Context as _, Error, bail};
use std::path::Path;

/// A run on the command line.
pub(super) enum Input {
    /// A recording that is read.
    Recording(Box<Recording>),
    /// A scenario to simulate.
    Scenario(Box<Scenario>),
}

impl Input {
    pub(super) fn subject(&self) -> Subject<'_> {
        match self {
            Self::Recording(recording) => Subject::Recording(recording),
            Self::Scenario(scenario) => Subject::Scenario(scenario),
        }
    }

    /// The size of its file, bytes.
    pub(super) fn bytes(&self) -> u64 {
        match self {
            Self::Recording(recording) => recording.size(),
            Self::Scenario(_) => 0,
        }
    }
}

/// Opens a run by name: a preset, a scenario file or a recording.
///
/// `common` overrides are ignored for recordings; `own` overrides are an error for them.
pub(super) fn open(word: &Path, common: &[Override], own: &[Override]) -> Result<Input, Error> {
    if !is_recording(word) {
        let scenario = checked(word, values(word)?, &[common, own].concat())?;
        return Ok(Input::Scenario(Box::new(scenario)));
    }
    let name = || word.display().to_string();
    if let Some((key, _)) = own.first() {
        bail!(
            "{} is a recording: {key} can only be set for a preset or scenario file",
            name()
        );
    }
    let recording = Recording::open(word).with_context(name)?;
    Ok(Input::Recording(Box::new(recording)))
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
