//! Inputs: what a word of a command line names is opened once, and travels as an [`Input`].

pub use crate::archive::container::source::open_file;
use crate::archive::container::source::{Source, is_stream};
use crate::archive::format::Form;
use crate::archive::recording::{Recording, RecordingError};
use crate::run::scenario::{Preset, ScenarioError, Values};
use crate::telemetry::Topics;
use std::ffi::OsStr;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Error of opening an input.
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
    #[error("{}: {reason}", path.display())]
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
    /// A table has many scenarios.
    #[error("{} is a sweep table: run one of its rows, e.g. toprise run {} --row 0", path.display(), path.display())]
    Table {
        /// The file.
        path: PathBuf,
    },
}

impl InputError {
    /// The error of the scenario itself, if the file or preset could be read.
    pub fn scenario_error(&self) -> Option<&ScenarioError> {
        match self {
            Self::UnknownPreset(reason) | Self::Scenario { reason, .. } => Some(reason),
            Self::Io { .. } | Self::Recording { .. } | Self::Table { .. } => None,
        }
    }

    fn recording(path: &Path, reason: RecordingError) -> Self {
        Self::Recording {
            path: path.to_owned(),
            reason,
        }
    }
}

/// The input that a word names.
#[derive(Debug)]
pub enum Input {
    /// A preset.
    Preset(&'static Preset),
    /// A scenario file, or a stream.
    Scenario {
        /// The file; `-` for standard input.
        path: PathBuf,
        /// The keys and values.
        values: Values,
    },
    /// A recording, or any other MCAP file.
    Recording(Box<Recording>),
    /// A sweep table, whose rows are scenarios. It is not open.
    Table(PathBuf),
}

impl Input {
    /// Opens what a word names: a preset before a file of this name; `-` is standard input, a scenario or a recording,
    /// and a file of this name is `./-`.
    ///
    /// # Errors
    /// [`InputError`] if there is none, or a key of it is wrong; whether a scenario is complete is not checked.
    pub fn open(word: &Path) -> Result<Self, InputError> {
        if is_stream(word) {
            return Self::open_stream(word);
        }
        let unknown = match Preset::find(&word.to_string_lossy()) {
            Ok(preset) => return Ok(Self::Preset(preset)),
            Err(unknown) => unknown,
        };
        let text = match FileFormat::detect(word) {
            FileFormat::Parquet => return Ok(Self::Table(word.to_owned())),
            FileFormat::Recording => return Self::open_recording(word),
            // A link that leads nowhere is a file, too: the system says what is wrong with it.
            FileFormat::Text if word.symlink_metadata().is_ok() || looks_like_a_file(word) => {
                read_file(word)
            }
            FileFormat::Text => return Err(InputError::UnknownPreset(unknown)),
        };
        Self::from_text(word, text)
    }

    /// A stream is read once, so its first bytes show what it is.
    fn open_stream(word: &Path) -> Result<Self, InputError> {
        let source = match Source::open(word) {
            Ok(source) => source,
            Err(RecordingError::Empty) => {
                let reason = "it is empty (it can be read only once)";
                return Self::from_text(word, Err(io::Error::other(reason)));
            }
            Err(reason) => return Err(InputError::recording(word, reason)),
        };
        if source.has_magic_at(0).unwrap_or(false) {
            return match Recording::from_source(source, word) {
                Ok(recording) => Ok(Self::Recording(Box::new(recording))),
                Err(reason) => Err(InputError::recording(word, reason)),
            };
        }
        Self::from_text(word, text_from(&source))
    }

    /// The scenario that a text is.
    fn from_text(word: &Path, text: io::Result<String>) -> Result<Self, InputError> {
        let path = word.to_owned();
        match text {
            Ok(text) => Ok(Self::Scenario {
                values: parse(word, &text)?,
                path,
            }),
            Err(reason) => Err(InputError::Io { path, reason }),
        }
    }

    fn open_recording(path: &Path) -> Result<Self, InputError> {
        match Recording::open(path) {
            Ok(recording) => Ok(Self::Recording(Box::new(recording))),
            Err(reason) => Err(InputError::recording(path, reason)),
        }
    }

    /// The keys and values of the scenario.
    ///
    /// # Errors
    /// [`InputError`] if a recording has no scenario that can be read, or for a table.
    pub fn values(&self) -> Result<Values, InputError> {
        match self {
            Self::Preset(preset) => preset.values().map_err(InputError::UnknownPreset),
            Self::Scenario { values, .. } => Ok(values.clone()),
            Self::Recording(recording) => match recording.scenario_text() {
                Ok(text) => parse(recording.path(), &text),
                Err(reason) => Err(InputError::recording(recording.path(), reason)),
            },
            Self::Table(path) => Err(InputError::Table { path: path.clone() }),
        }
    }

    /// Form and topics of a recording; `None` for other inputs.
    pub fn form(&self) -> Option<(Form, Topics)> {
        let Self::Recording(recording) = self else {
            return None;
        };
        recording.form()
    }

    /// The word that names the input.
    pub fn word(&self) -> &Path {
        match self {
            Self::Preset(preset) => Path::new(&preset.name),
            Self::Scenario { path, .. } | Self::Table(path) => path,
            Self::Recording(recording) => recording.path(),
        }
    }

