//! `toprise view`: recordings again in Rerun.

use super::interrupt::Interrupt;
use super::progress::Progress;
use super::viewer::{Target, ViewerArguments};
use super::{Done, format, output, run::parse_seconds};
use crate::recording::{Condition, Recording, Selection};
use crate::sink::SinkError;
use crate::sink::publish::{Existing, Place};
use crate::sink::rerun::{Destinations, Identity, Live, MISSING_VIEWER, Playback, RerunSink};
use crate::telemetry::channels;
use crate::view::{Replayed, replay};
use anyhow::{Context as _, Error, anyhow, bail};
use clap::Args;
use std::env;
use std::fs::File;
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
            topics: Vec::new(),
            from_ns: self.from.map(nanoseconds),
            to_ns: self.to.map(nanoseconds),
        })
    }

    /// Where the Rerun recording of a file goes.
    fn rrd_of(&self, file: &Path) -> Option<PathBuf> {
        let path = self.rrd.as_ref()?;
        if self.files.len() == 1 && !path.is_dir() {
            return Some(path.clone());
        }
        Some(path.join(file.file_stem()?).with_extension("rrd"))
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
    let interrupt = Interrupt::watch()?;
    let target = target(arguments)?;
    let progress = Progress::of_bytes("replaying", recordings.iter().map(Recording::size).sum());
    let mut done = Done::Well;
    for recording in &recordings {
        let replayed = show(
            recording, arguments, &selection, &target, &interrupt, &progress,
        )?;
        if report(recording, &replayed) {
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

/// Replays one recording.
fn show(
    recording: &Recording,
    arguments: &ViewArguments,
    selection: &Selection,
    target: &Target,
    interrupt: &Interrupt,
    progress: &Progress,
) -> Result<Replayed, Error> {
    let path = recording.path();
    let context = || path.display().to_string();
    let identity = Identity {
        is_alone: arguments.files.len() == 1 || arguments.rrd.is_some(),
        ..identity(recording).with_context(context)?
    };
    let existing = Existing::forced(arguments.force);
    let reserved = match arguments.rrd_of(path) {
        Some(rrd) => Some(Place::reserve(&rrd, existing)?),
        None => None,
    };
    let (place, file) = reserved.unzip();
    let destinations = Destinations {
        file,
        live: target.live(),
    };
    let mut sink = RerunSink::new(&identity, destinations).map_err(SinkError::from)?;
    let warnings = sink.take_warnings();
    if place.is_none() && !sink.is_live() {
        bail!("{}", warnings.join("; "));
    }
    output::warn_all(warnings);
    let replayed = replay(recording, selection.clone(), &mut sink, |read| {
        progress.add(read);
        if interrupt.is_asked() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    })
    .with_context(context)?;
    let (file, warnings) = sink.finish().map_err(SinkError::from)?;
    output::warn_all(warnings);
    if let Some((place, file)) = place.zip(file) {
        publish(&place, &file)?;
    }
    Ok(replayed)
}

fn publish(place: &Place, file: &File) -> Result<(), Error> {
    let bytes = file.metadata().map_or(0, |metadata| metadata.len());
    place.publish(file)?;
    let path = place.path().display();
    output::print(&format!("wrote {path}  {}", format::bytes(bytes)))?;
    Ok(())
}

fn identity(recording: &Recording) -> Result<Identity, Error> {
    let scenario = recording
        .scenario()
        .context("the scene can't be drawn without the scenario")?;
    let name = recording.path().file_stem().unwrap_or_default();
    let has = |topic: &str| recording.channels().iter().any(|c| c.topic == topic);
    let topics = channels().iter().map(|channel| channel.topic);
    Ok(Identity::of(
        &name.to_string_lossy(),
        &scenario,
        topics
            .filter(|topic| has(topic))
            .map(str::to_owned)
            .collect(),
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
