//! `toprise run`.

mod arguments;
mod files;
mod pace;
mod report;
#[cfg(feature = "rerun")]
mod viewer;

pub(super) use self::arguments::RunArguments;
use self::files::same_as;
use self::pace::Pace;
use self::report::Recorded;
pub(super) use self::report::RunReport;
#[cfg(feature = "rerun")]
use self::viewer::RunViewer;
use super::interrupt;
use super::output;
use super::report::{WrittenFile, print};
use super::status::Status;
use crate::archive::pipeline::McapSink;
use crate::archive::sink::{Sink, record_to_end};
use crate::run::outcome::Outcome;
use crate::run::scenario::{Preset, Scenario};
use crate::run::simulation::{Record, Simulation, Tally};
use crate::telemetry::Telemetry;
use anyhow::Error;
use std::path::PathBuf;
use std::time::Instant;

/// Runs a scenario and records it.
pub(super) fn run(arguments: &RunArguments) -> Result<Status, Error> {
    arguments.check_output()?;
    let values = arguments.values()?;
    let scenario = arguments.scenario(values.clone())?;
    let (form, topics) = arguments.form()?;
    let mut telemetry = Telemetry::with_topics(&topics);
    interrupt::watch()?;
    let began = Instant::now();
    let mut simulation = Simulation::new(&scenario)?.continue_while(|| !interrupt::is_requested());
    let preface = McapSink::preface(&scenario, &telemetry, form)?;
    let stem = arguments.stem(&scenario, &values);
    let (mcap, earlier) = files::start(arguments, &stem, &preface)?;
    #[cfg(feature = "rerun")]
    let viewer = {
        let identity = viewer::identity(arguments, mcap.path(), &scenario, &telemetry);
        RunViewer::open(arguments, mcap.path(), &identity)?
    };
    let archive = McapSink::create_in(mcap, &scenario, &telemetry, form)?;
    let (outcome, recorded) = record(
        arguments,
        &scenario,
        &earlier,
        archive,
        #[cfg(feature = "rerun")]
        viewer,
        &mut telemetry,
        &mut simulation,
    )?;
    let base = Preset::find(scenario.name()).and_then(Preset::values);
    let base = base.unwrap_or(values);
    let report = RunReport::of(&scenario, &base, outcome, recorded, began.elapsed());
    let name = scenario.title_from(&base);
    let top = &scenario.model.top;
    print(&report, || report.page(&name, top, arguments.note_on_rrd()))?;
    let is_complete = report.outcome.end.stop.is_complete();
    Ok(Status::of_whole(
        is_complete && !report.recorded.is_rrd_lost,
    ))
}

/// Simulates, records and finishes the files, even if the simulation fails.
fn record(
    arguments: &RunArguments,
    scenario: &Scenario,
    earlier: &[PathBuf],
    mut archive: McapSink,
    #[cfg(feature = "rerun")] mut viewer: Option<RunViewer>,
    telemetry: &mut Telemetry,
    simulation: &mut Simulation,
) -> Result<(Outcome, Recorded), Error> {
    let mut sinks: Vec<&mut dyn Sink> = vec![&mut archive];
    #[cfg(feature = "rerun")]
    if let Some(viewer) = &mut viewer {
        sinks.push(&mut viewer.sink);
    }

    let mut pace = Pace::start(arguments.realtime);
    let mut counts = Tally::default();
    let ended = record_to_end(simulation, telemetry, &mut sinks, |record, sinks| {
        if let Record::Event(event) = record {
            counts.count(event.kind, event.time);
        }
        pace.after(record, sinks)
    });
    pace.finish();
    let (end, error) = ended?;
    // The records so far are valid; the end record marks the run as incomplete.
    if let Some(error) = error {
        output::warn(&error.to_string());
    }
    drop(sinks);
    let (draft, digest) = archive.complete(&end)?;
    let outcome = Outcome::new(scenario, end, counts);
    let there = same_as(&draft, earlier);
    let mcap = match &there {
        Some(there) => {
            draft.discard();
            there.clone()
        }
        None => WrittenFile::publish(draft)?,
    };
    #[cfg(feature = "rerun")]
    let rrd = viewer.map_or(Ok(None), |mut viewer| {
        if end.stop.is_complete() {
            viewer.sink.set_outcome(&outcome);
        }
        viewer.finish(arguments.adjacent_rrd(there.as_ref()))
    });
    #[cfg(not(feature = "rerun"))]
    let rrd: Result<_, Error> = Ok(None);
    // The MCAP file is complete without it.
    if let Err(error) = &rrd {
        output::error(&output::with_causes(error));
    }
    let recorded = Recorded {
        mcap,
        is_new: there.is_none(),
        is_rrd_lost: rrd.is_err(),
        rrd: rrd.ok().flatten(),
        content_digest: digest,
    };
    Ok((outcome, recorded))
}
