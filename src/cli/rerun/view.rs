//! `toprise view`.

use super::attached;
use super::viewer::{self, ViewerArguments};
use crate::archive::format::is_end_of;
use crate::archive::input::open_file;
use crate::archive::publish::{Draft, Drafts, Existing, check_not_an_input};
use crate::archive::recording::{Condition, Recording, Selection};
use crate::archive::replay::{ReadEnd, replay};
use crate::archive::sink::{Sink as _, SinkError};
use crate::cli::arguments::OUTPUT;
use crate::cli::file_kind::FileKind;
use crate::cli::interrupt;
use crate::cli::output;
use crate::cli::progress::Progress;
use crate::cli::report::{self, WrittenFile};
use crate::cli::status::Status;
use crate::rerun::{Destinations, ExplainedSink, Identity, Live, Measurement, Playback};
use crate::run::outcome;
use crate::run::outcome::Outcome;
use crate::telemetry::Topics;
use crate::telemetry::supplement::SUPPLEMENTARY_ATTACHMENTS;
use crate::words::{Section, Table};
use anyhow::{Context as _, Error, bail};
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Arguments of `toprise view`.
#[derive(Args, Debug, PartialEq)]
pub(in crate::cli) struct ViewArguments {
    /// Recordings (MCAP files), or .rrd files
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
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds)]
    from: Option<f64>,

    /// End at this simulated time, s
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds)]
    to: Option<f64>,
}

/// The recordings that were shown.
#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::cli) struct ViewReport {
    /// The recordings, in command-line order, up to the interruption.
    recordings: Vec<ShownRecording>,
    /// Whether the user interrupted the replay.
    is_interrupted: bool,
}

/// A recording that was shown.
#[derive(Debug, Serialize, JsonSchema)]
struct ShownRecording {
    /// Path of the file.
    file: String,
    /// Name in the viewer.
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
    /// Whether the viewer went away before it had everything.
    #[serde(skip)]
    is_viewer_lost: bool,
}

impl ViewReport {
    fn page(&self) -> Vec<Section> {
        let files = self.recordings.iter().flat_map(|shown| &shown.rrd);
        let facts = files.map(|file| ("wrote", file.line()));
        vec![Section::from(Table::from_facts(facts))]
    }

    /// Whether everything was shown.
    fn is_complete(&self) -> bool {
        !self.is_interrupted && self.recordings.iter().all(ShownRecording::is_complete)
    }
}

impl ShownRecording {
    fn is_complete(&self) -> bool {
        let is_known = matches!(self.state, Condition::Whole | Condition::Foreign);
        is_known && self.losses.is_empty() && self.undecodable == 0 && !self.is_viewer_lost
    }
}

/// A time that no simulation has.
#[derive(Debug, thiserror::Error)]
#[error("must be a non-negative time in seconds, e.g. 12.5")]
struct TimeError;

/// Reads a time of the simulation.
fn parse_seconds(text: &str) -> Result<f64, TimeError> {
    match text.parse() {
        Ok(time) if (0.0..=1e9).contains(&time) => Ok(time),
        Ok(_) | Err(_) => Err(TimeError),
    }
}

/// The recordings to show, and the viewer or files.
struct ViewPlan {
    selection: Selection,
    existing: Existing,
    live: Option<Live>,
    /// The recordings, in command-line order.
    recordings: Vec<PlannedRecording>,
}

/// A recording to be shown.
struct PlannedRecording {
    recording: Recording,
    /// The name in the viewer.
    name: String,
    /// The .rrd file to write.
    rrd: Option<PathBuf>,
}

