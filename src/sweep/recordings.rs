//! Whole recordings of some runs of a sweep, in a directory beside its table.
//!
//! Which runs follows from the table, and each recording from its row; so recordings depend on threads and shards as
//! little as the table does, and what is missing can be written at any time.

use super::choice::Choice;
use super::directory;
use super::error::SweepError;
use super::part::{PART_ROWS, Sweep};
use super::row::Watch;
use super::store::Store;
use super::work::{Options, Shard};
use crate::archive::format::{SCENARIO_DIGEST, STOP_REASON};
use crate::archive::publish::{Draft, Existing};
use crate::archive::recording::{Condition, Recording};
use crate::archive::sink::{RecordError, Sink, SinkError, record};
use crate::archive::writer::{Form, McapSink};
use crate::run::scenario::Scenario;
use crate::run::simulation::{RunEnd, Simulation, StopReason};
use crate::telemetry::Telemetry;
use rayon::iter::{IntoParallelRefIterator as _, ParallelIterator as _};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

/// The directory for the recordings of a table's runs.
#[must_use]
pub fn recordings_directory(table: &Path) -> PathBuf {
    directory::beside(table, ".runs")
}

/// Refuses a directory of recordings that belongs to another sweep.
///
/// # Errors
/// [`SweepError::Changed`].
pub fn check_recordings(sweep: &Sweep, table: &Path) -> Result<(), SweepError> {
    directory::check(&recordings_directory(table), sweep.identity())
}

/// Recordings of chosen runs: which there must be, and which of them are missing.
pub struct Recordings<'a> {
    sweep: &'a Sweep,
    directory: PathBuf,
    chosen: u64,
    missing: Vec<u64>,
    early: Vec<u64>,
}

/// What was recorded.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recorded {
    /// Number of recordings that were written.
    pub written: u64,
    /// Runs whose recordings end early because their motion could not be recorded to its end, and why; the reason is not
    /// known of a recording that another process wrote meanwhile.
    pub failed: Vec<(u64, Option<String>)>,
    /// Whether it was interrupted.
    pub is_interrupted: bool,
}

/// How the recording of a run ended.
enum End {
    /// The run is recorded.
    Whole,
    /// It is recorded up to where its motion could not be recorded further, and why.
    Early(String),
    /// Another process was faster, and recorded it.
    There(Found),
    /// It was interrupted, and nothing is left of it.
    Interrupted,
}

/// A recording that is there.
enum Found {
    /// It reaches to where the run ended.
    Whole,
    /// It ends where the motion could not be recorded further.
    Early,
}

impl<'a> Recordings<'a> {
    /// Finds the chosen runs in the table, or in the parts of a share: of these only runs that are among the chosen ones
    /// whatever the other shares come to.
    ///
    /// # Errors
    /// [`SweepError::Table`] if the table can't be read, [`SweepError::BadRecording`] if something else has the name of a
    /// recording.
    pub fn find(
        sweep: &'a Sweep,
        table: &Path,
        choice: &Choice,
        shard: Option<Shard>,
    ) -> Result<Self, SweepError> {
        let chosen = match shard {
            None => chosen(table, choice)?,
            Some(shard) => chosen_of_shard(sweep, table, choice, shard)?,
        };
        let mut recordings = Self {
            sweep,
            directory: recordings_directory(table),
            chosen: chosen.len() as u64,
            missing: Vec::new(),
            early: Vec::new(),
        };
        for run in chosen {
            match recordings.found(run)? {
                None => recordings.missing.push(run),
                Some(Found::Early) => recordings.early.push(run),
                Some(Found::Whole) => {}
            }
        }
        Ok(recordings)
    }

    /// The number of chosen runs.
    #[must_use]
    pub fn chosen(&self) -> u64 {
        self.chosen
    }

    /// The number of them that have no recording yet.
    #[must_use]
    pub fn missing(&self) -> u64 {
        self.missing.len() as u64
    }

    /// The runs whose recordings are there and end early.
    #[must_use]
    pub fn early(&self) -> &[u64] {
        &self.early
    }

    /// Writes the missing recordings with all threads.
    ///
    /// # Errors
    /// [`SweepError::Sink`] if the disk is full, or the like. Recordings that are complete stay.
    pub fn write(&self, options: &Options, watch: &Watch<'_>) -> Result<Recorded, SweepError> {
        if self.missing.is_empty() {
            return Ok(Recorded::default());
        }
        directory::claim(&self.directory, self.sweep.identity())?;
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(options.threads)
            .build()?;
        let write = |run: &u64| self.write_one(*run, watch);
        let all: Result<Vec<_>, _> = pool.install(|| self.missing.par_iter().map(write).collect());
        let mut recorded = Recorded::default();
        for (end, run) in all?.into_iter().zip(&self.missing) {
            match end {
                End::Whole => recorded.written += 1,
                End::Early(why) => {
                    recorded.written += 1;
                    recorded.failed.push((*run, Some(why)));
                }
                End::There(Found::Whole) => {}
                End::There(Found::Early) => recorded.failed.push((*run, None)),
                End::Interrupted => recorded.is_interrupted = true,
            }
        }
        Ok(recorded)
    }

