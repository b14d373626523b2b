//! `toprise run`: from a scenario to recordings.

mod files;
mod pace;
mod summary;
#[cfg(feature = "rerun")]
mod viewer;

use super::interrupt::Interrupt;
use super::{Done, EncodingName, Format, output};
use crate::archive::publish::Existing;
use crate::archive::sink::{RecordError, Sink, record};
use crate::archive::writer::{Archived, Form, McapSink};
use crate::run::scenario::{PRESETS, Preset, Scenario, Values};
use crate::run::simulation::{EventKind, Outcome, Record, Simulation, StopReason};
use crate::telemetry::{Telemetry, Topics};
use anyhow::{Context as _, Error};
use clap::Args;
use files::Files;
use pace::Pace;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use summary::Summary;

/// Arguments of `toprise run`.
#[derive(Args, Debug, PartialEq)]
pub(super) struct RunArguments {
    /// A preset (see `toprise presets`) or a scenario file.
    #[arg(default_value = "paper")]
    pub(super) scenario: String,

    /// Set a key of the scenario, as in friction.k=0.02; an empty value removes the key.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_override)]
    overrides: Vec<(String, String)>,

    /// The MCAP file to write; without this option, the next free name in ./recordings, and an .rrd
    /// file beside it.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Write a Rerun recording into this file.
    #[cfg(feature = "rerun")]
    #[arg(long, value_name = "FILE")]
    rrd: Option<PathBuf>,

    /// Write no Rerun recording.
    #[cfg(feature = "rerun")]
    #[arg(long, conflicts_with = "rrd")]
    no_rrd: bool,

    #[cfg(feature = "rerun")]
    #[command(flatten)]
    viewer: super::viewer::ViewerArguments,

    /// Encoding of the MCAP file's messages.
    #[arg(long, value_enum, default_value_t = EncodingName::Json)]
    encoding: EncodingName,

    /// Leave out the channels that let viewers show the MCAP file by themselves.
    #[arg(long)]
    no_views: bool,

    /// Log only these topics, separated by commas.
    #[arg(long, value_name = "TOPICS", value_delimiter = ',')]
    topics: Vec<String>,

    /// Run no faster than real time, or than SPEED times real time.
    #[arg(long, value_name = "SPEED", num_args = 0..=1, default_missing_value = "1",
          value_parser = parse_speed)]
    realtime: Option<f64>,

    /// Replace files that exist.
    #[arg(long)]
    force: bool,

    /// Form of the summary.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

impl RunArguments {
    fn existing(&self) -> Existing {
        Existing::forced(self.force)
    }

    fn form(&self) -> Form {
        Form {
            encoding: self.encoding.into(),
            views: !self.no_views,
        }
    }

    fn telemetry(&self) -> Result<Telemetry, Error> {
        Ok(if self.topics.is_empty() {
            Telemetry::default()
        } else {
            Telemetry::with_topics(&Topics::named(&self.topics)?)
        })
    }
}

/// The files that a run has made.
struct Written {
    archive: Archived,
    rrd: Option<(PathBuf, u64)>,
    /// Whether a Rerun recording was wanted but could not be written.
    is_rrd_lost: bool,
}

/// Runs a scenario and records it.
pub(super) fn run(arguments: &RunArguments) -> Result<Done, Error> {
    let scenario = scenario(&arguments.scenario, &arguments.overrides)?;
    let telemetry = arguments.telemetry()?;
    let interrupt = Interrupt::watch()?;
    #[cfg(feature = "rerun")]
    let target = arguments.viewer.target()?;
    let setup = Setup {
        arguments,
        scenario: &scenario,
        interrupt: &interrupt,
        #[cfg(feature = "rerun")]
        live: target.live(),
    };
    let began = Instant::now();
    let mut simulation = Simulation::new(&scenario)?;
    let (files, earlier) = Files::start(arguments, &scenario)?;
    let (outcome, counts, written) = record_run(setup, files, telemetry, &mut simulation)?;
    let summary = Summary {
        scenario: &scenario,
        outcome: &outcome,
        counts: &counts,
        written: &written,
        same_as: earlier.identical(&written.archive),
        wall: began.elapsed(),
    };
    output::print(&match arguments.format {
        Format::Text => summary.text(),
        Format::Json => format!("{:#}", summary.json()),
    })?;
    #[cfg(feature = "rerun")]
    target.serve_until(&interrupt);
    Ok(match outcome.stop {
        StopReason::Interrupted | StopReason::Failed => Done::WithLosses,
        _ if written.is_rrd_lost => Done::WithLosses,
        _ => Done::Well,
    })
}