impl ViewArguments {
    /// Resolves the arguments: opens the recordings, and refuses to overwrite them.
    fn plan(&self) -> Result<ViewPlan, Error> {
        let selection = self.selection()?;
        let mut recordings: Vec<PlannedRecording> = Vec::new();
        for file in &self.files {
            let recording = open(file)?;
            let name = unused_name(file, &recordings);
            let rrd = self.rrd.as_ref().map(|path| self.rrd_of(path, &name));
            recordings.push(PlannedRecording {
                recording,
                name,
                rrd,
            });
        }
        for rrd in recordings.iter().filter_map(|planned| planned.rrd.as_ref()) {
            FileKind::Rrd.check("--rrd", rrd)?;
            check_not_an_input(rrd, self.files.iter().map(PathBuf::as_path))?;
        }
        Ok(ViewPlan {
            selection,
            existing: Existing::forced(self.force),
            live: self.live(),
            recordings,
        })
    }

    fn selection(&self) -> Result<Selection, Error> {
        if let (Some(from), Some(to)) = (self.from, self.to)
            && from > to
        {
            bail!("--from {from} is after --to {to}");
        }
        Ok(Selection {
            topics: Topics::All,
            from_ns: self.from.map(nanoseconds),
            to_ns: self.to.map(nanoseconds),
        })
    }

    /// The requested viewer, or a new one if nothing else was requested.
    fn live(&self) -> Option<Live> {
        let requested = self.viewer.live();
        if requested.is_none() && self.rrd.is_none() {
            return Some(Live::Spawn);
        }
        requested
    }

    /// The .rrd file of a recording: `path` itself, or a file in that directory.
    fn rrd_of(&self, path: &Path, name: &str) -> PathBuf {
        let is_directory = path.is_dir() || path.as_os_str().to_string_lossy().ends_with('/');
        if self.files.len() == 1 && !is_directory {
            return path.to_owned();
        }
        path.join(format!("{name}.rrd"))
    }
}

/// A time in whole nanoseconds.
fn nanoseconds(seconds: f64) -> u64 {
    (seconds * 1e9).round() as u64
}

/// The stem of a file, with a number if another recording has that name.
fn unused_name(file: &Path, others: &[PlannedRecording]) -> String {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let mut name = stem.clone().into_owned();
    let mut number = 1;
    while others.iter().any(|other| other.name == name) {
        number += 1;
        name = format!("{stem}-{number}");
    }
    name
}

