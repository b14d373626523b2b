//! Command-line arguments that identify a run: presets, scenario files and recordings.

pub use crate::archive::container::source::open_file;
use crate::archive::format::Form;
use crate::archive::recording::{Recording, RecordingError};
use crate::run::scenario::{PRESETS, Preset, ScenarioError, Values};
use crate::telemetry::Topics;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Error of reading a scenario.
#[derive(Debug, Error)]
pub enum InputError {
    /// There is no preset of this name.
    #[error(transparent)]
    UnknownPreset(ScenarioError),
    /// The file can't be read.
    #[error("cannot read the scenario {}: {reason}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system error.
        reason: io::Error,
    },
    /// The recording can't be read, or has no scenario.
    #[error("cannot read the scenario {}: {reason}", path.display())]
    Recording {
        /// The file.
        path: PathBuf,
        /// The reason.
        reason: RecordingError,
    },
    /// The text of the file is not a scenario.
    #[error("{}: {reason}", path.display())]
    Scenario {
        /// The file.
        path: PathBuf,
        /// The reason.
        reason: ScenarioError,
    },
}

impl InputError {
    /// The error of the scenario itself, if the file or preset could be read.
    pub fn scenario_error(&self) -> Option<&ScenarioError> {
        match self {
            Self::UnknownPreset(reason) | Self::Scenario { reason, .. } => Some(reason),
            Self::Io { .. } | Self::Recording { .. } => None,
        }
    }
}

/// Whether an argument means standard input. A file of this name is `./-`.
fn is_standard_input(word: &Path) -> bool {
    word.as_os_str() == "-"
}

/// Whether an argument is a recording rather than a scenario.
pub fn is_recording(word: &Path) -> bool {
    let is_scenario = is_preset(word) || has_extension(word, "toml") || is_standard_input(word);
    !is_scenario && (word.exists() || looks_like_a_file(word))
}

/// The scenario that a command-line argument names, and how a recording was made.
#[derive(Clone, Debug, PartialEq)]
pub struct RunInput {
    /// The keys and values of the scenario.
    pub values: Values,
    /// Form and topics of a recording; `None` for other arguments.
    pub form: Option<(Form, Topics)>,
}

/// Reads a preset, a scenario file or a recording; `-` is a scenario file on standard input.
///
/// # Errors
/// [`InputError`] if there is none, or a key of it is wrong; whether the scenario is complete is not checked.
pub fn read(word: &Path) -> Result<RunInput, InputError> {
    let is_file = has_extension(word, "toml")
        || looks_like_a_file(word)
        || is_standard_input(word)
        || word.exists();
    if is_preset(word) || !is_file {
        let values = Preset::find(&word.to_string_lossy())
            .and_then(Preset::values)
            .map_err(InputError::UnknownPreset)?;
        return Ok(RunInput { values, form: None });
    }
    // By its name even if it is empty or cut: the error is then about a recording, not about TOML.
    let has_its_name = has_extension(word, "mcap") || has_extension(word, "partial");
    let (text, form) = if !is_standard_input(word) && (has_its_name || is_mcap(word)) {
        read_recording(word).map_err(|reason| InputError::Recording {
            path: word.to_owned(),
            reason,
        })?
    } else {
        let text = read_text(word).map_err(|reason| InputError::Io {
            path: word.to_owned(),
            reason,
        })?;
        (text, None)
    };
    let values = Values::from_toml(&text).map_err(|reason| InputError::Scenario {
        path: word.to_owned(),
        reason,
    })?;
    Ok(RunInput { values, form })
}

/// The values of [`read()`].
///
/// # Errors
/// As [`read()`].
pub fn values(word: &Path) -> Result<Values, InputError> {
    Ok(read(word)?.values)
}

/// The scenario of a recording, and its form and topics.
fn read_recording(path: &Path) -> Result<(String, Option<(Form, Topics)>), RecordingError> {
    let recording = Recording::open(path)?;
    Ok((recording.scenario_text()?, recording.form()))
}

/// The text of a scenario file, or from standard input.
fn read_text(word: &Path) -> io::Result<String> {
    if is_standard_input(word) {
        return scenario_from(io::stdin().lock());
    }
    read_file(word)
}

/// Whether a file starts with the MCAP magic bytes.
fn is_mcap(path: &Path) -> bool {
    let mut magic = [0; mcap::MAGIC.len()];
    let read = open_file(path).and_then(|mut file| file.read_exact(&mut magic));
    read.is_ok() && magic == *mcap::MAGIC
}

