//! `toprise archive`: recordings with all that a repository asks, as a directory or a ZIP file.

pub(super) mod check;
mod citation;
mod contents;
mod folder;
mod metadata;
mod parts;
mod readme;

use self::folder::Destination;
use self::parts::{Archive, ArchivedRecording};
use super::verify::file::check_file;
use crate::archive::format::Entries;
use crate::archive::provenance::Build;
use crate::archive::publish::Drafts;
use crate::archive::recording::Recording;
use crate::archive::supplements::about::{self, About};
use crate::archive::verify::Verdict;
use crate::cli::arguments::OUTPUT;
use crate::cli::input::read_about;
use crate::cli::progress::Progress;
use crate::cli::report;
use crate::cli::status::Status;
use crate::words::{Section, Table, counted, is_control};
use anyhow::{Context as _, Error, bail};
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Arguments of `toprise archive`.
#[derive(Args, Debug, Default, PartialEq)]
pub(in crate::cli) struct ArchiveArguments {
    /// Recordings, which must verify
    #[arg(required = true, value_name = "FILE")]
    recordings: Vec<PathBuf>,

    /// TOML file with title, creators, licence, date and more [default: what the recordings say of themselves]
    #[arg(long, value_name = "FILE")]
    about: Option<PathBuf>,

    /// Another file to pack, e.g. the page toprise.html or a notebook
    #[arg(long, value_name = "FILE")]
    add: Vec<PathBuf>,

    /// New directory, or ZIP file (.zip), to write
    #[arg(short, long, value_name = "PATH", required = true, help_heading = OUTPUT)]
    output: PathBuf,
}

/// What was archived.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct ArchiveReport {
    /// The directory or the ZIP file.
    path: String,
    /// The recordings in it.
    recordings: Vec<String>,
    /// Number of files.
    files: u64,
    /// Size of all files together, bytes.
    bytes: u64,
}

/// Archives recordings.
pub(super) fn archive(arguments: &ArchiveArguments, drafts: &Drafts) -> Result<Status, Error> {
    let destination = Destination::new(&arguments.output)?;
    check_names(&arguments.recordings)?;
    check_names(&arguments.add)?;
    let mut recordings = Vec::new();
    for path in &arguments.recordings {
        recordings.push(ArchivedRecording::open(path)?);
    }
    let about = match &arguments.about {
        Some(path) => read_about(path)?,
        None => common_about(&recordings)?,
    };
    verify_all(&arguments.recordings)?;
    let archive = Archive::new(about, recordings, arguments.add.clone(), Build::this());
    if let Some(path) = archive.contradictions().first() {
        bail!("{path} says something else of itself: annotate it with the same file first");
    }
    let files = archive.files()?;
    destination.write(&files, drafts)?;
    let report = ArchiveReport {
        path: arguments.output.display().to_string(),
        recordings: archive.recording_names(),
        files: files.len() as u64,
        bytes: files.iter().map(|file| file.bytes).sum(),
    };
    report::print(&report, || report.page())?;
    Ok(Status::Success)
}

/// Refuses names that no file of an archive can have on every system.
fn check_names(paths: &[PathBuf]) -> Result<(), Error> {
    for path in paths {
        let name = path.file_name().and_then(OsStr::to_str).unwrap_or_default();
        let is_portable = !name.is_empty()
            && !name.starts_with('.')
            && !name.contains(|c: char| is_control(c) || "\\/:*?\"'<>|`".contains(c));
        if !is_portable {
            bail!(
                "{} has no name that an archive can have on every system: rename it",
                path.display()
            );
        }
        if !path.is_file() {
            bail!("{} is no file", path.display());
        }
    }
    Ok(())
}

/// What the recordings say of themselves: all that say anything must say the same.
fn common_about(recordings: &[ArchivedRecording]) -> Result<About, Error> {
    let records: BTreeSet<&Entries> = recordings
        .iter()
        .filter_map(|archived| archived.recording.metadata(about::RECORD))
        .collect();
    let mut records = records.into_iter();
    match (records.next(), records.next()) {
        (Some(record), None) => About::from_entries(record)
            .context("toprise did not write the metadata datacite: give a file with --about"),
        (Some(_), Some(_)) => {
            bail!("the recordings say different things: give a file with --about")
        }
        (None, _) => {
            bail!("no recording says who made it, and its licence: give a file with --about")
        }
    }
}

/// Refuses recordings that don't verify.
fn verify_all(paths: &[PathBuf]) -> Result<(), Error> {
    let sizes = paths.iter().filter_map(|path| path.metadata().ok());
    let progress = Progress::for_bytes("verifying", sizes.map(|metadata| metadata.len()).sum());
    for path in paths {
        let name = path.display();
        let report = check_file(path, &progress).with_context(|| name.to_string())?;
        if report.verdict != Verdict::Verified {
            bail!("{name} does not verify, so it is no archive of its run: see toprise verify");
        }
    }
    progress.finish();
    Ok(())
}

impl ArchivedRecording {
    fn open(path: &Path) -> Result<Self, Error> {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        Ok(Self {
            name: name.into_owned(),
            recording: Recording::open(path).with_context(|| path.display().to_string())?,
        })
    }
}

impl ArchiveReport {
    fn page(&self) -> Vec<Section> {
        let facts = [
            ("wrote", report::file_line(&self.path, self.bytes)),
            ("files", counted(self.files, "file")),
            ("recordings", self.recordings.join(", ")),
            ("verify", format!("toprise verify {}", self.path)),
        ];
        vec![Section::from(Table::from_facts(facts))]
    }
}
