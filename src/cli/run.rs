//! `toprise run`.

mod arguments;
pub(super) mod file_plan;
mod files;
mod pace;
mod plan;
mod report;

pub(super) use self::arguments::RunArguments;
use self::file_plan::RunFiles;
use self::files::find_identical;
use self::pace::Pace;
use self::plan::RunPlan;
use self::report::Recorded;
pub(super) use self::report::RunReport;
use super::interrupt;
use super::output;
use super::report::{Completed, WrittenFile, print};
use super::rerun::run::RunViewer;
use super::status::Status;
use crate::archive::pipeline::McapSink;
use crate::archive::publish::{Draft, Drafts};
use crate::archive::recording::{Condition, Recording};
use crate::archive::sink::{RecordedRun, Sink, record};
use crate::archive::writer::Header;
use crate::run::outcome::Outcome;
use crate::run::scenario::Preset;
use crate::run::simulation::{Record, Tally};
use crate::telemetry::RunMessages;
use anyhow::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Runs a scenario and records it.
pub(super) fn run(arguments: &RunArguments, drafts: &Drafts) -> Result<Status, Error> {
    let plan = arguments.plan()?;
    // From here on Ctrl-C ends the run with an end record; before, it ends the program.
    interrupt::watch(drafts)?;
    let began = Instant::now();
    let mut run = RunMessages::new(&plan.scenario, &plan.topics)?
        .continue_while(|| !interrupt::is_requested());
    let header = Header::new(&plan.scenario, run.telemetry(), plan.form);
    let RunFiles {
        mut archive,
        rrd,
        earlier,
    } = plan.files.start(drafts, &header)?;
    let viewer = RunViewer::open(
        &plan.show,
        rrd,
        &plan.scenario,
        run.telemetry(),
        archive.path(),
    )?;
    // Until here nothing is lost with the file.
    archive.keep();
    let (outcome, recorded) = record_run(&plan, &mut run, archive, viewer, &earlier)?;
    // Changes are told against the preset, also if the file lists them.
    let base = Preset::find(plan.scenario.name())
        .and_then(Preset::values)
        .unwrap_or(plan.base);
    let report = RunReport::new(&plan.scenario, &base, outcome, recorded, began.elapsed());
    print(&report, || {
        let title = plan.scenario.title_from(&base);
        report.page(&title, &plan.scenario.model, plan.show.note())
    })?;
    let is_complete = report.outcome.end.stop.is_complete();
    Ok(Status::from_whole(
        is_complete && !report.recorded.is_rrd_lost && !report.recorded.is_viewer_lost,
    ))
}

/// Simulates, records and finishes the files, even if the simulation fails.
fn record_run(
    plan: &RunPlan,
    run: &mut RunMessages,
    mut archive: McapSink,
    mut viewer: Option<RunViewer>,
    earlier: &[PathBuf],
) -> Result<(Outcome, Recorded), Error> {
    let mut pace = Pace::start(plan.speed);
    let mut counts = Tally::default();
    let mut sinks: Vec<&mut dyn Sink> = vec![&mut archive];
    if let Some(viewer) = &mut viewer {
        sinks.push(viewer.sink());
    }
    let recorded = record(run, &mut sinks, |record, sinks| {
        if let Record::Event(event) = record {
            counts.record(event.kind, event.time);
        }
        pace.after(record, sinks)
    });
    pace.finish();
    let RecordedRun { end, error } = recorded?;
    // The records so far are valid; the end record marks the run as incomplete.
    if let Some(error) = error {
        output::warn(&error.to_string());
    }
    let (draft, content_digest) = archive.complete(&end)?;
    let outcome = Outcome::new(&plan.scenario, end, counts);
    // Repeating a run would otherwise fill the directory with copies.
    let existing = find_identical(&draft, earlier);
    // With --force, a part of a run would otherwise replace a whole one.
    let is_kept = existing.is_none()
        && !outcome.end.stop.is_complete()
        && plan.files.replaces()
        && is_complete_recording(draft.path());
    let mcap = match &existing {
        Some(existing) => {
            draft.discard();
            existing.clone()
        }
        None if is_kept => keep_partial(draft)?,
        None => WrittenFile::publish(draft)?,
    };
    let rrd = match viewer {
        Some(viewer) if is_kept => viewer.keep_partial(),
        Some(viewer) => {
            let substitute = existing.as_ref().filter(|_| !plan.files.names_rrd());
            finish_viewer(viewer, &outcome, substitute)
        }
        None => Ok(Completed::default()),
    };
    // The MCAP file is complete without it.
    if let Err(error) = &rrd {
        output::error(&output::with_causes(error));
    }
    let recorded = Recorded {
        mcap,
        is_new: existing.is_none(),
        is_rrd_lost: rrd.is_err(),
        is_viewer_lost: rrd.as_ref().is_ok_and(|shown| shown.is_viewer_lost),
        rrd: rrd.ok().and_then(|shown| shown.file),
        content_digest,
    };
    Ok((outcome, recorded))
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

/// Adds the outcome of a complete run to its Rerun recording, and finishes that. `substitute` is an existing MCAP file
/// whose Rerun recording stands for the new one.
fn finish_viewer(
    mut viewer: RunViewer,
    outcome: &Outcome,
    substitute: Option<&WrittenFile>,
) -> Result<Completed, Error> {
    if outcome.end.stop.is_complete() {
        viewer.set_outcome(outcome);
    }
    viewer.finish(substitute)
}
