//! `toprise view`: recordings again in Rerun.

use super::interrupt::Interrupt;
use super::progress::Progress;
use super::viewer::{Target, ViewerArguments};
use super::{Done, format, output, run::parse_seconds};
use crate::archive::publish::{Draft, Existing, refuse_inputs};
use crate::archive::recording::{Condition, Recording, Selection};
use crate::archive::replay::{Replayed, replay};
use crate::archive::sink::SinkError;
use crate::rerun::{Destinations, Identity, Live, MISSING_VIEWER, Playback, RerunSink};
use crate::telemetry::Topics;
use anyhow::{Context as _, Error, anyhow, bail};
use clap::Args;
use std::env;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// Arguments of `toprise view`.
#[derive(Args, Debug, PartialEq)]
pub(super) struct ViewArguments {
    /// Recordings (MCAP files); each becomes a recording of its own in the viewer.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    #[command(flatten)]
    viewer: ViewerArguments,

    /// Write a Rerun recording into this file; for several recordings, into this directory.
    #[arg(long, value_name = "PATH")]
    rrd: Option<PathBuf>,

    /// Replace files that exist.
    #[arg(long)]
    force: bool,

    /// Leave out what is earlier, in seconds of simulated time.
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, allow_negative_numbers = true)]
    from: Option<f64>,

    /// Leave out what is later, in seconds of simulated time.
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, allow_negative_numbers = true)]
    to: Option<f64>,
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

    /// Where the Rerun recording with a name goes.
    fn rrd_of(&self, name: &str) -> Option<PathBuf> {
        let path = self.rrd.as_ref()?;
        let is_directory = path.is_dir() || path.as_os_str().to_string_lossy().ends_with('/');
        if self.files.len() == 1 && !is_directory {
            return Some(path.clone());
        }
        Some(path.join(format!("{name}.rrd")))
    }

    /// What a viewer calls the files: by their names, told apart by numbers where they are the same.
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
pub(super) fn view(arguments: &ViewArguments) -> Result<Done, Error> {
    let selection = arguments.selection()?;
    let recordings = arguments
        .files
        .iter()
        .map(|file| open(file))
        .collect::<Result<Vec<_>, _>>()?;
    for name in arguments.names() {
        refuse_input(arguments, &name)?;
    }
    let interrupt = Interrupt::watch()?;
    let target = target(arguments)?;
    let progress = Progress::of_bytes("replaying", recordings.iter().map(Recording::size).sum());
    let mut done = Done::Well;
    for (recording, name) in recordings.iter().zip(arguments.names()) {
        let way = Way {
            arguments,
            selection: &selection,
            target: &target,
            interrupt: &interrupt,
            progress: &progress,
        };
        let replayed = show(recording, &name, &way)?;
        if report(recording, &replayed) || interrupt.is_asked() {
            done = Done::WithLosses;
        }
        if interrupt.is_asked() {
            break;
        }
    }
    progress.finish();
    target.serve_until(&interrupt);
    Ok(done)
}

/// A recording that is shown can't be replaced by what is shown.
fn refuse_input(arguments: &ViewArguments, name: &str) -> Result<(), Error> {
    if let Some(rrd) = arguments.rrd_of(name) {
        refuse_inputs(&rrd, arguments.files.iter().map(PathBuf::as_path))?;
    }
    Ok(())
}

fn open(file: &Path) -> Result<Recording, Error> {
    let recording = Recording::open(file).with_context(|| file.display().to_string())?;
    if recording.condition() == Condition::Foreign {
        bail!(
            "{}: not a toprise recording, but written by {:?}: try `rerun {0}`",
            file.display(),
            recording.library()
        );
    }
    Ok(recording)
}

/// The viewer that was asked for, or else one that can be started.
fn target(arguments: &ViewArguments) -> Result<Target, Error> {
    match arguments.viewer.target()? {
        Target::None if arguments.rrd.is_some() => Ok(Target::None),
        Target::None if viewer_is_installed() => Ok(Target::Live(Live::Spawn)),
        Target::None => Err(anyhow!(
            "{MISSING_VIEWER}\nor write a file for it with --rrd FILE"
        )),
        target => Ok(target),
    }
}

fn viewer_is_installed() -> bool {
    let name = format!("rerun{}", env::consts::EXE_SUFFIX);
    let path = env::var_os("PATH").unwrap_or_default();
    env::split_paths(&path).any(|directory| directory.join(&name).is_file())
}

/// How recordings are replayed.
struct Way<'a> {
    arguments: &'a ViewArguments,
    selection: &'a Selection,
    target: &'a Target,
    interrupt: &'a Interrupt,
    progress: &'a Progress,
}

/// Replays one recording.
fn show(recording: &Recording, name: &str, way: &Way<'_>) -> Result<Replayed, Error> {
    let Way {
        arguments,
        interrupt,
        progress,
        ..
    } = way;
    let path = recording.path();
    let context = || path.display().to_string();
    let identity = Identity {
        is_alone: arguments.files.len() == 1 || arguments.rrd.is_some(),
        ..identity(recording, name).with_context(context)?
    };
    let existing = Existing::forced(arguments.force);
    let draft = arguments.rrd_of(name).map(|rrd| Draft::new(&rrd, existing));
    let draft = draft.transpose()?;
    let destinations = Destinations {
        file: draft.as_ref().map(Draft::file).transpose()?,
        live: way.target.live(),
    };
    let mut sink = RerunSink::new(&identity, destinations);
    let warnings = sink.take_warnings();
    if draft.is_none() && !sink.is_live() {
        bail!("{}", warnings.join("; "));
    }
    output::warn_all(warnings);
    let replayed = replay(recording, way.selection.clone(), &mut sink, |read| {
        progress.add(read);
        if interrupt.is_asked() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    })
    .with_context(context)?;
    output::warn_all(sink.finish().map_err(SinkError::from)?);
    if let Some(draft) = draft {
        if interrupt.is_asked() {
            let path = draft.path().display();
            output::warn(&format!("interrupted: {path} is not written"));
        } else {
            publish(draft)?;
        }
    }
    if replayed.messages == 0 {
        output::warn(&format!(
            "{}: no messages in this span of time",
            path.display()
        ));
    }
    Ok(replayed)
}

fn publish(draft: Draft) -> Result<(), Error> {
    let path = draft.path().to_owned();
    let bytes = format::bytes(draft.publish()?);
    output::print(&format!("wrote {}  {bytes}", path.display()))?;
    Ok(())
}

fn identity(recording: &Recording, name: &str) -> Result<Identity, Error> {
    let scenario = recording
        .scenario()
        .context("the scene can't be drawn without the scenario")?;
    Ok(Identity::of(
        name,
        &scenario,
        recording.topics(),
        Playback::PausedAtStart,
    ))
}

/// Warns of what could not be shown; tells whether there is any.
fn report(recording: &Recording, replayed: &Replayed) -> bool {
    let path = recording.path().display();
    if recording.condition() == Condition::Interrupted {
        output::warn(&format!(
            "{path} was interrupted: it is shown as far as it goes"
        ));
    }
    for loss in &replayed.losses {
        output::warn(&format!("{path}: lost {loss}"));
    }
    if let Some((error, count)) = &replayed.undecodable {
        output::warn(&format!(
            "{path}: {count} messages left out, the first: {error}"
        ));
    }
    !replayed.losses.is_empty() || replayed.undecodable.is_some()
}
