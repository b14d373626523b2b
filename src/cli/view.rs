//! `toprise view`.

use super::arguments::{OUTPUT, parse_number};
use super::interrupt;
use super::output;
use super::page::Section;
use super::progress::Progress;
use super::report::{self, WrittenFile};
use super::status::Status;
use super::table::Table;
use super::viewer::{self, ViewerArguments};
use crate::analysis::subject::loss_sentences;
use crate::archive::format::is_end_of;
use crate::archive::publish::{Draft, Existing, refuse_inputs};
use crate::archive::recording::{Condition, Recording, Selection};
use crate::archive::replay::{Replayed, replay};
use crate::rerun::{Destinations, Identity, Live, Playback, RerunSink};
use crate::run::outcome;
use crate::run::outcome::Outcome;
use crate::telemetry::Topics;
use anyhow::{Context as _, Error, bail};
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Arguments of `toprise view`.
#[derive(Args, Debug, PartialEq)]
pub(super) struct ViewArguments {
    /// Recordings (MCAP files)
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    #[command(flatten)]
    viewer: ViewerArguments,

    /// Write to this .rrd file (or directory, for several recordings)
    #[arg(long, value_name = "PATH", help_heading = OUTPUT)]
    rrd: Option<PathBuf>,

    /// Overwrite existing files.
    #[arg(long, help_heading = OUTPUT)]
    force: bool,

    /// Start at this simulated time, s
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, allow_negative_numbers = true)]
    from: Option<f64>,

    /// End at this simulated time, s
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, allow_negative_numbers = true)]
    to: Option<f64>,
}

/// The recordings that were shown.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct ViewReport {
    /// The recordings, in command-line order, up to the interruption.
    recordings: Vec<ShownRecording>,
    /// Whether the user interrupted the replay.
    is_interrupted: bool,
}

/// A recording that was shown.
#[derive(Debug, Serialize, JsonSchema)]
struct ShownRecording {
    /// Its file.
    file: String,
    /// Its name in the viewer.
    name: String,
    /// Kind of the file.
    state: Condition,
    /// Number of messages that were shown.
    messages: u64,
    /// Number of messages that could not be decoded.
    undecodable: u64,
    /// Parts of the file that could not be read.
    losses: Vec<String>,
    /// The Rerun recording that was written.
    rrd: Option<WrittenFile>,
}

impl ViewReport {
    fn page(&self) -> Vec<Section> {
        let files = self.recordings.iter().flat_map(|shown| &shown.rrd);
        let wrote = files.map(|file| ("wrote", file.line()));
        vec![Section::of(Table::of_facts(wrote))]
    }

    /// Whether everything was shown.
    fn is_complete(&self) -> bool {
        let is_whole = |shown: &ShownRecording| {
            let is_known = matches!(shown.state, Condition::Whole | Condition::Foreign);
            is_known && shown.losses.is_empty() && shown.undecodable == 0
        };
        !self.is_interrupted && self.recordings.iter().all(is_whole)
    }
}

fn parse_seconds(text: &str) -> Result<f64, String> {
    let reason = "must be a non-negative time in seconds, e.g. 12.5";
    parse_number(text, |time| (0.0..=1e9).contains(time), reason)
}

impl ViewArguments {
    fn selection(&self) -> Result<Selection, Error> {
        if let (Some(from), Some(to)) = (self.from, self.to)
            && from > to
        {
            bail!("--from {from} is after --to {to}");
        }
        let nanoseconds = |seconds: f64| (seconds * 1e9).round() as u64;
        Ok(Selection {
            topics: Topics::All,
            from_ns: self.from.map(nanoseconds),
            to_ns: self.to.map(nanoseconds),
        })
    }

    /// The .rrd path of a recording.
    fn rrd_of(&self, name: &str) -> Option<PathBuf> {
        let path = self.rrd.as_ref()?;
        let is_directory = path.is_dir() || path.as_os_str().to_string_lossy().ends_with('/');
        if self.files.len() == 1 && !is_directory {
            return Some(path.clone());
        }
        Some(path.join(format!("{name}.rrd")))
    }

    /// Names of the recordings in the viewer; duplicates are numbered.
    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for file in &self.files {
            let stem = file.file_stem().unwrap_or_default().to_string_lossy();
            let numbered = (2..).map(|number| format!("{stem}-{number}"));
            let mut candidates = std::iter::once(stem.clone().into_owned()).chain(numbered);
            names.extend(candidates.find(|name| !names.contains(name)));
        }
        names
    }
}

/// Shows recordings.
pub(super) fn view(arguments: &ViewArguments) -> Result<Status, Error> {
    let selection = arguments.selection()?;
    let recordings = arguments.files.iter().map(|file| open(file));
    let recordings = recordings.collect::<Result<Vec<_>, _>>()?;
    let names = arguments.names();
    for rrd in names.iter().filter_map(|name| arguments.rrd_of(name)) {
        refuse_inputs(&rrd, arguments.files.iter().map(PathBuf::as_path))?;
    }
    interrupt::watch()?;
    let live = viewer_or_new(arguments);
    let progress = Progress::of_bytes("replaying", recordings.iter().map(Recording::size).sum());
    let mut shown = Vec::new();
    for (recording, name) in recordings.iter().zip(names) {
        shown.push(show(
            recording,
            &name,
            arguments,
            &selection,
            live.as_ref(),
            &progress,
        )?);
        if interrupt::is_requested() {
            break;
        }
    }
    progress.finish();
    let report = ViewReport {
        recordings: shown,
        is_interrupted: interrupt::is_requested(),
    };
    report::print(&report, || report.page())?;
    Ok(Status::of_whole(report.is_complete()))
}

