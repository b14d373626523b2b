//! `toprise verify`.

use super::arguments::{FormArguments, Format};
use super::done::Done;
use super::numbers::count;
use super::page::{CROSS, Page, Section, TICK, Tone};
use super::progress::Progress;
use super::table::Table;
use super::{output, report};
use crate::analysis::verify::{Check, Options, Report, Verdict, verify as check};
use crate::archive::recording::{Condition, Recording, RecordingError};
use anyhow::Error;
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// Arguments of `toprise verify`.
#[derive(Args, Debug, Default, PartialEq)]
pub(super) struct VerifyArguments {
    /// Recordings (MCAP files).
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    /// Don't simulate the scenarios again: a quick check of container, messages and physics.
    #[arg(long)]
    no_reproduce: bool,

    #[command(flatten)]
    form: FormArguments,
}

type Answer = Result<Report, RecordingError>;

/// What was found out about recordings, in the order in which they were named.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct VerifyReport(Vec<VerifiedFile>);

/// What was found out about a file.
#[derive(Debug, Serialize, JsonSchema)]
struct VerifiedFile {
    /// The file.
    file: String,
    /// How it ended as a whole.
    verdict: FileVerdict,
    /// What kind of file it is; absent if it could not be read.
    #[serde(skip_serializing_if = "Option::is_none")]
    state: Option<Condition>,
    /// All checks, in order; absent if it could not be read.
    #[serde(skip_serializing_if = "Option::is_none")]
    checks: Option<Vec<Check>>,
    /// Why it could not be read; absent if it could.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
}

/// How the verification of a file ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum FileVerdict {
    /// Everything is as it must be.
    Passed,
    /// All that is there is as it must be, but something isn't there.
    Incomplete,
    /// Something is wrong.
    Failed,
    /// The file could not be read.
    Unreadable,
}

/// Verifies recordings.
pub(super) fn verify(arguments: &VerifyArguments) -> Result<Done, Error> {
    let options = Options {
        reproduce: !arguments.no_reproduce,
    };
    let answers = check_all(&arguments.files, options);
    let files = arguments.files.iter().zip(answers);
    let report = VerifyReport(
        files
            .map(|(file, answer)| VerifiedFile::of(file, answer))
            .collect(),
    );
    let format = arguments.form.format();
    report::print(&report, format, || report.page())?;
    if format != Format::Json {
        for file in &report.0 {
            if let Some(error) = &file.error {
                output::error(&format!("{}: {error}", file.file));
            }
        }
    }
    Ok(report.done())
}

/// Checks all files, as many at once as there are processors.
fn check_all(files: &[PathBuf], options: Options) -> Vec<Answer> {
    let size = |file: &PathBuf| file.metadata().map_or(0, |metadata| metadata.len());
    // Each file is read twice.
    let progress = Progress::of_bytes("verifying", files.iter().map(size).sum::<u64>() * 2);
    let next = AtomicUsize::new(0);
    let answers: Vec<Mutex<Option<Answer>>> = files.iter().map(|_| Mutex::new(None)).collect();
    let work = || {
        loop {
            let position = next.fetch_add(1, Ordering::Relaxed);
            let Some(file) = files.get(position) else {
                break;
            };
            let answer = Recording::open(file)
                .map(|recording| check(&recording, options, &|bytes| progress.add(bytes)));
            if let Ok(mut slot) = answers[position].lock() {
                *slot = Some(answer);
            }
        }
    };
    let workers = thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        for _ in 0..workers.min(files.len()) {
            scope.spawn(work);
        }
    });
    progress.finish();
    let slots = answers
        .into_iter()
        .filter_map(|slot| slot.into_inner().ok());
    slots.flatten().collect()
}

impl VerifyReport {
    /// The worst that happened: unreadable, failed, incomplete.
    fn done(&self) -> Done {
        let has = |verdict| self.0.iter().any(|file| file.verdict == verdict);
        if has(FileVerdict::Unreadable) {
            Done::Unreadable
        } else if has(FileVerdict::Failed) {
            Done::Differing
        } else if has(FileVerdict::Incomplete) {
            Done::WithLosses
        } else {
            Done::Well
        }
    }

    fn page(&self) -> Page {
        Page {
            sections: self.0.iter().filter_map(VerifiedFile::section).collect(),
            ..Page::default()
        }
    }
}

impl VerifiedFile {
    fn of(file: &Path, answer: Answer) -> Self {
        let file = file.display().to_string();
        match answer {
            Ok(report) => Self {
                file,
                verdict: match report.verdict() {
                    Verdict::Failed => FileVerdict::Failed,
                    Verdict::Incomplete => FileVerdict::Incomplete,
                    Verdict::Passed | Verdict::Skipped => FileVerdict::Passed,
                },
                state: Some(report.condition),
                checks: Some(report.checks),
                error: None,
            },
            Err(error) => Self {
                file,
                verdict: FileVerdict::Unreadable,
                state: None,
                checks: None,
                error: Some(error.to_string()),
            },
        }
    }

    /// The checks for people; none if the file could not be read.
    fn section(&self) -> Option<Section> {
        let checks = self.checks.as_deref()?;
        let failed = checks.iter().filter(|c| c.verdict == Verdict::Failed);
        let (tone, conclusion) = match self.verdict {
            FileVerdict::Failed => (
                Tone::Bad,
                format!(
                    "FAILED, {} of {} checks",
                    count(failed.count() as u64),
                    count(checks.len() as u64)
                ),
            ),
            FileVerdict::Incomplete => (
                Tone::Weak,
                format!(
                    "{}: what is there is right, but it is not complete",
                    self.state.map_or("", Condition::name)
                ),
            ),
            FileVerdict::Passed | FileVerdict::Unreadable => (Tone::Good, "verified".to_owned()),
        };
        let mut section = Section::new(format!("{}: {conclusion}", self.file));
        section.tone = tone;
        let mut group = None;
        let row = |check: &Check| {
            let is_next = group.replace(check.group) != Some(check.group);
            let heading = if is_next { check.group.name() } else { "" };
            vec![
                heading.to_owned(),
                format!("{} {}", sign(check.verdict), check.name),
                check.finding.clone(),
            ]
        };
        section.table(Table::of_texts(checks.iter().map(row).collect()));
        Some(section)
    }
}

fn sign(verdict: Verdict) -> char {
    match verdict {
        Verdict::Passed => TICK,
        Verdict::Incomplete => '…',
        Verdict::Failed => CROSS,
        Verdict::Skipped => '–',
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn files_are_named() {
        assert_eq!(
            parse::<VerifyArguments>("a.mcap b.mcap --no-reproduce").unwrap(),
            VerifyArguments {
                files: vec!["a.mcap".into(), "b.mcap".into()],
                no_reproduce: true,
                ..VerifyArguments::default()
            }
        );
        assert!(parse::<VerifyArguments>("").is_err());
    }
}
