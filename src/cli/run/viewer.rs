//! The Rerun side of a run: a file, a live viewer, or both.

use super::super::output;
use super::Setup;
use crate::archive::publish::Place;
use crate::archive::sink::{Sink, SinkError};
use crate::rerun::{Destinations, Identity, Playback, RerunSink};
use crate::telemetry::{Telemetry, Topic};
use anyhow::{Context as _, Error};
use std::path::PathBuf;

/// Feeds Rerun, if the run asks for it.
pub(super) struct Viewer {
    sink: Option<RerunSink>,
    place: Option<Place>,
}

impl Viewer {
    /// Opens what the run asks for. A viewer that can't be reached is a warning.
    pub(super) fn open(setup: &Setup<'_>, telemetry: &Telemetry) -> Result<Self, Error> {
        let reserved = match &setup.plan.rrd {
            Some(path) => Some(Place::reserve(path, setup.arguments.existing())?),
            None => None,
        };
        let (place, file) = reserved.unzip();
        let live = setup.live.clone();
        if file.is_none() && live.is_none() {
            return Ok(Self { sink: None, place });
        }
        let identity = identity(setup, telemetry);
        let sink = RerunSink::new(&identity, Destinations { file, live });
        let mut sink = sink.map_err(SinkError::from)?;
        output::warn_all(sink.take_warnings());
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
        output::warn_all(warnings);
        let Some((place, file)) = self.place.zip(file) else {
            return Ok(None);
        };
        let metadata = file.metadata();
        let bytes = metadata.with_context(|| place.partial().display().to_string())?;
        place.publish(&file)?;
        Ok(Some((place.path().to_owned(), bytes.len())))
    }
}

fn identity(setup: &Setup<'_>, telemetry: &Telemetry) -> Identity {
    let stem = setup.plan.mcap.file_stem().unwrap_or_default();
    let topics = Topic::all().filter(|topic| telemetry.wants(*topic));
    let playback = if setup.arguments.realtime.is_some() {
        Playback::Following
    } else {
        Playback::PausedAtStart
    };
    Identity::of(
        &stem.to_string_lossy(),
        setup.scenario,
        topics.collect(),
        playback,
    )
}
