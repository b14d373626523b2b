//! Checking an archive: everything that follows from its recordings is made again, and compared byte for byte.

pub(in crate::cli::commands) use super::folder::is_archive;

use super::folder::Unpacked;
use super::metadata::MAKER;
use super::parts::{
    ADDED, Archive, ArchiveFile, ArchivedRecording, Content, DATACITE, RECORDINGS, SUMS, sum,
};
use crate::archive::provenance::Build;
use crate::archive::publish::Drafts;
use crate::archive::supplements::about::About;
use crate::archive::verify::Verdict;
use crate::cli::commands::verify::file::check_file;
use crate::cli::output::with_causes;
use crate::cli::progress::Progress;
use anyhow::{Context as _, Error};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::fs::{self, File};
use std::io;
use std::path::Path;

/// The result of checking an archive.
#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::cli::commands) struct ArchiveCheck {
    /// The result as a whole.
    pub(in crate::cli::commands) verdict: Verdict,
    /// Number of files.
    pub(in crate::cli::commands) files: u64,
    /// Verdicts on the recordings, by their names.
    pub(in crate::cli::commands) recordings: BTreeMap<String, Verdict>,
    /// What is wrong, by file.
    pub(in crate::cli::commands) faults: BTreeSet<ArchiveFault>,
    /// The version of toprise that made it, if different from this one: reports and figures are then not compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(in crate::cli::commands) made_by: Option<String>,
}

/// A fault of a file in an archive.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
pub(in crate::cli::commands) struct ArchiveFault {
    /// The file.
    file: String,
    /// The fault.
    fault: FaultKind,
}

/// What is wrong with a file.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum FaultKind {
    /// It is missing.
    Missing,
    /// The archive doesn't list it.
    Unlisted,
    /// It is a link, a pipe or a device.
    NoFile,
    /// Its sum is another one.
    Sum,
    /// It is not what follows from the recordings.
    Different,
    /// The recording doesn't verify.
    Unverified,
    /// The recording says something else of itself than the archive.
    Contradiction,
    /// It can't be read, for this reason.
    Unreadable(String),
}

impl fmt::Display for ArchiveFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let file = &self.file;
        match &self.fault {
            FaultKind::Missing => write!(f, "{file} is missing"),
            FaultKind::NoFile => write!(f, "{file} is a link, a pipe or a device, and no file"),
            FaultKind::Contradiction => {
                write!(f, "{file} says of itself what {DATACITE} contradicts")
            }
            FaultKind::Unlisted => write!(f, "{file} does not belong to the archive"),
            FaultKind::Sum => write!(f, "{file} was changed: its SHA-256 is not that in {SUMS}"),
            FaultKind::Different => {
                write!(f, "{file} was changed: the recordings give something else")
            }
            FaultKind::Unverified => write!(f, "{file} does not verify: see toprise verify {file}"),
            FaultKind::Unreadable(reason) => write!(f, "{file} can't be read: {reason}"),
        }
    }
}

/// An archive that is checked.
struct Check<'a> {
    unpacked: Unpacked,
    names: BTreeSet<String>,
    faults: BTreeSet<ArchiveFault>,
    progress: &'a Progress,
}

/// Checks the archive at a path.
///
/// # Errors
/// If there is none, or it can't be read.
pub(in crate::cli::commands) fn check_archive(
    path: &Path,
    progress: &Progress,
    drafts: &Drafts,
) -> Result<ArchiveCheck, Error> {
    let unpacked = Unpacked::open(path, drafts)?;
    let (files, others): (BTreeMap<_, _>, BTreeMap<_, _>) = unpacked
        .names()?
        .into_iter()
        .partition(|(_, is_file)| *is_file);
    let mut check = Check {
        names: files.into_keys().collect(),
        unpacked,
        faults: BTreeSet::new(),
        progress,
    };
    for name in others.keys() {
        check.blame(name, FaultKind::NoFile);
    }
    check.sums();
    let recordings = check.recordings();
    let made_by = check.rerun();
    let is_partial = made_by.is_some() || recordings.values().any(|v| *v == Verdict::Incomplete);
    Ok(ArchiveCheck {
        verdict: match (check.faults.is_empty(), is_partial) {
            (false, _) => Verdict::Different,
            (true, true) => Verdict::Incomplete,
            (true, false) => Verdict::Verified,
        },
        files: check.names.len() as u64,
        recordings,
        faults: check.faults,
        made_by,
    })
}

