//! `toprise verify`.

use super::progress::Progress;
use super::{Done, Format, format, output};
use crate::analysis::verify::{Check, Options, Report, Verdict, verify as check};
use crate::archive::recording::{Recording, RecordingError};
use anyhow::Error;
use clap::Args;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// Arguments of `toprise verify`.
#[derive(Args, Debug, PartialEq)]
pub(super) struct VerifyArguments {
    /// Recordings (MCAP files).
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    /// Don't simulate the scenarios again: a quick check of container, messages and physics.
    #[arg(long)]
    no_reproduce: bool,

    /// Form of the answer.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

type Answer = Result<Report, RecordingError>;

/// Verifies recordings.
pub(super) fn verify(arguments: &VerifyArguments) -> Result<Done, Error> {
    let files = &arguments.files;
    let options = Options {
        reproduce: !arguments.no_reproduce,
    };
    let answers = check_all(files, options);
    let pairs = || files.iter().map(PathBuf::as_path).zip(&answers);
    match arguments.format {
        Format::Text => {
            for (file, answer) in pairs() {
                match answer {
                    Ok(report) => output::print(&text(file, report))?,
                    Err(error) => output::error(&format!("{}: {error}", file.display())),
                }
            }
        }
        Format::Json => {
            let values: Vec<_> = pairs().map(|(file, answer)| value(file, answer)).collect();
            output::print(&format!("{:#}", Value::Array(values)))?;
        }
    }
    Ok(done(&answers))
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

/// The worst that happened: unreadable, failed, incomplete.
fn done(answers: &[Answer]) -> Done {
    let has = |verdict| {
        let mut reports = answers.iter().flatten();
        reports.any(|report| report.verdict() == verdict)
    };
    if answers.iter().any(Result::is_err) {
        Done::Unreadable
    } else if has(Verdict::Failed) {
        Done::Differing
    } else if has(Verdict::Incomplete) {
        Done::WithLosses
    } else {
        Done::Well
    }
}

fn text(file: &Path, report: &Report) -> String {
    let mut text = format!("{}: {}\n", file.display(), conclusion(report));
    let mut group = None;
    let width = report.checks.iter().map(|c| c.name.chars().count()).max();
    let width = width.unwrap_or(0);
    for check in &report.checks {
        let heading = if group == Some(check.group) {
            ""
        } else {
            check.group.name()
        };
        group = Some(check.group);
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "  {heading:<12}  {} {:<width$}  {}",
            mark(check),
            check.name,
            check.finding
        );
    }
    text
}

fn mark(check: &Check) -> &'static str {
    match check.verdict {
        Verdict::Passed => "✓",
        Verdict::Incomplete => "…",
        Verdict::Failed => "✗",
        Verdict::Skipped => "–",
    }
}

fn conclusion(report: &Report) -> String {
    let count = |verdict| {
        report
            .checks
            .iter()
            .filter(|c| c.verdict == verdict)
            .count() as u64
    };
    match report.verdict() {
        Verdict::Failed => format!(
            "FAILED, {} of {} checks",
            format::count(count(Verdict::Failed)),
            format::count(report.checks.len() as u64)
        ),
        Verdict::Incomplete => format!(
            "{}: what is there is right, but it is not complete",
            report.condition.name()
        ),
        _ => "verified".to_owned(),
    }
}

fn value(file: &Path, answer: &Answer) -> Value {
    let mut value = match answer {
        Ok(report) => json!({
            "state": report.condition,
            "verdict": report.verdict(),
            "checks": report.checks,
        }),
        Err(error) => json!({ "verdict": "unreadable", "error": error.to_string() }),
    };
    value["file"] = json!(file.display().to_string());
    value
}
