//! Both runs, and their differences, in Rerun.

use super::viewer::{ViewerArguments, complete, warn_all};
use crate::analysis::diff::{Report, Subject};
use crate::archive::publish::{Draft, Drafts, Existing, check_not_an_input};
use crate::cli::arguments::OUTPUT;
use crate::cli::commands::diff::content;
use crate::cli::extension::{FeatureArguments, PairViewer, ShowPair};
use crate::cli::file_kind::FileKind;
use crate::cli::output;
use crate::cli::terminal;
use crate::rerun::{Destinations, Identity, Live, PairIdentity, PairSink, Playback};
use crate::telemetry::{Message, side::Side};
use crate::words::{Section, markdown};
use anyhow::{Context as _, Error, bail};
use clap::Args;
use std::path::PathBuf;

/// Viewer options of `diff`.
#[derive(Args, Clone, Debug, PartialEq)]
pub(in crate::cli) struct ShowPairArguments {
    /// Write a Rerun recording of both runs and their differences to this file
    #[arg(short = 'o', long, value_name = "FILE", help_heading = OUTPUT)]
    rrd: Option<PathBuf>,

    #[command(flatten)]
    viewer: ViewerArguments,
}

/// The Rerun output of a comparison, resolved.
struct ShowPairPlan {
    rrd: Option<PathBuf>,
    existing: Existing,
    live: Option<Live>,
}

impl FeatureArguments<(&[PathBuf], Existing), Box<dyn ShowPair>> for ShowPairArguments {
    /// Refuses to overwrite an input.
    fn plan(
        &self,
        (runs, existing): (&[PathBuf], Existing),
    ) -> Result<Option<Box<dyn ShowPair>>, Error> {
        if let Some(rrd) = &self.rrd {
            FileKind::Rrd.check("--rrd", rrd)?;
            check_not_an_input(rrd, runs.iter().map(PathBuf::as_path))?;
        }
        let live = self.viewer.live();
        if self.rrd.is_none() && live.is_none() {
            return Ok(None);
        }
        Ok(Some(Box::new(ShowPairPlan {
            rrd: self.rrd.clone(),
            existing,
            live,
        })))
    }
}

impl ShowPair for ShowPairPlan {
    fn open(
        &self,
        subjects: [Subject<'_>; 2],
        names: [&str; 2],
        drafts: &Drafts,
    ) -> Result<Box<dyn PairViewer>, Error> {
        if !subjects.iter().all(|subject| subject.is_ours()) {
            bail!("the viewer can only show toprise recordings; one input is another MCAP file");
        }
        let identity = identity(subjects, names)?;
        let mut draft = None;
        if let Some(rrd) = &self.rrd {
            draft = Some(Draft::new_in(drafts, rrd, self.existing)?);
            output::warn_of_link(rrd, self.existing == Existing::Replace);
        }
        let destinations = Destinations {
            file: draft.as_ref().map(Draft::file).transpose()?,
            live: self.live.clone(),
        };
        let mut sink = PairSink::new(&identity, destinations);
        let is_viewer_lost = warn_all(&sink.take_warnings());
        Ok(Box::new(OpenPairViewer {
            sink,
            draft,
            is_viewer_lost,
        }))
    }
}

/// Rerun output of a comparison.
struct OpenPairViewer {
    sink: PairSink,
    draft: Option<Draft>,
    /// Whether the viewer went away while the comparison was prepared.
    is_viewer_lost: bool,
}

impl PairViewer for OpenPairViewer {
    fn write(&mut self, side: Side, message: &Message<'_>) {
        self.sink.write(side, message);
    }

    fn write_difference(&mut self, message: &Message<'_>) {
        self.sink.difference(message);
    }

    fn finish(mut self: Box<Self>, report: &Report) -> Result<bool, Error> {
        let markdown = markdown(&summary(report), terminal::option);
        self.sink.summarize(&markdown);
        let completed = complete(self.sink.finish(), self.draft)?;
        if let Some(file) = completed.file {
            output::note(&format!("wrote {}", file.line()));
        }
        Ok(self.is_viewer_lost || completed.is_viewer_lost)
    }
}

/// The summary in the viewer: the verdict and the findings first, since it shows the beginning; what was compared last.
fn summary(report: &Report) -> Vec<Section> {
    let mut sections = vec![
        content::findings(report, false),
        content::beyond(report, false),
        content::equals(report, false),
        content::setup(report, false, false),
        content::others(report, false),
        content::notes(report, false),
        content::topics(report),
        content::subjects(report),
    ];
    sections.retain(|section| !section.parts.is_empty());
    // It may have no more than its title.
    sections.insert(0, content::verdict(report));
    sections
}

fn identity(subjects: [Subject<'_>; 2], names: [&str; 2]) -> Result<PairIdentity, Error> {
    // Runs of one name are told apart by what was changed in their scenarios.
    let is_same_name = names[0] == names[1];
    let [a, b] = Side::BOTH.map(|side| {
        let name = (!is_same_name).then_some(names[side.index()]);
        side_identity(subjects[side.index()], side, name)
    });
    let (a, b) = (a?, b?);
    Ok(PairIdentity {
        recording_id: format!("{}-against-{}", b.recording_id, a.recording_id),
        // A viewer cuts long names at the end: so it shows the beginning of both.
        name: format!("{} vs {}", a.name, b.name),
        a,
        b,
    })
}

/// Identity of a run; without a name it is that of the scenario and what has been changed.
fn side_identity(subject: Subject<'_>, side: Side, name: Option<&str>) -> Result<Identity, Error> {
    let scenario = subject.scenario().with_context(|| {
        format!(
            "{} can't be shown: it has no scenario that this version can read",
            side.name()
        )
    })?;
    let title = name.map_or_else(|| scenario.title(), str::to_owned);
    let topics = subject.topics();
    Ok(Identity::new(
        &title,
        &scenario,
        topics,
        Playback::FromStart,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn summary_begins_with_the_verdict() {
        let markdown = markdown(&summary(&Report::default()), terminal::option);
        assert!(markdown.starts_with("## Different"), "{markdown}");
    }
}
