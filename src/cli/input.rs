//! The runs that words on the command line mean, with the keys that are set in them.

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
    /// A scenario that is simulated now.
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

/// Opens the run that a word means: a preset, a scenario file, or else a recording.
///
/// `common` keys are set in scenarios alone; `own` keys are refused for recordings.
pub(super) fn open(word: &Path, common: &[Override], own: &[Override]) -> Result<Input, Error> {
    if !is_recording(word) {
        let scenario = scenario(word, &[common, own].concat())?;
        return Ok(Input::Scenario(Box::new(scenario)));
    }
    let name = || word.display().to_string();
    if let Some((key, _)) = own.first() {
        bail!(
            "{} is a recording: {key} can only be set in a scenario that is simulated now",
            name()
        );
    }
    let recording = Recording::open(word).with_context(name)?;
    Ok(Input::Recording(Box::new(recording)))
}

/// Reads the scenario that a word means, a preset, a file or the one in a recording, and sets some of its keys.
pub(super) fn scenario(word: &Path, overrides: &[Override]) -> Result<Scenario, Error> {
    checked(word, values(word)?, overrides)
}

/// The scenario with these values, which a word means, and some of its keys set.
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
