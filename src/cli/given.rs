//! The runs that words on the command line mean.

use super::run::scenario;
use crate::analysis::subject::Subject;
use crate::archive::recording::Recording;
use crate::run::scenario::{PRESETS, Scenario};
use anyhow::{Context as _, Error, bail};
use std::path::Path;

/// A key of a scenario and its new value.
pub(super) type Override = (String, String);

/// A run on the command line.
pub(super) enum Given {
    Recording(Box<Recording>),
    Scenario(Box<Scenario>),
}

impl Given {
    pub(super) fn subject(&self) -> Subject<'_> {
        match self {
            Self::Recording(recording) => Subject::Recording(recording),
            Self::Scenario(scenario) => Subject::Scenario(scenario),
        }
    }

    /// The size of its file.
    pub(super) fn bytes(&self) -> u64 {
        match self {
            Self::Recording(recording) => recording.size(),
            Self::Scenario(_) => 0,
        }
    }
}

/// The run that a word means: a preset, a scenario file, or else a recording.
pub(super) fn open(word: &str, common: &[Override], own: &[Override]) -> Result<Given, Error> {
    let is_preset = PRESETS.iter().any(|preset| preset.name == word);
    let path = Path::new(word);
    let is_path = path.exists() || word.contains(['/', '\\']) || word.contains(".mcap");
    if is_preset || word.ends_with(".toml") || !is_path {
        let scenario = scenario(word, &[common, own].concat())?;
        return Ok(Given::Scenario(Box::new(scenario)));
    }
    if let Some((key, _)) = own.first() {
        bail!("{word} is a recording: {key} can only be set in a scenario that is simulated now");
    }
    let recording = Recording::open(path).with_context(|| word.to_owned())?;
    Ok(Given::Recording(Box::new(recording)))
}