/// Shows recordings.
pub(in crate::cli) fn view(arguments: &ViewArguments, drafts: &Drafts) -> Result<Status, Error> {
    if let Some(shown) = show_rrd(arguments)? {
        return Ok(shown);
    }
    let plan = arguments.plan()?;
    interrupt::watch(drafts)?;
    let sizes = plan
        .recordings
        .iter()
        .map(|planned| planned.recording.size());
    let progress = Progress::for_bytes("replaying", sizes.sum());
    let mut shown = Vec::new();
    for planned in &plan.recordings {
        shown.push(show(&plan, planned, drafts, &progress)?);
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
    Ok(Status::from_whole(report.is_complete()))
}

/// Opens Rerun recordings as they are, in a new viewer; `None` if the files are others.
fn show_rrd(arguments: &ViewArguments) -> Result<Option<Status>, Error> {
    let count = arguments
        .files
        .iter()
        .filter(|file| file.extension().is_some_and(|found| found == "rrd"))
        .count();
    if count == 0 {
        return Ok(None);
    }
    let is_plain = arguments.from.is_none()
        && arguments.to.is_none()
        && arguments.rrd.is_none()
        && arguments.viewer.can_open_files();
    if count < arguments.files.len() || !is_plain {
        bail!("an .rrd file is opened as it is: name only .rrd files, without options");
    }
    for file in &arguments.files {
        open_file(file).with_context(|| file.display().to_string())?;
    }
    let status = Command::new("rerun")
        .args(&arguments.files)
        .status()
        .context("cannot start `rerun` (install the viewer: pip install rerun-sdk==0.36.3)")?;
    if !status.success() {
        bail!("`rerun` failed ({status})");
    }
    Ok(Some(Status::Success))
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

/// Replays one recording.
fn show(
    plan: &ViewPlan,
    planned: &PlannedRecording,
    drafts: &Drafts,
    progress: &Progress,
) -> Result<ShownRecording, Error> {
    let PlannedRecording {
        recording,
        name,
        rrd,
    } = planned;
    let path = recording.path();
    let scenario = recording
        .scenario()
        .context("the scene can't be drawn without the scenario")
        .with_context(|| path.display().to_string())?;
    let topics = recording.topics();
    let identity = match measurement(recording, &plan.selection) {
        Some(measurement) => Identity::for_fit(name, &scenario, topics, measurement),
        None => Identity::new(name, &scenario, topics, Playback::FromStart),
    };
    let mut draft = None;
    if let Some(rrd) = rrd {
        draft = Some(Draft::new_in(drafts, rrd, plan.existing)?);
        output::warn_of_link(rrd, plan.existing == Existing::Replace);
    }
    let destinations = Destinations {
        file: draft.as_ref().map(Draft::file).transpose()?,
        live: plan.live.clone(),
    };
    let mut sink = ExplainedSink::new(&scenario, &identity, destinations);
    let warnings = sink.take_warnings();
    // Neither a file nor a viewer is left to show anything in.
    if draft.is_none() && !sink.is_live() {
        let reasons: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        bail!("{}", reasons.join("; "));
    }
    let was_viewer_lost = viewer::warn_all(&warnings);
    let mut messages = 0;
    let mut written: Result<(), SinkError> = Ok(());
    let read = replay(recording, plan.selection.clone(), &mut |message, bytes| {
        written = sink.write(message);
        messages += 1;
        progress.add(bytes);
        written.is_ok() && !interrupt::is_requested()
    });
    written.with_context(|| path.display().to_string())?;
    if let Some(outcome) = outcome_of(recording, &plan.selection) {
        sink.set_outcome(&outcome);
    }
    // Half a recording would look like a whole one.
    let interrupted = draft.take_if(|_| interrupt::is_requested());
    let completed = viewer::complete(sink.finish(), draft)?;
    if let Some(draft) = interrupted {
        let path = draft.path().display();
        output::warn(&format!("interrupted: {path} is not written"));
    }
    warn(recording, messages, &read);
    Ok(ShownRecording {
        file: path.display().to_string(),
        name: name.clone(),
        state: read.state.unwrap_or_else(|| recording.condition()),
        messages,
        undecodable: read.undecodable,
        losses: read.losses,
        // With a file, nothing is lost with the viewer.
        is_viewer_lost: completed.is_viewer_lost || was_viewer_lost && completed.file.is_none(),
        rrd: completed.file,
    })
}

/// Maximum size of the attached report of a fit, bytes: hundreds of times the usual one.
const MAX_REPORT: u64 = 1 << 24;

/// The data of the fit, if the recording is of one.
fn measurement(recording: &Recording, selection: &Selection) -> Option<Measurement> {
    let [_, report] = SUPPLEMENTARY_ATTACHMENTS;
    let text = recording
        .attachment(report.name, MAX_REPORT)
        .and_then(|json| attached::report(&json));
    Measurement::from_recording(recording, selection, text.unwrap_or_default())
}

/// Outcome of the run, if the complete recording is shown and the scenario's outcome agrees with the recorded end.
fn outcome_of(recording: &Recording, selection: &Selection) -> Option<Outcome> {
    let is_span = selection.from_ns.is_some() || selection.to_ns.is_some();
    if is_span || recording.condition() != Condition::Whole {
        return None;
    }
    let (scenario, end) = (recording.scenario().ok()?, recording.end()?);
    let outcome = outcome(&scenario, || !interrupt::is_requested()).ok()?;
    // Another version may have computed another motion, which is the one that is shown.
    is_end_of(end, &outcome).then_some(outcome)
}

/// Warns about parts that could not be shown.
fn warn(recording: &Recording, messages: u64, read: &ReadEnd) {
    let path = recording.path().display();
    if messages == 0 {
        output::warn(&format!("{path}: no messages in this time range"));
    }
    for loss in &read.losses {
        output::warn(&format!("{path}: {loss}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn parses_files_and_a_span_of_time() {
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
