//! The Rerun side of a run: a file, a live viewer, or both.

use super::viewer::{ViewerArguments, complete, warn_all};
use crate::archive::publish::Draft;
use crate::archive::sink::Sink;
use crate::cli::arguments::OUTPUT;
use crate::cli::commands::run::file_plan::RrdFile;
use crate::cli::report::{Completed, WrittenFile};
use crate::rerun::{Destinations, ExplainedSink, Identity, Live, Playback};
use crate::run::outcome::Outcome;
use crate::run::scenario::Scenario;
use crate::telemetry::{Telemetry, Topic};
use anyhow::Error;
use clap::Args;
use std::path::{Path, PathBuf};

/// Viewer options of `run`.
#[derive(Args, Clone, Debug, PartialEq)]
pub(in crate::cli) struct ShowArguments {
    /// Write a Rerun recording (.rrd) to this file
    #[arg(long, value_name = "FILE", help_heading = OUTPUT)]
    rrd: Option<PathBuf>,

    /// Don't write a Rerun recording
    #[arg(long, conflicts_with = "rrd", help_heading = OUTPUT)]
    no_rrd: bool,

    #[command(flatten)]
    viewer: ViewerArguments,
}

/// The Rerun output of a run, resolved.
#[derive(Clone, Debug)]
pub(in crate::cli) struct ShowPlan {
    /// Whether the arguments leave the Rerun recording out without saying so.
    is_left_out: bool,
    live: Option<Live>,
    playback: Playback,
}

impl ShowArguments {
    /// The Rerun recording. Without arguments it is next to the MCAP file, unless that has been named.
    pub(in crate::cli) fn rrd(&self, has_output: bool) -> RrdFile {
        match &self.rrd {
            Some(path) => RrdFile::At(path.clone()),
            None if self.no_rrd || has_output => RrdFile::None,
            None => RrdFile::Adjacent,
        }
    }

    /// Resolves the arguments.
    pub(in crate::cli) fn plan(&self, has_output: bool, is_paced: bool) -> ShowPlan {
        ShowPlan {
            is_left_out: has_output && self.rrd.is_none() && !self.no_rrd,
            live: self.viewer.live(),
            playback: if is_paced {
                Playback::Following
            } else {
                Playback::FromStart
            },
        }
    }
}

impl ShowPlan {
    /// A note for the report.
    pub(in crate::cli) fn note(&self) -> Option<&'static str> {
        self.is_left_out
            .then_some("no Rerun recording with -o; add --rrd FILE to write one")
    }
}

/// Rerun output of a run.
pub(in crate::cli) struct RunViewer {
    sink: ExplainedSink,
    draft: Option<Draft>,
    /// Whether the viewer went away while the run was prepared.
    is_viewer_lost: bool,
}

impl RunViewer {
    /// Opens the requested outputs, of which `draft` is the file; `None` if there are none. An unreachable viewer is only
    /// a warning.
    pub(in crate::cli) fn open(
        plan: &ShowPlan,
        mut draft: Option<Draft>,
        scenario: &Scenario,
        telemetry: &Telemetry,
        mcap: &Path,
    ) -> Result<Option<Self>, Error> {
        let destinations = Destinations {
            file: draft.as_ref().map(Draft::file).transpose()?,
            live: plan.live.clone(),
        };
        if destinations.file.is_none() && destinations.live.is_none() {
            return Ok(None);
        }
        let identity = identity(scenario, telemetry, mcap, plan.playback);
        let mut sink = ExplainedSink::new(scenario, &identity, destinations);
        let is_viewer_lost = warn_all(&sink.take_warnings());
        // As with the MCAP file: until here nothing is lost with it.
        if let Some(draft) = &mut draft {
            draft.keep();
        }
        Ok(Some(Self {
            sink,
            draft,
            is_viewer_lost,
        }))
    }

    pub(in crate::cli) fn sink(&mut self) -> &mut dyn Sink {
        &mut self.sink
    }

    pub(in crate::cli) fn set_outcome(&mut self, outcome: &Outcome) {
        self.sink.set_outcome(outcome);
    }

    /// Ends the stream of an incomplete run whose file must not replace another: it keeps its partial name.
    pub(in crate::cli) fn keep_partial(self) -> Result<Completed, Error> {
        let mut completed = complete(self.sink.finish(), None)?;
        completed.is_viewer_lost |= self.is_viewer_lost;
        Ok(completed)
    }

    /// Ends the stream and publishes the file, unless there is one next to `substitute`, an existing MCAP file of the
    /// same run. Returns the file, or that one.
    pub(in crate::cli) fn finish(
        self,
        substitute: Option<&WrittenFile>,
    ) -> Result<Completed, Error> {
        let adjacent = substitute.and_then(adjacent_rrd);
        let mut completed = if adjacent.is_none() {
            complete(self.sink.finish(), self.draft)?
        } else {
            if let Some(draft) = self.draft {
                draft.discard();
            }
            Completed {
                file: adjacent,
                ..complete(self.sink.finish(), None)?
            }
        };
        completed.is_viewer_lost |= self.is_viewer_lost;
        Ok(completed)
    }
}

/// The existing Rerun recording next to an MCAP file.
fn adjacent_rrd(mcap: &WrittenFile) -> Option<WrittenFile> {
    let path = Path::new(&mcap.path).with_extension("rrd");
    let bytes = path.metadata().ok()?.len();
    Some(WrittenFile::new(&path, bytes))
}

/// Identity of the run, as shown in the viewer.
fn identity(
    scenario: &Scenario,
    telemetry: &Telemetry,
    mcap: &Path,
    playback: Playback,
) -> Identity {
    // The viewer lists recordings by this name, and repeated runs of a scenario differ only in that of the file.
    let stem = mcap.file_stem().unwrap_or_default();
    let topics = Topic::all_with(scenario.model.support)
        .filter(|topic| telemetry.is_enabled(*topic))
        .collect();
    Identity::new(&stem.to_string_lossy(), scenario, topics, playback)
}
