//! `toprise verify`.

use crate::archive::recording::{Condition, Recording};
use crate::archive::verify::{Equality, Report, SchemaCheck, Verdict, verify as check};
use crate::cli::losses::loss_lines;
use crate::cli::progress::Progress;
use crate::cli::status::Status;
use crate::cli::{output, report};
use crate::telemetry::table;
use crate::words::{Section, Table, Tone, counted};
use anyhow::Error;
use clap::Args;
use rayon::iter::{IntoParallelRefIterator as _, ParallelIterator as _};
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Arguments of `toprise verify`.
#[derive(Args, Debug, Default, PartialEq)]
pub(in crate::cli) struct VerifyArguments {
    /// Recordings (MCAP files).
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
    /// The reason why the file could not be read; absent if it could.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
}

/// Verifies recordings.
pub(super) fn verify(arguments: &VerifyArguments) -> Result<Status, Error> {
    let report = VerifyReport(check_all(&arguments.files));
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
fn check_all(files: &[PathBuf]) -> Vec<VerifiedFile> {
    // A file that can't be read has an error of its own.
    let sizes = files
        .iter()
        .filter_map(|file| file.metadata().ok())
        .map(|metadata| metadata.len());
    let progress = Progress::for_bytes("verifying", sizes.sum());
    // Each file is one simulation, which uses one thread and one for compression.
    let verified = files
        .par_iter()
        .map(|path| VerifiedFile::new(path, check_file(path, &progress)))
        .collect();
    progress.finish();
    verified
}

fn check_file(path: &Path, progress: &Progress) -> Result<Report, Error> {
    let recording = Recording::open(path)?;
    Ok(check(&recording, &|bytes| progress.add(bytes))?)
}

impl VerifiedFile {
    fn new(path: &Path, checked: Result<Report, Error>) -> Self {
        Self {
            file: path.display().to_string(),
            error: checked.as_ref().err().map(ToString::to_string),
            report: checked.ok(),
        }
    }

    /// The status, and its rank from good to bad.
    fn status(&self) -> (u8, Status) {
        match self.report.as_ref().map(|report| report.verdict) {
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
                sections.push(section(&file.file, report));
            }
        }
        sections
    }
}

fn verified(report: &Report) -> &'static str {
    match report.equality {
        Some(Equality::ByteIdentical) | None => "verified (byte-identical to a new run)",
        Some(Equality::PackedOtherwise) if !report.supplements.is_empty() => {
            "verified (same run, in a file that holds more)"
        }
        Some(Equality::PackedOtherwise) => "verified (same content, repacked)",
        Some(Equality::SameValues) => "verified (same values, recorded by another version)",
    }
}

/// The parts of a recording of another version that are not compared.
fn not_compared(check: SchemaCheck) -> &'static str {
    match check {
        SchemaCheck::Released => "channels for viewers",
        SchemaCheck::Unknown => {
            "channels for viewers; units and descriptions, because this version doesn't know those of the other"
        }
    }
}

fn section(file: &str, report: &Report) -> Section {
    let (tone, conclusion) = match report.verdict {
        Verdict::Verified => (Tone::Good, verified(report)),
        Verdict::Incomplete if report.equal == Some(0) => (Tone::Weak, "nothing can be compared"),
        Verdict::Incomplete => (Tone::Weak, "all readable messages match"),
        Verdict::Different => (Tone::Bad, "DIFFERENT from a new run of its scenario"),
    };
    let state = match (report.verdict, report.state) {
        // A complete file can contain an incomplete run.
        (Verdict::Incomplete, Condition::Whole) => "incomplete run: ".to_owned(),
        (Verdict::Incomplete, state) => format!("{}: ", state.name()),
        _ => String::new(),
    };
    let mut section = Section::with_tone(tone, format!("{file}: {state}{conclusion}"));
    let mut facts = Vec::new();
    if let Some(difference) = &report.difference {
        facts.push(("difference", difference.to_string()));
    }
    facts.extend(loss_lines(&report.losses, report.more_losses));
    if let Some(version) = &report.recorded_by {
        let this = format!(
            "{} (telemetry {})",
            env!("CARGO_PKG_VERSION"),
            table::VERSION
        );
        facts.push(("recorded by", format!("toprise {version}; this is {this}")));
    }
    if let Some(equal) = report.equal {
        facts.push(("equal", counted(equal, "message")));
    }
    if report.missing > 0 {
        facts.push(("missing", counted(report.missing, "message")));
    }
    if !report.unknown.is_empty() {
        facts.push(("not compared", report.unknown.join(", ")));
    }
    for supplement in &report.supplements {
        facts.push(("in addition", format!("{supplement}, not verified")));
    }
    if !report.repeated.is_empty() {
        facts.push(("repeated", report.repeated.join(", ")));
    }
    if let Some(check) = report.schemas {
        facts.push(("not compared", not_compared(check).to_owned()));
    }
    if !report.without.is_empty() {
        facts.push(("not recorded", report.without.join(", ")));
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
