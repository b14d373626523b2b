//! `toprise verify`.

use super::arguments::{FormArguments, Format};
use super::done::Done;
use super::numbers::count;
use super::page::{CROSS, Page, Section, TICK, Tone};
use super::progress::Progress;
use super::table::Table;
use super::{output, report};
use crate::analysis::verify::{Check, Group, Options, Report, Verdict, verify as check};
use crate::archive::recording::{Condition, Recording, RecordingError};
use crate::telemetry::table;
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

    /// Show each check, also those of a group in which all is well.
    #[arg(long)]
    all: bool,

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
    /// The version of the telemetry that it holds; absent if that isn't known.
    #[serde(skip_serializing_if = "Option::is_none")]
    telemetry: Option<u32>,
    /// Topics of toprise that it doesn't have.
    without: Vec<String>,
    /// What a reader of the file sees and no check covers: words of its author, and what others have added.
    not_covered: Vec<String>,
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
    /// Everything is as it must be; some channels were not recorded, which `without` names.
    Partial,
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
    report::print(&report, format, || report.page(arguments.all))?;
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
            let answer = Recording::open(file).and_then(|recording| {
                recording.refuse_newer()?;
                Ok(check(&recording, options, &|bytes| progress.add(bytes)))
            });
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

    fn page(&self, all: bool) -> Page {
        let sections = self.0.iter().filter_map(|file| file.section(all));
        Page {
            sections: sections.collect(),
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
                    Verdict::Partial => FileVerdict::Partial,
                    Verdict::Passed | Verdict::Skipped => FileVerdict::Passed,
                },
                state: Some(report.condition),
                checks: Some(report.checks),
                telemetry: report.telemetry,
                without: report.without,
                not_covered: report.not_covered,
                error: None,
            },
            Err(error) => Self {
                file,
                verdict: FileVerdict::Unreadable,
                state: None,
                checks: None,
                telemetry: None,
                without: Vec::new(),
                not_covered: Vec::new(),
                error: Some(error.to_string()),
            },
        }
    }

    /// The checks for people, each with its finding if `all` are to be shown; none if the file could not be read.
    fn section(&self, all: bool) -> Option<Section> {
        let checks = self.checks.as_deref()?;
        let (tone, conclusion) = self.conclusion(checks);
        let mut section = Section::new(format!("{}: {conclusion}", self.file));
        section.tone = tone;
        let mut rows = Vec::new();
        for group in checks.chunk_by(|one, next| one.group == next.group) {
            let told = if all { each(group) } else { in_short(group) };
            let mut name = group[0].group.name();
            for cells in told {
                rows.push([&[std::mem::take(&mut name).to_owned()], &cells[..]].concat());
            }
        }
        let mut label = "not covered";
        for what in &self.not_covered {
            let mut row = vec![std::mem::take(&mut label).to_owned(), what.clone()];
            if all {
                row.insert(1, String::new());
            }
            rows.push(row);
        }
        section.table(Table::of_texts(rows));
        Some(section)
    }

    fn conclusion(&self, checks: &[Check]) -> (Tone, String) {
        let with = |verdict| checks.iter().filter(move |check| check.verdict == verdict);
        let number = |checks: usize| count(checks as u64);
        match self.verdict {
            FileVerdict::Failed => {
                let failed = with(Verdict::Failed).count();
                let conclusion = format!(
                    "FAILED, {} of {} checks",
                    number(failed),
                    number(checks.len())
                );
                (Tone::Bad, conclusion)
            }
            FileVerdict::Incomplete => {
                // The file may be whole, and the run in it not.
                let state = match self.state {
                    Some(Condition::Whole) | None => "a part of a run",
                    Some(state) => state.name(),
                };
                let conclusion = format!("{state}: what is there is right, but it is not complete");
                (Tone::Weak, conclusion)
            }
            FileVerdict::Passed | FileVerdict::Partial | FileVerdict::Unreadable => {
                let is_simulated = with(Verdict::Passed).any(|c| c.group == Group::Reproduction);
                let mut conclusion = match is_simulated {
                    true => "verified".to_owned(),
                    false => "sound in itself, but not simulated again".to_owned(),
                };
                if let Some(former) = self.telemetry.filter(|number| *number < table::VERSION) {
                    conclusion += &format!(", as telemetry {former}");
                }
                if !self.without.is_empty() {
                    conclusion += &format!(", without {}", self.without.join(", "));
                }
                (Tone::Good, conclusion)
            }
        }
    }
}

/// Each check of a group with its finding.
fn each(group: &[Check]) -> Vec<Vec<String>> {
    let cells = |check: &Check| {
        let name = format!("{} {}", sign(check.verdict), check.name);
        vec![name, check.finding.clone()]
    };
    group.iter().map(cells).collect()
}

/// The checks of a group that were passed by their names, and the others with their findings.
fn in_short(group: &[Check]) -> Vec<Vec<String>> {
    if let [only] = group {
        let words = match only.verdict {
            Verdict::Skipped => format!("{}: ", only.name),
            _ => String::new(),
        };
        return vec![vec![format!(
            "{} {words}{}",
            sign(only.verdict),
            only.finding
        )]];
    }
    let is_well = |check: &&Check| matches!(check.verdict, Verdict::Passed | Verdict::Skipped);
    let mut lines = Vec::new();
    for (verdict, words) in [(Verdict::Passed, ""), (Verdict::Skipped, "not judged: ")] {
        let found = group.iter().filter(|check| check.verdict == verdict);
        let names: Vec<_> = found.map(|check| check.name).collect();
        if !names.is_empty() {
            lines.push(vec![format!(
                "{} {words}{}",
                sign(verdict),
                names.join(", ")
            )]);
        }
    }
    for check in group.iter().filter(|check| !is_well(check)) {
        let (sign, name, finding) = (sign(check.verdict), check.name, &check.finding);
        lines.push(vec![format!("{sign} {name}: {finding}")]);
    }
    lines
}

fn sign(verdict: Verdict) -> char {
    match verdict {
        Verdict::Passed => TICK,
        Verdict::Incomplete | Verdict::Partial => '…',
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
