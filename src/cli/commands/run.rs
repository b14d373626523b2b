//! `toprise run`.

mod arguments;
mod file_plan;
mod files;
mod pace;
mod report;
mod target;

pub(super) use self::arguments::RunArguments;
use self::arguments::RunPlan;
pub(in crate::cli) use self::file_plan::FilePlan;
pub(in crate::cli) use self::files::McapFile;
use self::pace::Pace;
use self::report::Recorded;
pub(super) use self::report::RunReport;
use self::target::McapTarget;
use crate::archive::pipeline::Ended;
use crate::archive::publish::Drafts;
use crate::archive::sink::{RecordedRun, Sink, record};
use crate::archive::supplements::{Supplements, about};
use crate::archive::writer::Header;
use crate::cli::extension::RunViewer;
use crate::cli::interrupt;
use crate::cli::output;
use crate::cli::report::{Completed, print};
use crate::cli::status::Status;
use crate::run::outcome::Outcome;
use crate::run::scenario::Preset;
use crate::telemetry::RunMessages;
use anyhow::Error;
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
    let mut target = McapTarget::start(&files, drafts, &header)?;
    let mut viewer = match &show {
        Some(show) => show.open(&files, drafts, target.path(), &scenario, run.telemetry())?,
        None => None,
    };
    // Until here nothing is lost with the file.
    target.keep();
    let outcome = simulate(&mut run, target.sink(), viewer.as_mut(), Pace::start(speed))?;
    let supplements = Supplements {
        source: repeated.as_deref(),
        metadata: about.map(|about| (about::RECORD, about.to_entries())),
    };
    let Ended {
        target: mcap,
        content_digest,
        has_all_supplements,
    } = target.finish(&files, &outcome, &supplements)?;
    if !has_all_supplements {
        let name = files.input().display();
        output::warn(&format!(
            "{name} is damaged: what it holds in addition to its run is copied as far as it can be read"
        ));
    }
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
    // Standard output has one recording and nothing else.
    if !files.is_streamed() {
        print(&report, || {
            let title = scenario.title_from(&base);
            let note = show.as_ref().and_then(|show| show.note());
            report.page(&title, &scenario.model, note)
        })?;
    }
    let is_complete = report.outcome.end.stop.is_complete();
    Ok(Status::from_whole(
        is_complete
            && has_all_supplements
            && !report.recorded.is_rrd_lost
            && !report.recorded.is_viewer_lost,
    ))
}

/// Simulates a run, and writes its messages to the MCAP file and the viewer. A simulation that fails on the way is an
/// incomplete run with a warning.
fn simulate(
    run: &mut RunMessages,
    archive: &mut dyn Sink,
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
