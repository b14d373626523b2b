//! `toprise run`.

mod arguments;
mod file_plan;
mod files;
mod pace;
mod plan;
mod report;

pub(super) use self::arguments::RunArguments;
pub(in crate::cli) use self::file_plan::FilePlan;
pub(in crate::cli) use self::files::McapFile;
use self::files::find_identical;
use self::pace::Pace;
use self::plan::RunPlan;
use self::report::Recorded;
pub(super) use self::report::RunReport;
use crate::archive::pipeline::McapSink;
use crate::archive::publish::{Draft, Drafts};
use crate::archive::recording::{Condition, Recording};
use crate::archive::sink::{RecordedRun, Sink, record};
use crate::archive::supplements::{Supplements, about};
use crate::archive::writer::Header;
use crate::cli::extension::RunViewer;
use crate::cli::interrupt;
use crate::cli::output;
use crate::cli::report::{Completed, WrittenFile, print};
use crate::cli::status::Status;
use crate::run::outcome::Outcome;
use crate::run::scenario::Preset;
use crate::telemetry::RunMessages;
use anyhow::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Runs a scenario and records it.
pub(super) fn run(arguments: &RunArguments, drafts: &Drafts) -> Result<Status, Error> {
    let RunPlan {
        scenario,
        base,
        form,
        topics,
        repeated,
        about,
        speed,
        files,
        show,
    } = arguments.plan()?;
    // From here on Ctrl-C ends the run with an end record; before, it ends the program.
    interrupt::watch(drafts)?;
    let began = Instant::now();
    let mut run =
        RunMessages::new(&scenario, &topics)?.continue_while(|| !interrupt::is_requested());
    let header = Header::new(&scenario, run.telemetry(), form);
    let (mut archive, earlier) = files.start_mcap(drafts, &header)?;
    let mut viewer = match &show {
        Some(show) => show.open(&files, drafts, archive.path(), &scenario, run.telemetry())?,
        None => None,
    };
    // Until here nothing is lost with the file.
    archive.keep();
    let outcome = simulate(&mut run, &mut archive, viewer.as_mut(), Pace::start(speed))?;
    let supplements = Supplements {
        source: repeated.as_deref(),
        metadata: about.map(|about| (about::RECORD, about.to_entries())),
    };
    let (draft, content_digest) = archive.complete_with(&outcome.end, &supplements)?;
    let mcap = finish_mcap(draft, &files, &earlier, &outcome)?;
    let rrd = match viewer {
        Some(viewer) => viewer.finish(&mcap, &outcome),
        None => Ok(Completed::default()),
    };
    // The MCAP file is complete without it.
    if let Err(error) = &rrd {
        output::error(&output::with_causes(error));
    }
    let recorded = Recorded {
        is_new: !matches!(mcap, McapFile::Identical(_)),
        mcap: mcap.into_file(),
        is_rrd_lost: rrd.is_err(),
        is_viewer_lost: rrd.as_ref().is_ok_and(|shown| shown.is_viewer_lost),
        rrd: rrd.ok().and_then(|shown| shown.file),
        content_digest,
    };
    // The report shows changes from the preset, also if the file lists them.
    let base = Preset::find(scenario.name())
        .and_then(Preset::values)
        .unwrap_or(base);
    let report = RunReport::new(&scenario, &base, outcome, recorded, began.elapsed());
    print(&report, || {
        let title = scenario.title_from(&base);
        let note = show.as_ref().and_then(|show| show.note());
        report.page(&title, &scenario.model, note)
    })?;
    let is_complete = report.outcome.end.stop.is_complete();
    Ok(Status::from_whole(
        is_complete && !report.recorded.is_rrd_lost && !report.recorded.is_viewer_lost,
    ))
}

/// Simulates a run, and writes its messages to the MCAP file and the viewer. A simulation that fails on the way is an
/// incomplete run with a warning.
fn simulate(
    run: &mut RunMessages,
    archive: &mut McapSink,
    viewer: Option<&mut Box<dyn RunViewer>>,
    mut pace: Pace,
) -> Result<Outcome, Error> {
    let mut sinks: Vec<&mut dyn Sink> = vec![archive];
    if let Some(viewer) = viewer {
        sinks.push(viewer.sink());
    }
    let recorded = record(run, &mut sinks, |record, sinks| pace.after(record, sinks));
    // Before any error or warning is printed.
    pace.finish();
    let RecordedRun { outcome, error } = recorded?;
    // The records so far are valid; the end record marks the run as incomplete.
    if let Some(error) = error {
        output::warn(&error.to_string());
    }
    Ok(outcome)
}

/// Gives the MCAP file its name, unless there is an identical one among the `earlier` recordings.
fn finish_mcap(
    draft: Draft,
    files: &FilePlan,
    earlier: &[PathBuf],
    outcome: &Outcome,
) -> Result<McapFile, Error> {
    // Repeating a run would otherwise fill the directory with copies.
    if let Some(existing) = find_identical(&draft, earlier) {
        draft.discard();
        return Ok(McapFile::Identical(existing));
    }
    // With --force, a part of a run would otherwise replace a whole one.
    let is_part = !outcome.end.stop.is_complete();
    if is_part && files.replaces() && is_complete_recording(draft.path()) {
        return Ok(McapFile::Partial(keep_partial(draft)?));
    }
    Ok(McapFile::New(WrittenFile::publish(draft)?))
}

/// Whether there is a recording of a whole run.
fn is_complete_recording(path: &Path) -> bool {
    Recording::open(path).is_ok_and(|recording| recording.condition() == Condition::Whole)
}

/// Leaves the file of an incomplete run under its partial name, because a complete recording has its own.
fn keep_partial(draft: Draft) -> Result<WrittenFile, Error> {
    let (path, partial) = (draft.path().to_owned(), draft.working_name().to_owned());
    // From the start of the run, a draft stays if it is not published.
    drop(draft);
    output::warn(&format!(
        "{} is a complete recording and stays as it is; the incomplete run is {}",
        path.display(),
        partial.display()
    ));
    Ok(WrittenFile::new(&partial, partial.metadata()?.len()))
}