    /// The name of the file without its extensions, or of the preset; `None` for standard input.
    pub fn stem(&self) -> Option<&str> {
        let mut stem = self.word().file_name()?.to_str()?;
        for extension in [".partial", ".mcap", ".parquet", ".toml"] {
            stem = stem.trim_end_matches(extension);
        }
        (!matches!(stem, "" | "-")).then_some(stem)
    }
}

/// Reads the keys and values from the text of a file.
fn parse(path: &Path, text: &str) -> Result<Values, InputError> {
    Values::from_toml(text).map_err(|reason| InputError::Scenario {
        path: path.to_owned(),
        reason,
    })
}

/// The format of a file that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFormat {
    /// A recording, or any other MCAP file.
    Recording,
    /// A Parquet table.
    Parquet,
    /// Anything else is read as text.
    Text,
}

impl FileFormat {
    /// The format that the magic bytes of a file show, whatever its name is. Only a file without them is a recording by
    /// its name, because it is empty or cut: the error is then about a recording, and not about text.
    pub fn detect(path: &Path) -> Self {
        const PARQUET_MAGIC: &[u8] = b"PAR1";
        let start = read_start(path).unwrap_or_default();
        if start == mcap::MAGIC {
            return Self::Recording;
        }
        if start.starts_with(PARQUET_MAGIC) {
            return Self::Parquet;
        }
        match path.extension().and_then(OsStr::to_str) {
            Some("mcap" | "partial") => Self::Recording,
            Some(_) | None => Self::Text,
        }
    }
}

/// The bytes of a file in which its format shows; fewer if it is shorter.
fn read_start(path: &Path) -> io::Result<Vec<u8>> {
    let mut start = Vec::new();
    open_file(path)?
        .take(mcap::MAGIC.len() as u64)
        .read_to_end(&mut start)?;
    Ok(start)
}

/// The text of a stream, which is a scenario.
fn text_from(source: &Source) -> io::Result<String> {
    /// Maximum length of a scenario from a stream, bytes.
    const MAX_LENGTH: u64 = 1 << 20;
    let mut bytes = Vec::new();
    source.read(0, MAX_LENGTH, &mut bytes)?;
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
/// begin with a byte order mark, or all but one byte of each ASCII character are zero. No text begins with the character
/// zero.
pub(crate) fn text_of(bytes: Vec<u8>) -> io::Result<String> {
    // The byte order mark of little-endian UTF-32 begins with that of UTF-16.
    let is_utf32 = matches!(
        bytes[..],
        [0xff, 0xfe, 0, 0, ..]
            | [0, 0, 0xfe, 0xff, ..]
            | [1..=u8::MAX, 0, 0, 0, ..]
            | [0, 0, 0, 1..=u8::MAX, ..]
    );
    let is_utf16 = matches!(
        bytes[..],
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] | [1..=u8::MAX, 0, ..] | [0, 1..=u8::MAX, ..]
    );
    let reason = if is_utf32 {
        "it is UTF-32 text: save it as UTF-8".to_owned()
    } else if is_utf16 {
        "it is UTF-16 text: save it as UTF-8".to_owned()
    } else if bytes.starts_with(&[0]) {
        "it is not text".to_owned()
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

/// Whether a word is the name of a file, even if there is none, rather than that of a preset.
fn looks_like_a_file(word: &Path) -> bool {
    let text = word.to_string_lossy();
    let has_extension = [".mcap", ".parquet", ".toml"]
        .iter()
        .any(|extension| text.contains(extension));
    has_extension || text.contains(['/', '\\'])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The kind of input for which a word is taken.
    fn kind(word: &Path) -> &'static str {
        match Input::open(word) {
            Ok(Input::Preset(_)) | Err(InputError::UnknownPreset(_)) => "preset",
            Ok(Input::Scenario { .. })
            | Err(InputError::Scenario { .. } | InputError::Io { .. }) => "scenario",
            Ok(Input::Recording(_)) | Err(InputError::Recording { .. }) => "recording",
            Ok(Input::Table(_)) | Err(InputError::Table { .. }) => "table",
        }
    }

    #[test]
    fn takes_words_for_one_kind_of_input() {
        let folder = tempfile::tempdir().unwrap();
        for (name, content, expected) in [
            ("a.toml", &b"gravity = 9.81"[..], "scenario"),
            ("paper", b"gravity = 9.81", "scenario"),
            ("notes.txt", b"not a scenario", "scenario"),
            ("magic.toml", mcap::MAGIC, "recording"),
            ("magic", mcap::MAGIC, "recording"),
            ("empty.mcap", b"", "recording"),
            ("a.mcap.partial", b"text", "recording"),
            ("map.parquet", b"PAR1", "table"),
            ("map", b"PAR1", "table"),
            ("map.toml", b"PAR1", "table"),
            ("text.parquet", b"gravity = 9.81", "scenario"),
            ("empty.parquet", b"", "scenario"),
        ] {
            let path = folder.path().join(name);
            std::fs::write(&path, content).unwrap();
            assert_eq!(kind(&path), expected, "{name}");
        }
        #[cfg(unix)]
        {
            let link = folder.path().join("loop");
            std::os::unix::fs::symlink("loop", &link).unwrap();
            assert_eq!(kind(&link), "scenario");
        }
        for (word, expected) in [
            ("paper", "preset"),
            ("missing", "preset"),
            ("missing.txt", "preset"),
            ("missing.toml", "scenario"),
            ("./missing", "scenario"),
            ("missing.mcap", "recording"),
            ("missing.partial", "recording"),
            ("missing.parquet", "scenario"),
        ] {
            assert_eq!(kind(Path::new(word)), expected, "{word}");
        }
    }

    fn message(bytes: &[u8]) -> String {
        text_of(bytes.to_vec()).unwrap_err().to_string()
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
        for bytes in [&b"\x89PNG\r\n\0\0"[..], &[0; 1000]] {
            assert_eq!(message(bytes), "it is not text");
        }
        assert_eq!(text_of(text.as_bytes().to_vec()).unwrap(), text);
    }
}
