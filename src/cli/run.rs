//! `toprise run`.

mod arguments;
mod files;
mod pace;
mod report;
#[cfg(feature = "rerun")]
mod viewer;

pub(super) use self::arguments::RunArguments;
use self::files::{ExistingRecordings, RunFiles};
use self::pace::Pace;
pub(super) use self::report::RunReport;
use self::report::{Finished, Recorded};
use super::interrupt;
use super::output;
use super::report::{WrittenFile, print};
use super::status::Status;
use crate::archive::pipeline::McapSink;
use crate::archive::sink::{Sink, record_to_end};
use crate::archive::writer::Form;
#[cfg(feature = "rerun")]
use crate::run::outcome::Outcome;
use crate::run::scenario::{Preset, Scenario};
use crate::run::simulation::{Record, Simulation, StopReason, Tally};
use crate::telemetry::Telemetry;
use anyhow::Error;
use std::time::Instant;

/// Runs a scenario and records it.
pub(super) fn run(arguments: &RunArguments) -> Result<Status, Error> {
    arguments.check_output()?;
    let values = arguments.values()?;
    let scenario = arguments.scenario(values.clone())?;
    let (form, topics) = arguments.form()?;
    let telemetry = Telemetry::with_topics(&topics);
    interrupt::watch()?;
    #[cfg(feature = "rerun")]
    let target = arguments.viewer.target()?;
    let recorder = Recorder {
        arguments,
        scenario: &scenario,
        form,
        #[cfg(feature = "rerun")]
        live: target.live(),
    };
    let began = Instant::now();
    let mut simulation = Simulation::new(&scenario)?.continue_while(|| !interrupt::is_requested());
    let preface = McapSink::preface(&scenario, &telemetry, form)?;
    let (files, earlier) =
        RunFiles::start(arguments, &arguments.stem(&scenario, &values), &preface)?;
    let finished = recorder.record(files, &earlier, telemetry, &mut simulation)?;
    let base = Preset::find(scenario.name()).and_then(Preset::values);
    let base = base.unwrap_or(values);
    let report = RunReport::of(&scenario, &base, &finished, began.elapsed());
    let name = scenario.title_from(&base);
    let top = &scenario.model.top;
    print(&report, || report.page(&name, top, arguments.note_on_rrd()))?;
    #[cfg(feature = "rerun")]
    target.serve_until_interrupted();
    Ok(match finished.end.stop {
        StopReason::Interrupted | StopReason::Failed => Status::Partial,
        _ if finished.is_rrd_lost => Status::Partial,
        _ => Status::Success,
    })
}

/// Records a run.
struct Recorder<'a> {
    arguments: &'a RunArguments,
    scenario: &'a Scenario,
    form: Form,
    #[cfg(feature = "rerun")]
    live: Option<crate::rerun::Live>,
}

impl Recorder<'_> {
    /// Simulates, records and finishes the files, even if the simulation fails.
    fn record(
        self,
        files: RunFiles,
        earlier: &ExistingRecordings,
        mut telemetry: Telemetry,
        simulation: &mut Simulation,
    ) -> Result<Finished, Error> {
        let (arguments, scenario) = (self.arguments, self.scenario);
        #[cfg(feature = "rerun")]
        let mut viewer = {
            let identity = viewer::identity(arguments, files.mcap.path(), scenario, &telemetry);
            viewer::RunViewer::open(&identity, files.rrd, self.live)?
        };
        let mut archive = McapSink::create_in(files.mcap, scenario, &telemetry, self.form)?;
        let mut sinks: Vec<&mut dyn Sink> = vec![&mut archive];
        #[cfg(feature = "rerun")]
        sinks.extend(
            viewer
                .as_mut()
                .map(|viewer| &mut viewer.sink as &mut dyn Sink),
        );

        let mut pace = Pace::start(arguments.realtime);
        let mut counts = Tally::default();
        let ended = record_to_end(simulation, &mut telemetry, &mut sinks, |record, sinks| {
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
        let there = earlier.same_as(&draft);
        let mcap = match &there {
            Some(there) => {
                draft.discard();
                there.clone()
            }
            None => WrittenFile::publish(draft)?,
        };
        #[cfg(feature = "rerun")]
        let rrd = viewer.map_or(Ok(None), |mut viewer| {
            if !matches!(end.stop, StopReason::Interrupted | StopReason::Failed) {
                let outcome = Outcome::new(scenario, end, counts.clone());
                viewer.sink.set_outcome(&outcome);
            }
            viewer.finish(arguments.adjacent_rrd(there.as_ref()))
        });
        #[cfg(not(feature = "rerun"))]
        let rrd: Result<_, Error> = Ok(None);
        // The MCAP file is complete without it.
        if let Err(error) = &rrd {
            output::warn(&output::with_causes(error));
        }
        Ok(Finished {
            end,
            counts,
            is_rrd_lost: rrd.is_err(),
            recorded: Recorded {
                mcap,
                is_new: there.is_none(),
                rrd: rrd.ok().flatten(),
                content_digest: digest,
            },
        })
    }
}