    fn path(&self, run: u64) -> PathBuf {
        self.directory.join(format!("{run:06}.mcap"))
    }

    fn scenario(&self, run: u64) -> Result<Scenario, SweepError> {
        let scenario = self.sweep.scenario(run);
        scenario.map_err(|error| SweepError::row(run, &error))
    }

    /// The recording of a run; none if it isn't there.
    fn found(&self, run: u64) -> Result<Option<Found>, SweepError> {
        let path = self.path(run);
        if path.symlink_metadata().is_err() {
            return Ok(None);
        }
        let reason = match Recording::open(&path) {
            Err(error) => error.to_string(),
            Ok(recording) => {
                let condition = recording.condition();
                let of = recording.run().and_then(|run| run.get(SCENARIO_DIGEST));
                if condition != Condition::Whole {
                    condition.name().to_owned()
                } else if of != Some(&self.scenario(run)?.digest()) {
                    "it is of another scenario".to_owned()
                } else {
                    let stop = recording.end().and_then(|end| end.get(STOP_REASON));
                    let is_early = stop.is_some_and(|stop| stop == StopReason::Failed.name());
                    return Ok(Some(if is_early { Found::Early } else { Found::Whole }));
                }
            }
        };
        Err(SweepError::BadRecording { path, run, reason })
    }

    /// What another process has recorded of a run, whose file now has the name.
    fn faster(&self, run: u64, error: SinkError) -> Result<End, SweepError> {
        let found = self.found(run)?;
        found.map(End::There).ok_or_else(|| error.into())
    }

    /// Records a run as `toprise run` does.
    fn write_one(&self, run: u64, watch: &Watch<'_>) -> Result<End, SweepError> {
        let mut is_interrupted = !(watch.carry_on)();
        if is_interrupted {
            return Ok(End::Interrupted);
        }
        let draft = match Draft::new(&self.path(run), Existing::Keep) {
            Err(error @ SinkError::Exists { .. }) => return self.faster(run, error),
            draft => draft?,
        };
        let scenario = self.scenario(run)?;
        let mut telemetry = Telemetry::default();
        let mut sink = McapSink::create_in(draft, &scenario, &telemetry, Form::default())?;
        let simulation = Simulation::new(&scenario);
        let mut simulation = simulation.map_err(|error| SweepError::row(run, &error))?;
        let mut sinks: [&mut dyn Sink; 1] = [&mut sink];
        let ended = record(&mut simulation, &mut telemetry, &mut sinks, |_, _| {
            is_interrupted = !(watch.carry_on)();
            Ok(match is_interrupted {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            })
        });
        if is_interrupted {
            return Ok(End::Interrupted);
        }
        let (end, how) = match ended {
            Ok(end) => (end, End::Whole),
            Err(RecordError::Sink(error)) => return Err(error.into()),
            Err(error) => {
                let stop = StopReason::Failed;
                let end = simulation.end();
                (RunEnd { stop, ..end }, End::Early(error.to_string()))
            }
        };
        match sink.finish(&end) {
            Ok(_) => {}
            Err(error @ SinkError::Exists { .. }) => return self.faster(run, error),
            Err(error) => return Err(error.into()),
        }
        (watch.done)(Some(end.stop));
        Ok(how)
    }
}

/// The chosen runs of a table.
fn chosen(table: &Path, choice: &Choice) -> Result<Vec<u64>, SweepError> {
    let mut chosen = Vec::new();
    let is_enough = |chosen: &Vec<u64>| choice.most.is_some_and(|most| chosen.len() as u64 >= most);
    choice.each(table, |run| {
        if !is_enough(&chosen) {
            chosen.push(run);
        }
        !is_enough(&chosen)
    })?;
    Ok(chosen)
}

/// The chosen runs of a share. Of the first N, those whose numbers are below N: what other shares have before them is
/// not known here.
fn chosen_of_shard(
    sweep: &Sweep,
    table: &Path,
    choice: &Choice,
    shard: Shard,
) -> Result<Vec<u64>, SweepError> {
    let mut chosen = Vec::new();
    let mut take = |run: u64| {
        let is_certain = choice.most.is_none_or(|most| run < most);
        if is_certain && shard.has(run / PART_ROWS) {
            chosen.push(run);
        }
        is_certain
    };
    if table.exists() {
        choice.each(table, take)?;
    } else {
        let store = Store::new(sweep, table);
        for part in (0..sweep.parts()).filter(|part| shard.has(*part)) {
            choice.each(&store.part(part), &mut take)?;
        }
    }
    Ok(chosen)
}
