//! The Rerun side of a run: a file, a live viewer, or both.

use super::super::output;
use super::{Plan, RunArguments};
use crate::scenario::Scenario;
use crate::sink::publish::Place;
use crate::sink::rerun::{Destinations, Geometry, Identity, Live, Playback, RerunSink};
use crate::sink::{Sink, SinkError};
use crate::telemetry::{Telemetry, channels};
use anyhow::{Context as _, Error};
use std::path::PathBuf;

/// Feeds Rerun, if the run asks for it.
pub(super) struct Viewer {
    sink: Option<RerunSink>,
    place: Option<Place>,
}

impl Viewer {
    /// Opens what the arguments ask for. A viewer that can't be reached is a warning.
    pub(super) fn open(
        arguments: &RunArguments,
        plan: &Plan,
        scenario: &Scenario,
        telemetry: &Telemetry,
    ) -> Result<Self, Error> {
        let reserved = match &plan.rrd {
            Some(path) => Some(Place::reserve(path, arguments.existing())?),
            None => None,
        };
        let (place, file) = reserved.unzip();
        let live = match (&arguments.connect, arguments.spawn) {
            (Some(url), _) => Some(Live::Connect(url.clone())),
            (None, true) => Some(Live::Spawn),
            (None, false) => None,
        };
        if file.is_none() && live.is_none() {
            return Ok(Self { sink: None, place });
        }
        let identity = identity(arguments, plan, scenario, telemetry);
        let sink = RerunSink::new(&identity, Destinations { file, live });
        let mut sink = sink.map_err(SinkError::from)?;
        warn_all(sink.take_warnings());
        Ok(Self {
            sink: Some(sink),
            place,
        })
    }

    /// The sink, if there is one.
    pub(super) fn sink(&mut self) -> Option<&mut dyn Sink> {
        self.sink.as_mut().map(|sink| sink as &mut dyn Sink)
    }

    /// Ends the stream; gives the name and size of the file, if there is one.
    pub(super) fn finish(self) -> Result<Option<(PathBuf, u64)>, Error> {
        let Some(sink) = self.sink else {
            return Ok(None);
        };
        let (file, warnings) = sink.finish().map_err(SinkError::from)?;
        warn_all(warnings);
        let Some((place, file)) = self.place.zip(file) else {
            return Ok(None);
        };
        let metadata = file.metadata();
        let bytes = metadata.with_context(|| place.partial().display().to_string())?;
        place.publish(&file)?;
        Ok(Some((place.path().to_owned(), bytes.len())))
    }
}

fn warn_all(warnings: Vec<String>) {
    for warning in warnings {
        output::warn(&warning);
    }
}

fn identity(
    arguments: &RunArguments,
    plan: &Plan,
    scenario: &Scenario,
    telemetry: &Telemetry,
) -> Identity {
    let stem = plan.mcap.file_stem().unwrap_or_default().to_string_lossy();
    let top = &scenario.model.top;
    let topics = channels().iter().enumerate();
    Identity {
        // Two runs of one scenario are two recordings to a viewer, as they are two files.
        recording_id: format!("{stem}-{:.16}", scenario.digest()),
        name: stem.into_owned(),
        description: description(scenario),
        geometry: Geometry {
            top: *top,
            force_scale: scenario.model.friction.law.force_scale(top.weight()),
            slip_scale: scenario.slip_speed_at_start(),
        },
        topics: topics
            .filter(|(index, _)| telemetry.wants(*index))
            .map(|(_, channel)| channel.topic.to_owned())
            .collect(),
        playback: if arguments.realtime.is_some() {
            Playback::Following
        } else {
            Playback::PausedAtStart
        },
    }
}

/// About the run, in Markdown.
fn description(scenario: &Scenario) -> String {
    format!(
        "# {}\n\n{}\n\n```toml\n{}```\n",
        scenario.name(),
        scenario.description(),
        scenario.to_toml()
    )
}
