//! Both runs, and their differences, in Rerun.

use crate::analysis::diff::{Observer, Subject};
use crate::archive::publish::{Draft, Existing};
use crate::archive::sink::SinkError;
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

/// The viewer or file that shows the comparison.
#[derive(Args, Debug, PartialEq)]
pub(super) struct ShowArguments {
    /// Write a Rerun recording of both runs and their differences into this file.
    #[arg(long, value_name = "FILE")]
    rrd: Option<PathBuf>,

    #[command(flatten)]
    viewer: ViewerArguments,
}

/// A viewer, or a file for one, that is fed with a comparison.
pub(super) struct Viewer {
    sink: PairSink,
    draft: Option<Draft>,
    target: Target,
}

impl ShowArguments {
    /// Opens what was asked for; nothing if nothing was.
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
            bail!("Rerun shows recordings of toprise here; one of these is another file");
        }
        let identity = identity(subjects, self.viewer.hop_scale)?;
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

fn identity([a, b]: [Subject<'_>; 2], hop_scale: f64) -> Result<PairIdentity, Error> {
    let is_same_name = a.name() == b.name();
    let of = |subject: Subject<'_>, letter: &str| {
        let scenario = subject.scenario().with_context(|| {
            format!("{letter} can't be drawn: it has no scenario that this version reads")
        })?;
        let name = if is_same_name {
            scenario.title()
        } else {
            subject.name()
        };
        Ok::<_, Error>(
            Identity::of(&name, &scenario, subject.topics(), Playback::FromStart)
                .with_hops_drawn(hop_scale),
        )
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
    /// Shows the report too, completes the file and reports it.
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

/// Goes on serving, if that was asked for.
pub(super) fn serve(target: Target) -> Result<(), Error> {
    if !matches!(target, Target::None | Target::Live(_)) {
        target.serve_until(&Interrupt::watch()?);
    }
    Ok(())
}
