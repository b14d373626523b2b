//! `toprise verify`.

pub(super) mod file;

use self::file::check_file;
use super::archive::check::{ArchiveCheck, check_archive, is_archive};
use crate::archive::publish::Drafts;
use crate::archive::verify::{Report, Verdict};
use crate::cli::progress::Progress;
use crate::cli::status::Status;
use crate::cli::{output, report};
use crate::words::{Section, Table, Tone, grouped};
use anyhow::Error;
use clap::Args;
use rayon::iter::{IntoParallelRefIterator as _, ParallelIterator as _};
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Arguments of `toprise verify`.
#[derive(Args, Debug, Default, PartialEq)]
pub(in crate::cli) struct VerifyArguments {
    /// Recordings (MCAP files), and archives of them: directories or ZIP files that toprise archive wrote
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
}

/// The results, in command-line order.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct VerifyReport(Vec<VerifiedFile>);

/// The result for a file.
#[derive(Debug, Serialize, JsonSchema)]
struct VerifiedFile {
    /// The file.
    file: String,
    /// The result; absent if the file could not be read.
    #[serde(flatten)]
    report: Option<Report>,
    /// The result for an archive; absent for a recording.
    #[serde(skip_serializing_if = "Option::is_none")]
    archive: Option<ArchiveCheck>,
    /// The reason why the file could not be read; absent if it could.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
}

/// Verifies recordings.
pub(super) fn verify(arguments: &VerifyArguments, drafts: &Drafts) -> Result<Status, Error> {
    let report = VerifyReport(check_all(&arguments.files, drafts));
    report::print(&report, || report.page())?;
    // After the report, so that they end the output.
    for file in &report.0 {
        if let Some(error) = &file.error {
            output::error(&format!("{}: {error}", file.file));
        }
    }
    Ok(report.status())
}

/// Verifies all files in parallel.
fn check_all(files: &[PathBuf], drafts: &Drafts) -> Vec<VerifiedFile> {
    // A file that can't be read has an error of its own.
    let sizes = files
        .iter()
        .filter_map(|file| file.metadata().ok())
        .map(|metadata| metadata.len());
    let progress = Progress::for_bytes("verifying", sizes.sum());
    // Each file is one simulation, which uses one thread and one for compression.
    let verified = files
        .par_iter()
        .map(|path| VerifiedFile::new(path, &progress, drafts))
        .collect();
    progress.finish();
    verified
}

impl VerifiedFile {
    fn new(path: &Path, progress: &Progress, drafts: &Drafts) -> Self {
        let mut verified = Self {
            file: path.display().to_string(),
            report: None,
            archive: None,
            error: None,
        };
        let error = if is_archive(path) {
            let checked = check_archive(path, progress, drafts);
            checked.map(|check| verified.archive = Some(check)).err()
        } else {
            let checked = check_file(path, progress);
            checked.map(|report| verified.report = Some(report)).err()
        };
        verified.error = error.map(|error| output::with_causes(&error));
        verified
    }

    fn verdict(&self) -> Option<Verdict> {
        let of_archive = self.archive.as_ref().map(|check| check.verdict);
        self.report
            .as_ref()
            .map(|report| report.verdict)
            .or(of_archive)
    }

    /// The status, and its rank from good to bad.
    fn status(&self) -> (u8, Status) {
        match self.verdict() {
            Some(Verdict::Verified) => (0, Status::Success),
            Some(Verdict::Incomplete) => (1, Status::Partial),
            Some(Verdict::Different) => (2, Status::Different),
            None => (3, Status::Failed),
        }
    }
}

impl VerifyReport {
    /// The worst result of all files.
    fn status(&self) -> Status {
        self.0
            .iter()
            .map(VerifiedFile::status)
            // By rank, not by exit code: a file that differs is worse than one that is incomplete.
            .max_by_key(|(rank, _)| *rank)
            .map_or(Status::Success, |(_, status)| status)
    }

    fn page(&self) -> Vec<Section> {
        let mut sections = Vec::new();
        for file in &self.0 {
            if let Some(report) = &file.report {
                sections.push(report.section(&file.file));
            }
            if let Some(check) = &file.archive {
                sections.push(archive_section(&file.file, check));
            }
        }
        sections
    }
}

fn archive_section(file: &str, check: &ArchiveCheck) -> Section {
    let (tone, conclusion) = match check.verdict {
        Verdict::Verified => (
            Tone::Good,
            "verified (the recordings, and every file that follows from them)",
        ),
        Verdict::Incomplete => (Tone::Weak, "all that can be compared is equal"),
        Verdict::Different => (Tone::Bad, "ALTERED"),
    };
    let mut section = Section::with_tone(tone, format!("{file}: {conclusion}"));
    let mut facts = vec![
        ("files", grouped(check.files)),
        ("recordings", grouped(check.recordings.len() as u64)),
    ];
    facts.extend(
        check
            .faults
            .iter()
            .map(|fault| ("altered", fault.to_string())),
    );
    if let Some(version) = &check.made_by {
        let words = format!("reports, figures and words, which toprise {version} made");
        facts.push(("not compared", words));
    }
    section.table(Table::from_facts(facts));
    section
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn parses_files() {
        let expected = VerifyArguments {
            files: vec!["a.mcap".into(), "b.mcap".into()],
        };
        assert_eq!(parse::<VerifyArguments>("a.mcap b.mcap").unwrap(), expected);
        assert!(parse::<VerifyArguments>("").is_err());
    }
}