impl Check<'_> {
    fn blame(&mut self, file: &str, fault: FaultKind) {
        let file = file.to_owned();
        // One fault of a file is enough, the first that is found.
        if self.faults.iter().all(|known| known.file != file) {
            self.faults.insert(ArchiveFault { file, fault });
        }
    }

    /// Reads a file, unless it is none: pipes never end.
    fn read(&self, name: &str) -> io::Result<Vec<u8>> {
        if self.names.contains(name) {
            fs::read(self.unpacked.at(name))
        } else {
            Err(io::ErrorKind::NotFound.into())
        }
    }

    fn text(&self, name: &str) -> io::Result<String> {
        String::from_utf8(self.read(name)?).map_err(io::Error::other)
    }

    /// Compares all files with the sums.
    fn sums(&mut self) {
        let text = match self.text(SUMS) {
            Ok(text) => text,
            Err(error) => {
                self.blame(SUMS, FaultKind::Unreadable(error.to_string()));
                return;
            }
        };
        let sums: BTreeMap<&str, &str> = text
            .lines()
            .filter_map(|line| line.split_once("  "))
            .map(|(sum, name)| (name, sum))
            .collect();
        for (name, expected) in &sums {
            if !self.names.contains(*name) {
                self.blame(name, FaultKind::Missing);
                continue;
            }
            let summed = File::open(self.unpacked.at(name)).and_then(|mut file| sum(&mut file));
            match summed {
                Ok((_, found)) if found == *expected => {}
                Ok(_) => self.blame(name, FaultKind::Sum),
                Err(error) => self.blame(name, FaultKind::Unreadable(error.to_string())),
            }
        }
        for name in self.names.clone() {
            if name != SUMS && !sums.contains_key(name.as_str()) {
                self.blame(&name, FaultKind::Unlisted);
            }
        }
    }

    /// Verifies the recordings.
    fn recordings(&mut self) -> BTreeMap<String, Verdict> {
        let mut verdicts = BTreeMap::new();
        if self.files_in(RECORDINGS).is_empty() {
            self.blame(RECORDINGS, FaultKind::Missing);
        }
        for name in self.files_in(RECORDINGS) {
            match check_file(&self.unpacked.at(&name), self.progress) {
                Ok(report) => {
                    if report.verdict == Verdict::Different {
                        self.blame(&name, FaultKind::Unverified);
                    }
                    verdicts.insert(name, report.verdict);
                }
                Err(error) => self.blame(&name, FaultKind::Unreadable(with_causes(&error))),
            }
        }
        verdicts
    }

    fn files_in(&self, folder: &str) -> Vec<String> {
        let is_inside = |name: &&String| {
            name.strip_prefix(folder)
                .is_some_and(|rest| rest.starts_with('/'))
        };
        self.names.iter().filter(is_inside).cloned().collect()
    }

    /// Makes the archive again, and compares all files. Returns the version that made it if that is not this one, which
    /// may have other words for the same.
    fn rerun(&mut self) -> Option<String> {
        let this = Build::this();
        let maker = match self.maker() {
            Ok(maker) => maker,
            Err(error) => {
                self.blame(
                    "ro-crate-metadata.json",
                    FaultKind::Unreadable(with_causes(&error)),
                );
                return None;
            }
        };
        if maker.version != this.version {
            return Some(maker.version);
        }
        match self.made_again(maker) {
            Ok(files) => self.compare(&files),
            Err(error) => self.blame(DATACITE, FaultKind::Unreadable(with_causes(&error))),
        }
        None
    }

    /// The build that says that it made the archive.
    fn maker(&self) -> Result<Build, Error> {
        let text = self.text("ro-crate-metadata.json")?;
        let metadata: Value = serde_json::from_str(&text)?;
        let mut entities = metadata["@graph"].as_array().into_iter().flatten();
        let maker = entities.find(|entity| entity["@id"] == MAKER);
        let maker = maker.context("it doesn't say which program made the archive")?;
        let version = maker["softwareVersion"]
            .as_str()
            .context("it doesn't say which version made the archive")?;
        let commit = maker["identifier"].as_str();
        Ok(Build {
            version: version.to_owned(),
            commit: commit.and_then(commit_in).map(str::to_owned),
            ..Build::this()
        })
    }

    /// The files of the archive, made from its recordings.
    fn made_again(&mut self, maker: Build) -> Result<Vec<ArchiveFile>, Error> {
        let text = self.text(DATACITE)?;
        let about = About::from_datacite(&serde_json::from_str(&text)?)
            .context("it is not as toprise writes it")?;
        let mut recordings = Vec::new();
        for name in self.files_in(RECORDINGS) {
            recordings.push(ArchivedRecording::open(&self.unpacked.at(&name))?);
        }
        let added = self.files_in(ADDED);
        let added = added.iter().map(|name| self.unpacked.at(name)).collect();
        let archive = Archive::new(about, recordings, added, maker);
        for path in archive.contradictions() {
            self.blame(&path, FaultKind::Contradiction);
        }
        archive.files()
    }

    fn compare(&mut self, files: &[ArchiveFile]) {
        for file in files {
            let Content::Bytes(expected) = &file.content else {
                continue;
            };
            match self.read(&file.name) {
                Ok(found) if found == *expected => {}
                Ok(_) => self.blame(&file.name, FaultKind::Different),
                Err(_) => self.blame(&file.name, FaultKind::Missing),
            }
        }
        let expected: BTreeSet<&str> = files.iter().map(|file| file.name.as_str()).collect();
        for name in self.names.clone() {
            if !expected.contains(name.as_str()) {
                self.blame(&name, FaultKind::Unlisted);
            }
        }
    }
}

/// The commit that an identifier names, if it is one.
fn commit_in(identifier: &str) -> Option<&str> {
    let commit = identifier.strip_prefix("commit ")?;
    let hash = commit.strip_suffix(" with changes").unwrap_or(commit);
    let is_hash = hash.len() == 40 && hash.bytes().all(|byte| byte.is_ascii_hexdigit());
    is_hash.then_some(commit)
}
