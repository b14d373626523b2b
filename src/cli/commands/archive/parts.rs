//! The parts of an archive: what goes into it, and its files.

use crate::archive::provenance::Build;
use crate::archive::recording::Recording;
use crate::archive::supplements::about::{self, About};
use anyhow::{Context as _, Error};
use sha2::{Digest as _, Sha256};
use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Name of the file with the sums of all others.
pub(super) const SUMS: &str = "SHA256SUMS";
/// Name of the file that says who made the archive, in `DataCite`'s words.
pub(super) const DATACITE: &str = "datacite.json";
/// Directory of the recordings.
pub(super) const RECORDINGS: &str = "recordings";
/// Directory of the added files.
pub(super) const ADDED: &str = "files";

/// Recordings to archive, and what is said about them.
pub(super) struct Archive {
    pub(super) about: About,
    /// The recordings, by their names.
    pub(super) recordings: Vec<ArchivedRecording>,
    /// Further files.
    pub(super) added: Vec<PathBuf>,
    /// The program that made the archive.
    pub(super) maker: Build,
}

/// A recording of an archive.
pub(super) struct ArchivedRecording {
    /// Name of the file, without extension.
    pub(super) name: String,
    pub(super) recording: Recording,
}

/// A file of an archive.
pub(super) struct ArchiveFile {
    /// Path in the archive, with `/`.
    pub(super) name: String,
    /// What it is, in words.
    pub(super) meaning: String,
    /// Media type.
    pub(super) media_type: &'static str,
    pub(super) content: Content,
    /// Size, bytes.
    pub(super) bytes: u64,
    /// SHA-256, hexadecimal.
    pub(super) sha256: String,
}

/// The content of a file.
pub(super) enum Content {
    Bytes(Vec<u8>),
    /// That of another file.
    File(PathBuf),
}

impl Content {
    pub(super) fn open(&self) -> io::Result<Box<dyn Read + '_>> {
        Ok(match self {
            Self::Bytes(bytes) => Box::new(bytes.as_slice()),
            Self::File(path) => Box::new(File::open(path)?),
        })
    }
}

impl ArchiveFile {
    pub(super) fn new(
        name: impl Into<String>,
        meaning: impl Into<String>,
        content: Content,
    ) -> Result<Self, Error> {
        let name = name.into();
        let (bytes, sha256) = sum(&mut *content.open().with_context(|| name.clone())?)?;
        Ok(Self {
            media_type: media_type(&name),
            name,
            meaning: meaning.into(),
            content,
            bytes,
            sha256,
        })
    }

    pub(super) fn text(
        name: impl Into<String>,
        meaning: impl Into<String>,
        text: String,
    ) -> Result<Self, Error> {
        Self::new(name, meaning, Content::Bytes(text.into_bytes()))
    }
}

/// Length and SHA-256 of a stream.
pub(super) fn sum(stream: &mut dyn Read) -> io::Result<(u64, String)> {
    let mut hasher = Sha256::new();
    let bytes = io::copy(stream, &mut hasher)?;
    Ok((bytes, format!("{:x}", hasher.finalize())))
}

fn media_type(name: &str) -> &'static str {
    match Path::new(name).extension().and_then(OsStr::to_str) {
        Some("json") => "application/json",
        Some("md") => "text/markdown",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("html") => "text/html",
        Some("toml") => "application/toml",
        Some("cff") => "application/yaml",
        Some("csv") => "text/csv",
        Some("mcap") => "application/x-mcap",
        Some("txt") => "text/plain",
        Some(_) | None => "application/octet-stream",
    }
}

impl Archive {
    /// The order of the arguments doesn't matter.
    pub(super) fn new(
        about: About,
        mut recordings: Vec<ArchivedRecording>,
        mut added: Vec<PathBuf>,
        maker: Build,
    ) -> Self {
        recordings.sort_by(|one, other| one.name.cmp(&other.name));
        added.sort_by(|one, other| one.file_name().cmp(&other.file_name()));
        Self {
            about,
            recordings,
            added,
            maker,
        }
    }

    /// Paths of the recordings that say something else of themselves.
    pub(super) fn contradictions(&self) -> Vec<String> {
        let entries = self.about.to_entries();
        let contradicts = |archived: &&ArchivedRecording| {
            let own = archived.recording.metadata(about::RECORD);
            own.is_some_and(|own| *own != entries)
        };
        let recordings = self.recordings.iter().filter(contradicts);
        recordings.map(ArchivedRecording::path).collect()
    }

    pub(super) fn recording_names(&self) -> Vec<String> {
        let recordings = self.recordings.iter();
        recordings.map(|archived| archived.name.clone()).collect()
    }
}

impl ArchivedRecording {
    /// Path of the recording in the archive.
    pub(super) fn path(&self) -> String {
        format!("{RECORDINGS}/{}.mcap", self.name)
    }

    /// Path of its scenario in the archive.
    pub(super) fn scenario_path(&self) -> String {
        format!("scenarios/{}.toml", self.name)
    }
}