/// What a run is recorded with.
struct Setup<'a> {
    arguments: &'a RunArguments,
    scenario: &'a Scenario,
    interrupt: &'a Interrupt,
    #[cfg(feature = "rerun")]
    live: Option<crate::rerun::Live>,
}

/// Simulates, logs, and finishes the files, however the simulation ends.
fn record_run(
    setup: Setup<'_>,
    files: Files,
    mut telemetry: Telemetry,
    simulation: &mut Simulation,
) -> Result<(Outcome, EventCounts, Written), Error> {
    let Setup {
        arguments,
        scenario,
        ..
    } = setup;
    #[cfg(feature = "rerun")]
    let mut viewer = viewer::Viewer::open(&setup, files.rrd, files.mcap.path(), &telemetry)?;
    let mut archive = McapSink::create_in(files.mcap, scenario, &telemetry, arguments.form())?;
    let mut sinks: Vec<&mut dyn Sink> = vec![&mut archive];
    #[cfg(feature = "rerun")]
    sinks.extend(viewer.sink());

    let mut pace = Pace::start(arguments.realtime, setup.interrupt.clone());
    let mut counts = EventCounts::default();
    let ended = record(simulation, &mut telemetry, &mut sinks, |record, sinks| {
        counts.count(record);
        pace.after(record, sinks)
    });
    pace.finish();
    let outcome = match ended {
        Ok(outcome) => outcome,
        // What was recorded up to here is good; the end record says that it is not the whole run.
        Err(error @ (RecordError::Simulation(_) | RecordError::Telemetry(_))) => {
            output::warn(&error.to_string());
            Outcome {
                stop: StopReason::Failed,
                ..simulation.outcome()
            }
        }
        Err(RecordError::Sink(error)) => return Err(error.into()),
    };
    drop(sinks);
    let archive = archive.finish(&outcome)?;
    #[cfg(feature = "rerun")]
    let rrd = viewer.finish();
    #[cfg(not(feature = "rerun"))]
    let rrd: Result<_, Error> = Ok(None);
    // The archive is whole without it.
    if let Err(error) = &rrd {
        output::warn(&format!("{error:#}"));
    }
    let written = Written {
        archive,
        is_rrd_lost: rrd.is_err(),
        rrd: rrd.unwrap_or_default(),
    };
    Ok((outcome, counts, written))
}

/// How often each kind of event happened, in the order of their first times.
#[derive(Debug, Default)]
struct EventCounts(Vec<(EventKind, u64, f64)>);

impl EventCounts {
    fn count(&mut self, record: &Record) {
        let Record::Event(event) = record else {
            return;
        };
        match self.0.iter_mut().find(|(kind, ..)| *kind == event.kind) {
            Some((_, count, _)) => *count += 1,
            None => self.0.push((event.kind, 1, event.time)),
        }
    }
}

/// The scenario that a word on the command line means, with some keys set otherwise.
pub(super) fn scenario(word: &str, overrides: &[(String, String)]) -> Result<Scenario, Error> {
    let is_preset = PRESETS.iter().any(|preset| preset.name == word);
    let is_path =
        word.contains(['/', '\\']) || word.ends_with(".toml") || Path::new(word).is_file();
    let (source, mut values) = if is_preset || !is_path {
        (word.to_owned(), Preset::find(word)?.values()?)
    } else {
        let text =
            fs::read_to_string(word).with_context(|| format!("cannot read the scenario {word}"))?;
        let values = Values::from_toml(&text).with_context(|| word.to_owned())?;
        (word.to_owned(), values)
    };
    for (key, value) in overrides {
        values
            .set(key, value)
            .with_context(|| format!("--set {key}={value}"))?;
    }
    Scenario::new(values).with_context(|| source)
}

pub(super) fn parse_override(text: &str) -> Result<(String, String), String> {
    text.split_once('=')
        .map(|(key, value)| (key.trim().to_owned(), value.trim().to_owned()))
        .ok_or_else(|| "must be KEY=VALUE, as in friction.k=0.02".to_owned())
}

/// A time in seconds, not negative.
#[cfg(feature = "rerun")]
pub(super) fn parse_seconds(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|time: &f64| (0.0..=1e9).contains(time))
        .ok_or_else(|| "must be a time in seconds, 0 or more, as in 12.5".to_owned())
}

fn parse_speed(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|speed: &f64| speed.is_finite() && *speed > 0.0)
        .ok_or_else(|| "must be a number > 0, as in 0.5".to_owned())
}
