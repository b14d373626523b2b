//! Both runs, and their differences, in Rerun.

use super::content;
use crate::analysis::diff::{Report, Subject};
use crate::archive::publish::{Draft, Existing, refuse_inputs};
use crate::cli::arguments::OUTPUT;
use crate::cli::viewer::{self, ViewerArguments};
use crate::cli::{output, page};
use crate::rerun::{Destinations, Identity, PairIdentity, PairSink, Playback};
use anyhow::{Context as _, Error, bail};
use clap::Args;
use std::path::PathBuf;

/// Viewer options of `diff`.
#[derive(Args, Debug, PartialEq)]
pub(super) struct ShowArguments {
    /// Write a Rerun recording of both runs and their differences to this file
    #[arg(long, value_name = "FILE", help_heading = OUTPUT)]
    rrd: Option<PathBuf>,

    #[command(flatten)]
    viewer: ViewerArguments,

    /// Overwrite existing files.
    #[arg(long, help_heading = OUTPUT)]
    force: bool,
}

/// Rerun output of a comparison.
pub(super) struct Viewer {
    pub(super) sink: PairSink,
    draft: Option<Draft>,
}

impl ShowArguments {
    /// Opens the requested outputs; `None` if there are none. Refuses to overwrite an input.
    pub(super) fn open(
        &self,
        subjects: [Subject<'_>; 2],
        runs: &[PathBuf],
    ) -> Result<Option<Viewer>, Error> {
        if let Some(rrd) = &self.rrd {
            refuse_inputs(rrd, runs.iter().map(PathBuf::as_path))?;
        }
        let live = self.viewer.live();
        if self.rrd.is_none() && live.is_none() {
            return Ok(None);
        }
        if !subjects.iter().all(|subject| subject.is_ours()) {
            bail!("the viewer can only show toprise recordings; one input is another MCAP file");
        }
        let identity = identity(subjects)?;
        let existing = Existing::forced(self.force);
        let draft = self.rrd.as_ref().map(|rrd| Draft::new(rrd, existing));
        let draft = draft.transpose()?;
        if let Some(draft) = &draft {
            output::warn_of_link(draft.path(), self.force);
        }
        let destinations = Destinations {
            file: draft.as_ref().map(Draft::file).transpose()?,
            live,
        };
        let mut sink = PairSink::new(&identity, destinations);
        output::warn_all(&sink.take_warnings());
        Ok(Some(Viewer { sink, draft }))
    }
}

fn identity([a, b]: [Subject<'_>; 2]) -> Result<PairIdentity, Error> {
    let is_same_name = a.name() == b.name();
    let of = |subject: Subject<'_>, letter: &str| {
        let scenario = subject.scenario().with_context(|| {
            format!("{letter} can't be shown: it has no scenario that this version can read")
        })?;
        let name = if is_same_name {
            scenario.title()
        } else {
            subject.name()
        };
        Ok::<_, Error>(Identity::of(
            &name,
            &scenario,
            subject.topics(),
            Playback::FromStart,
        ))
    };
    let (a, b) = (of(a, "A")?, of(b, "B")?);
    Ok(PairIdentity {
        recording_id: format!("{}-against-{}", b.recording_id, a.recording_id),
        name: format!("{} against {}", b.name, a.name),
        a,
        b,
    })
}

impl Viewer {
    /// Adds the report to the recording and completes the file.
    pub(super) fn finish(mut self, report: &Report) -> Result<(), Error> {
        let markdown = page::markdown(&content::page(report, false, false));
        self.sink.summarize(&markdown);
        if let Some(file) = viewer::complete(self.sink.finish(), self.draft)? {
            output::note(&format!("wrote {}", file.line()));
        }
        Ok(())
    }
}