fn open(file: &Path) -> Result<Recording, Error> {
    let recording = Recording::open(file).with_context(|| file.display().to_string())?;
    if !recording.is_ours() {
        bail!(
            "{} is not a toprise recording (written by {:?}); try `rerun {0}`",
            file.display(),
            recording.library()
        );
    }
    Ok(recording)
}

/// The requested viewer, or a new one if nothing else was requested.
fn viewer_or_new(arguments: &ViewArguments) -> Option<Live> {
    let requested = arguments.viewer.live();
    if requested.is_none() && arguments.rrd.is_none() {
        return Some(Live::Spawn);
    }
    requested
}

/// Replays one recording.
fn show(
    recording: &Recording,
    name: &str,
    arguments: &ViewArguments,
    selection: &Selection,
    live: Option<&Live>,
    progress: &Progress,
) -> Result<ShownRecording, Error> {
    let path = recording.path();
    let context = || path.display().to_string();
    let scenario = recording
        .scenario()
        .context("the scene can't be drawn without the scenario")
        .with_context(context)?;
    let topics = recording.topics();
    let identity = Identity {
        is_alone: arguments.files.len() == 1 || arguments.rrd.is_some(),
        ..Identity::of(name, &scenario, topics, Playback::FromStart)
    };
    let existing = Existing::forced(arguments.force);
    let draft = arguments.rrd_of(name).map(|rrd| Draft::new(&rrd, existing));
    let mut draft = draft.transpose()?;
    if let Some(draft) = &draft {
        output::warn_of_link(draft.path(), arguments.force);
    }
    let destinations = Destinations {
        file: draft.as_ref().map(Draft::file).transpose()?,
        live: live.cloned(),
    };
    let mut sink = RerunSink::new(&identity, destinations);
    let warnings = sink.take_warnings();
    if draft.is_none() && !sink.is_live() {
        let reasons: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        bail!("{}", reasons.join("; "));
    }
    output::warn_all(&warnings);
    let replayed = replay(recording, selection.clone(), &mut sink, |read| {
        progress.add(read);
        interrupt::flow()
    })
    .with_context(context)?;
    if let Some(outcome) = outcome_of(recording, selection) {
        sink.set_outcome(&outcome);
    }
    let interrupted = draft.take_if(|_| interrupt::is_requested());
    let rrd = viewer::complete(sink.finish(), draft)?;
    if let Some(draft) = interrupted {
        let path = draft.path().display();
        output::warn(&format!("interrupted: {path} is not written"));
    }
    warn(recording, &replayed);
    Ok(ShownRecording {
        file: path.display().to_string(),
        name: name.to_owned(),
        state: recording.condition(),
        messages: replayed.messages,
        undecodable: replayed.undecodable.as_ref().map_or(0, |(_, count)| *count),
        losses: losses(&replayed),
        rrd,
    })
}

/// Outcome of the run, if the complete recording is shown and the scenario's outcome agrees with the recorded end.
fn outcome_of(recording: &Recording, selection: &Selection) -> Option<Outcome> {
    let is_span = selection.from_ns.is_some() || selection.to_ns.is_some();
    if is_span || recording.condition() != Condition::Whole {
        return None;
    }
    let (scenario, end) = (recording.scenario().ok()?, recording.end()?);
    let outcome = outcome(&scenario, || !interrupt::is_requested()).ok()?;
    is_end_of(end, &outcome).then_some(outcome)
}

/// Parts that could not be shown, in sentences.
fn losses(replayed: &Replayed) -> Vec<String> {
    let losses = loss_sentences(&replayed.losses).into_iter();
    let left_out = replayed.left_out.iter().map(ToString::to_string);
    losses.chain(left_out).collect()
}

/// Warns about parts that could not be shown.
fn warn(recording: &Recording, replayed: &Replayed) {
    let path = recording.path().display();
    if replayed.messages == 0 {
        output::warn(&format!("{path}: no messages in this time range"));
    }
    if recording.condition() == Condition::Interrupted {
        output::warn(&format!("{path} is incomplete (interrupted)"));
    }
    for loss in losses(replayed) {
        output::warn(&format!("{path}: {loss}"));
    }
    if let Some((error, count)) = &replayed.undecodable {
        output::warn(&format!(
            "{path}: {count} messages skipped; first error: {error}"
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn files_and_a_span_of_time_are_named() {
        let base = parse::<ViewArguments>("a.mcap").unwrap();
        assert_eq!(
            parse::<ViewArguments>("a.mcap b.mcap --rrd both --from 0.5").unwrap(),
            ViewArguments {
                files: vec!["a.mcap".into(), "b.mcap".into()],
                rrd: Some("both".into()),
                from: Some(0.5),
                ..base
            }
        );
        for line in ["", "a.mcap --from -1", "a.mcap --spawn --connect"] {
            assert!(parse::<ViewArguments>(line).is_err(), "{line}");
        }
    }
}
