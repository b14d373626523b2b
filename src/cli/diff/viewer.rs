//! Both runs, and their differences, in Rerun.

use crate::analysis::diff::{Observer, Subject};
use crate::archive::publish::{Draft, Existing};
use crate::archive::sink::SinkError;
use crate::cli::arguments::OUTPUT;
use crate::cli::interrupt::Interrupt;
use crate::cli::output;
use crate::cli::report::WrittenFile;
use crate::cli::viewer::{self, Target, ViewerArguments};
use crate::rerun::{Destinations, Identity, PairIdentity, PairSink, Playback};
use crate::telemetry::Message;
use crate::telemetry::side::Side;
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
}

/// Rerun output of a comparison.
pub(super) struct Viewer {
    sink: PairSink,
    draft: Option<Draft>,
    target: Target,
}

impl ShowArguments {
    /// Opens the requested outputs; `None` if there are none.
    pub(super) fn open(
        &self,
        subjects: [Subject<'_>; 2],
        existing: Existing,
    ) -> Result<Option<Viewer>, Error> {
        let target = self.viewer.target()?;
        if self.rrd.is_none() && matches!(target, Target::None) {
            return Ok(None);
        }
        if !subjects.iter().all(|subject| subject.is_ours()) {
            bail!("the viewer can only show toprise recordings; one input is another MCAP file");
        }
        let identity = identity(subjects)?;
        let draft = self.rrd.as_ref().map(|rrd| Draft::new(rrd, existing));
        let draft = draft.transpose()?;
        let destinations = Destinations {
            file: draft.as_ref().map(Draft::file).transpose()?,
            live: target.live(),
        };
        let mut sink = PairSink::new(&identity, destinations);
        output::warn_all(sink.take_warnings());
        Ok(Some(Viewer {
            sink,
            draft,
            target,
        }))
    }

    /// The file to write.
    pub(super) fn rrd(&self) -> Option<&PathBuf> {
        self.rrd.as_ref()
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
    pub(super) fn finish(mut self, markdown: &str) -> Result<(Target, Option<WrittenFile>), Error> {
        self.sink.summarize(markdown);
        let written = viewer::complete(self.sink.finish(), self.draft)?;
        Ok((self.target, written))
    }
}

impl Observer for Viewer {
    fn message(&mut self, side: Side, message: &Message<'_>) -> Result<(), SinkError> {
        self.sink.write(side, message);
        Ok(())
    }

    fn difference(&mut self, message: &Message<'_>) -> Result<(), SinkError> {
        self.sink.difference(message);
        Ok(())
    }
}

/// Keeps serving the web viewer, if requested.
pub(super) fn serve(target: Target) -> Result<(), Error> {
    if !matches!(target, Target::None | Target::Live(_)) {
        target.serve_until(&Interrupt::watch()?);
    }
    Ok(())
}
