//! The Rerun side of a run: a file, a live viewer, or both.

use super::arguments::RunArguments;
use super::files::create;
use crate::archive::publish::{Draft, refuse_inputs};
use crate::cli::output;
use crate::cli::report::WrittenFile;
use crate::cli::viewer;
use crate::rerun::{Destinations, Identity, Playback, RerunSink};
use crate::run::scenario::Scenario;
use crate::telemetry::{Telemetry, Topic};
use anyhow::Error;
use std::path::Path;

/// Rerun output of a run, if requested.
pub(super) struct RunViewer {
    pub(super) sink: RerunSink,
    draft: Option<Draft>,
}

impl RunViewer {
    /// Opens the requested outputs; `None` if there are none. Without arguments that say otherwise, the Rerun recording
    /// is next to the MCAP file. An unreachable viewer is only a warning.
    pub(super) fn open(
        arguments: &RunArguments,
        mcap: &Path,
        identity: &Identity,
    ) -> Result<Option<Self>, Error> {
        let adjacent = arguments
            .output
            .is_none()
            .then(|| mcap.with_extension("rrd"));
        let rrd = arguments.rrd.clone().or(adjacent);
        let mut draft = None;
        if let Some(rrd) = rrd.filter(|_| !arguments.no_rrd) {
            refuse_inputs(&rrd, [mcap])?;
            draft = Some(create(arguments, &rrd, &[])?);
        }
        let live = arguments.viewer.live();
        let file = draft.as_ref().map(Draft::file).transpose()?;
        if file.is_none() && live.is_none() {
            return Ok(None);
        }
        let mut sink = RerunSink::new(identity, Destinations { file, live });
        output::warn_all(&sink.take_warnings());
        draft.as_mut().map(Draft::keep);
        Ok(Some(Self { sink, draft }))
    }

    /// Ends the stream and publishes the file, unless `there` already exists. Returns the file.
    pub(super) fn finish(self, there: Option<WrittenFile>) -> Result<Option<WrittenFile>, Error> {
        if there.is_none() {
            return viewer::complete(self.sink.finish(), self.draft);
        }
        if let Some(draft) = self.draft {
            draft.discard();
        }
        viewer::complete(self.sink.finish(), None)?;
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
    let all = Topic::all_with(scenario.model.support);
    let topics = all.filter(|topic| telemetry.is_enabled(*topic)).collect();
    let playback = match arguments.realtime {
        Some(_) => Playback::Following,
        None => Playback::FromStart,
    };
    Identity::of(&stem.to_string_lossy(), scenario, topics, playback)
}
