//! The Rerun side of a run: a file, a live viewer, or both.

use super::arguments::RunArguments;
use crate::archive::publish::Draft;
use crate::archive::sink::Sink;
use crate::cli::output;
use crate::cli::report::WrittenFile;
use crate::cli::viewer;
use crate::rerun::{Destinations, Identity, Live, Playback, RerunSink};
use crate::run::outcome::Outcome;
use crate::run::scenario::Scenario;
use crate::telemetry::{Telemetry, Topic};
use anyhow::Error;
use std::path::Path;

/// Rerun output of a run, if requested.
pub(super) struct RunViewer {
    sink: Option<RerunSink>,
    draft: Option<Draft>,
}

impl RunViewer {
    /// Opens the requested outputs. An unreachable viewer is only a warning.
    pub(super) fn open(
        identity: &Identity,
        mut draft: Option<Draft>,
        live: Option<Live>,
    ) -> Result<Self, Error> {
        let file = draft.as_ref().map(Draft::file).transpose()?;
        if file.is_none() && live.is_none() {
            return Ok(Self { sink: None, draft });
        }
        let mut sink = RerunSink::new(identity, Destinations { file, live });
        output::warn_all(sink.take_warnings());
        draft.as_mut().map(Draft::keep);
        Ok(Self {
            sink: Some(sink),
            draft,
        })
    }

    /// The sink, if there is one.
    pub(super) fn sink(&mut self) -> Option<&mut dyn Sink> {
        self.sink.as_mut().map(|sink| sink as &mut dyn Sink)
    }

    /// Sets the outcome of the run.
    pub(super) fn set_outcome(&mut self, outcome: &Outcome) {
        if let Some(sink) = &mut self.sink {
            sink.set_outcome(outcome);
        }
    }

    /// Ends the stream and publishes the file, unless `there` already exists. Returns the file.
    pub(super) fn finish(self, there: Option<WrittenFile>) -> Result<Option<WrittenFile>, Error> {
        let Some(sink) = self.sink else {
            return Ok(None);
        };
        if there.is_none() {
            return viewer::complete(sink.finish(), self.draft);
        }
        if let Some(draft) = self.draft {
            draft.discard();
        }
        viewer::complete(sink.finish(), None)?;
        Ok(there)
    }
}

/// Identity of the run, as shown in the viewer.
pub(super) fn identity(
    arguments: &RunArguments,
    mcap: &Path,
    scenario: &Scenario,
    telemetry: &Telemetry,
) -> Identity {
    let stem = mcap.file_stem().unwrap_or_default();
    let topics =
        Topic::all_with(scenario.model.support).filter(|topic| telemetry.is_enabled(*topic));
    let playback = if arguments.realtime.is_some() {
        Playback::Following
    } else {
        Playback::FromStart
    };
    Identity::of(
        &stem.to_string_lossy(),
        scenario,
        topics.collect(),
        playback,
    )
}
