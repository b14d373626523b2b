//! The runs that words on the command line mean: presets, scenario files, recordings.

use super::arguments::Override;
use crate::analysis::subject::Subject;
use crate::archive::recording::Recording;
use crate::run::scenario::{PRESETS, Preset, Scenario, Values};
use anyhow::{Context as _, Error, bail, ensure};
use std::fs;
use std::path::Path;

/// A run on the command line.
pub(super) enum Given {
    /// A recording that is read.
    Recording(Box<Recording>),
    /// A scenario that is simulated now.
    Scenario(Box<Scenario>),
}

impl Given {
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
pub(super) fn open(word: &Path, common: &[Override], own: &[Override]) -> Result<Given, Error> {
    let is_scenario = is_preset(word) || has_extension(word, "toml");
    if is_scenario || !(word.exists() || is_like_a_file(word)) {
        let scenario = scenario(word, &[common, own].concat())?;
        return Ok(Given::Scenario(Box::new(scenario)));
    }
    let name = || word.display().to_string();
    if let Some((key, _)) = own.first() {
        bail!(
            "{} is a recording: {key} can only be set in a scenario that is simulated now",
            name()
        );
    }
    let recording = Recording::open(word).with_context(name)?;
    Ok(Given::Recording(Box::new(recording)))
}

/// Reads the scenario that a word means, a preset, a file or the one in a recording, and sets some of its keys.
pub(super) fn scenario(word: &Path, overrides: &[Override]) -> Result<Scenario, Error> {
    let name = || word.display().to_string();
    let is_file = has_extension(word, "toml") || has_directory(word) || word.is_file();
    let mut values = if is_preset(word) || !is_file {
        Preset::find(&word.to_string_lossy())?.values()?
    } else {
        let text =
            scenario_text(word).with_context(|| format!("cannot read the scenario {}", name()))?;
        Values::from_toml(&text).with_context(name)?
    };
    for (key, value) in overrides {
        values
            .set(key, value)
            .with_context(|| format!("--set {key}={value}"))?;
    }
    Scenario::new(values).with_context(name)
}

/// The text of a scenario file, or of the scenario that a recording was made from.
fn scenario_text(path: &Path) -> Result<String, Error> {
    if has_extension(path, "mcap") {
        Ok(Recording::open(path)?.scenario_text()?)
    } else {
        read_file(path)
    }
}

fn is_preset(word: &Path) -> bool {
    PRESETS.iter().any(|preset| word.as_os_str() == preset.name)
}

fn has_extension(word: &Path, extension: &str) -> bool {
    word.extension().is_some_and(|found| found == extension)
}

fn has_directory(word: &Path) -> bool {
    word.to_string_lossy().contains(['/', '\\'])
}

/// Whether a word that names nothing is the name of a recording rather than of a preset.
fn is_like_a_file(word: &Path) -> bool {
    has_directory(word) || word.to_string_lossy().contains(".mcap")
}

/// The text of a file. Opening a pipe that nobody writes to would wait for ever: it is refused.
pub(super) fn read_file(path: &Path) -> Result<String, Error> {
    let metadata = fs::metadata(path)?;
    ensure!(
        metadata.is_file() || metadata.is_dir(),
        "it is a pipe or a device, not a file"
    );
    Ok(fs::read_to_string(path)?)
}