/// The text of a scenario from a stream.
fn scenario_from(stream: impl io::Read) -> io::Result<String> {
    /// Maximum length of a scenario from a stream, bytes.
    const MAX_LENGTH: u64 = 1 << 20;
    let mut bytes = Vec::new();
    // Bytes, not text: the errors below recognise what else was piped in.
    stream.take(MAX_LENGTH).read_to_end(&mut bytes)?;
    if bytes.starts_with(mcap::MAGIC) {
        let reason = "a recording can't be read from a pipe: save it to a file";
        return Err(io::Error::other(reason));
    }
    if bytes.is_empty() {
        return Err(io::Error::other("it is empty (it can be read only once)"));
    }
    text_of(bytes)
}

/// The text of a file.
///
/// # Errors
/// As [`open_file`], or an error if the file is not UTF-8 text.
pub fn read_file(path: &Path) -> io::Result<String> {
    let mut bytes = Vec::new();
    open_file(path)?.read_to_end(&mut bytes)?;
    text_of(bytes)
}

/// Bytes as UTF-8 text. The error recognises UTF-16, as written by some editors and by PowerShell's `>`, and UTF-32: they
/// begin with a byte order mark, or all but one byte of each ASCII character are zero.
pub(crate) fn text_of(bytes: Vec<u8>) -> io::Result<String> {
    // The byte order mark of little-endian UTF-32 begins with that of UTF-16.
    let is_utf32 = matches!(
        bytes[..],
        [0xff, 0xfe, 0, 0, ..] | [0, 0, 0xfe, 0xff, ..] | [_, 0, 0, 0, ..] | [0, 0, 0, _, ..]
    );
    let is_utf16 = matches!(
        bytes[..],
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] | [_, 0, ..] | [0, _, ..]
    );
    let reason = if is_utf32 {
        "it is UTF-32 text: save it as UTF-8".to_owned()
    } else if is_utf16 {
        "it is UTF-16 text: save it as UTF-8".to_owned()
    } else {
        match String::from_utf8(bytes) {
            Ok(text) => return Ok(text),
            Err(error) if error.as_bytes().contains(&0) => "it is not text".to_owned(),
            Err(error) => {
                let end = error.utf8_error().valid_up_to();
                let line = error.as_bytes()[..end].split(|byte| *byte == b'\n').count();
                format!("it is not UTF-8 text (line {line}): save it as UTF-8")
            }
        }
    };
    Err(io::Error::new(io::ErrorKind::InvalidData, reason))
}

/// Whether an argument is the name of a preset.
pub fn is_preset(word: &Path) -> bool {
    PRESETS
        .iter()
        .any(|preset| word.as_os_str() == &*preset.name)
}

/// The name of a scenario file, recording or sweep table without its extensions; `None` for presets and standard input.
pub fn file_stem(word: &Path) -> Option<String> {
    if is_preset(word) || is_standard_input(word) {
        return None;
    }
    let mut stem = word.file_name()?.to_str()?;
    for extension in [".partial", ".mcap", ".parquet", ".toml"] {
        stem = stem.trim_end_matches(extension);
    }
    (!stem.is_empty()).then(|| stem.to_owned())
}

/// Whether a file name has an extension.
pub(crate) fn has_extension(word: &Path, extension: &str) -> bool {
    word.extension().is_some_and(|found| found == extension)
}

/// Whether an unknown argument looks like a file name rather than a preset.
fn looks_like_a_file(word: &Path) -> bool {
    let text = word.to_string_lossy();
    text.contains(['/', '\\']) || text.contains(".mcap")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(bytes: &[u8]) -> String {
        scenario_from(bytes).unwrap_err().to_string()
    }

    #[test]
    fn names_other_unicode_encodings() {
        let text = "name = 'ü'\n";
        let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
        for bytes in [
            [&[0xff, 0xfe], &little[..]].concat(),
            [&[0xfe, 0xff], &big[..]].concat(),
            little,
            big,
        ] {
            assert_eq!(message(&bytes), "it is UTF-16 text: save it as UTF-8");
        }
        let little: Vec<u8> = text
            .chars()
            .flat_map(|c| u32::from(c).to_le_bytes())
            .collect();
        let big: Vec<u8> = text
            .chars()
            .flat_map(|c| u32::from(c).to_be_bytes())
            .collect();
        for bytes in [
            [&[0xff, 0xfe, 0, 0], &little[..]].concat(),
            [&[0, 0, 0xfe, 0xff], &big[..]].concat(),
            little,
            big,
        ] {
            assert_eq!(message(&bytes), "it is UTF-32 text: save it as UTF-8");
        }
        assert_eq!(
            message(b"name = '\xfc'"),
            "it is not UTF-8 text (line 1): save it as UTF-8"
        );
        assert_eq!(message(b"\x89PNG\r\n\0\0"), "it is not text");
        assert_eq!(scenario_from(text.as_bytes()).unwrap(), text);
    }

    #[test]
    fn streams_hold_scenarios_only() {
        let recording = [mcap::MAGIC, b"rest"].concat();
        assert!(message(&recording).contains("save it to a file"));
        assert!(message(b"").starts_with("it is empty"));
    }
}
