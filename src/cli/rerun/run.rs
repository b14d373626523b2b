//! The Rerun side of a run: a file, a live viewer, or both.

use super::viewer::{ViewerArguments, complete, warn_all};
use crate::archive::publish::{Draft, Drafts, check_not_an_input};
use crate::archive::sink::Sink;
use crate::cli::arguments::OUTPUT;
use crate::cli::commands::run::{FilePlan, McapFile};
use crate::cli::extension::{FeatureArguments, RunViewer, ShowRun};
use crate::cli::file_kind::FileKind;
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
pub(in crate::cli) struct ShowRunArguments {
    /// Write a Rerun recording (.rrd) to this file
    #[arg(long, value_name = "FILE", help_heading = OUTPUT)]
    rrd: Option<PathBuf>,

    /// Don't write a Rerun recording
    #[arg(long, conflicts_with = "rrd", help_heading = OUTPUT)]
    no_rrd: bool,

    #[command(flatten)]
    viewer: ViewerArguments,
}

/// The Rerun recording of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
enum RrdTarget {
    None,
    /// Next to the MCAP file.
    Adjacent,
    At(PathBuf),
}

/// The Rerun output of a run, resolved.
#[derive(Debug)]
struct ShowRunPlan {
    rrd: RrdTarget,
    /// Whether the arguments leave the Rerun recording out without saying so.
    is_left_out: bool,
    live: Option<Live>,
    playback: Playback,
}

impl ShowRunArguments {
    /// The Rerun recording. Without arguments it is next to the MCAP file, unless that has been named.
    fn rrd(&self, has_output: bool) -> RrdTarget {
        match &self.rrd {
            Some(path) => RrdTarget::At(path.clone()),
            None if self.no_rrd || has_output => RrdTarget::None,
            None => RrdTarget::Adjacent,
        }
    }
}

impl FeatureArguments<(Option<&Path>, Option<f64>), Box<dyn ShowRun>> for ShowRunArguments {
    /// Depends on the MCAP file, if it is named, and the speed, if it is limited.
    fn plan(
        &self,
        (mcap, speed): (Option<&Path>, Option<f64>),
    ) -> Result<Option<Box<dyn ShowRun>>, Error> {
        let has_output = mcap.is_some();
        Ok(Some(Box::new(ShowRunPlan {
            rrd: self.rrd(has_output),
            is_left_out: has_output && self.rrd.is_none() && !self.no_rrd,
            live: self.viewer.live(),
            playback: if speed.is_some() {
                Playback::Following
            } else {
                Playback::FromStart
            },
        })))
    }
}

impl ShowRunPlan {
    /// Creates the draft of the Rerun recording, if there is one, for this MCAP file.
    fn create_rrd(
        &self,
        files: &FilePlan,
        drafts: &Drafts,
        mcap: &Path,
    ) -> Result<Option<Draft>, Error> {
        let path = match &self.rrd {
            RrdTarget::None => return Ok(None),
            RrdTarget::Adjacent => mcap.with_extension("rrd"),
            RrdTarget::At(path) => path.clone(),
        };
        FileKind::Rrd.check("--rrd", &path)?;
        check_not_an_input(&path, [mcap])?;
        Ok(Some(files.create(drafts, &path)?.make_partial()?))
    }
}

impl ShowRun for ShowRunPlan {
    fn note(&self) -> Option<&'static str> {
        self.is_left_out
            .then_some("no Rerun recording with -o; add --rrd FILE to write one")
    }

    fn open(
        &self,
        files: &FilePlan,
        drafts: &Drafts,
        mcap: &Path,
        scenario: &Scenario,
        telemetry: &Telemetry,
    ) -> Result<Option<Box<dyn RunViewer>>, Error> {
        let mut draft = self.create_rrd(files, drafts, mcap)?;
        let destinations = Destinations {
            file: draft.as_ref().map(Draft::file).transpose()?,
            live: self.live.clone(),
        };
        if destinations.file.is_none() && destinations.live.is_none() {
            return Ok(None);
        }
        let identity = identity(scenario, telemetry, mcap, self.playback);
        let mut sink = ExplainedSink::new(scenario, &identity, destinations);
        let is_viewer_lost = warn_all(&sink.take_warnings());
        // As with the MCAP file: until here nothing is lost with it.
        if let Some(draft) = &mut draft {
            draft.keep();
        }
        Ok(Some(Box::new(OpenRunViewer {
            sink,
            draft,
            is_named: matches!(self.rrd, RrdTarget::At(_)),
            is_viewer_lost,
        })))
    }
}

/// Rerun output of a run.
struct OpenRunViewer {
    sink: ExplainedSink,
    draft: Option<Draft>,
    /// Whether the arguments name the file. It is then written even if the MCAP file existed already.
    is_named: bool,
    /// Whether the viewer went away while the run was prepared.
    is_viewer_lost: bool,
}

impl RunViewer for OpenRunViewer {
    fn sink(&mut self) -> &mut dyn Sink {
        &mut self.sink
    }

    fn finish(mut self: Box<Self>, mcap: &McapFile, outcome: &Outcome) -> Result<Completed, Error> {
        // The Rerun recording of an identical run stands for this one, unless the arguments name a file.
        let substitute = match mcap {
            McapFile::Partial(_) => return self.keep_partial(),
            McapFile::Identical(existing) if !self.is_named => Some(existing),
            McapFile::Identical(_) | McapFile::New(_) => None,
        };
        if outcome.end.stop.is_complete() {
            self.sink.set_outcome(outcome);
        }
        self.publish(substitute)
    }
}

impl OpenRunViewer {
    /// Ends the stream of an incomplete run whose file must not replace another: it keeps its partial name.
    fn keep_partial(self) -> Result<Completed, Error> {
        let mut completed = complete(self.sink.finish(), None)?;
        completed.is_viewer_lost |= self.is_viewer_lost;
        Ok(completed)
    }

    /// Ends the stream and publishes the file, unless there is one next to `substitute`, an existing MCAP file of the
    /// same run. Returns the file, or that one.
    fn publish(self, substitute: Option<&WrittenFile>) -> Result<Completed, Error> {
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
        completed.is_viewer_lost |= completed.file.is_none() && self.is_viewer_lost;
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
