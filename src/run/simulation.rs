//! Simulation of a scenario: a stream of samples, events and nutation cycles.
//!
//! [`Simulation`] is an iterator of [`Record`]s in time order. It does no I/O and uses no clock. Samples and events are
//! computed from the integrator's dense output and never change its steps.

mod error;
mod event;
mod failure_point;
mod free;
mod nutation;
mod progress;
mod queue;
mod record;
mod regime;
mod runner;
mod sample;
mod tally;
mod watch;

pub use error::SimulationError;
pub use event::{Event, EventKind, EventState, StopReason, UPRIGHT};
pub use failure_point::{ContactPhase, FailurePoint};
pub use free::{FreeSample, ImpactRecord};
pub use nutation::NutationCycle;
pub use progress::Stall;
pub use record::{Record, RunEnd};
pub use regime::Regime;
pub use sample::{Energies, Frames, Momenta, Pose, Precession, Sample, Slip, Torques};
pub use tally::{EventCount, Tally};

use crate::physics::dynamics::{BodyRotation, EulerAngles, FreeRotation};
use crate::run::scenario::{FormulationKind, Scenario};
use runner::{Detail, RecordStream, Runner};

/// The length of a state without the integrals that only recordings need, of `all` or `few` variables. The motion is the
/// same, bit for bit, with both. In WebAssembly, for the page, both are `all`: integrators of their own would be a tenth of
/// the code that a browser loads.
const fn short_length(all: usize, few: usize) -> usize {
    if cfg!(target_arch = "wasm32") {
        all
    } else {
        few
    }
}

/// A runner without the integrals that only recordings need.
type ShortFree = Runner<
    FreeRotation,
    { short_length(FreeRotation::STATE_LENGTH, FreeRotation::SHORT_STATE_LENGTH) },
>;
type ShortEuler = Runner<
    EulerAngles,
    { short_length(EulerAngles::STATE_LENGTH, EulerAngles::SHORT_STATE_LENGTH) },
>;
type ShortBody = Runner<
    BodyRotation,
    { short_length(BodyRotation::STATE_LENGTH, BodyRotation::SHORT_STATE_LENGTH) },
>;

/// A run in progress.
pub struct Simulation {
    run: Box<dyn RecordStream>,
    carry_on: Box<dyn FnMut() -> bool>,
    tally: Tally,
}

impl Simulation {
    /// Starts the run that `scenario` defines.
    ///
    /// # Errors
    /// [`SimulationError`] if the accelerations are not finite at the start.
    pub fn new(scenario: &Scenario) -> Result<Self, SimulationError> {
        type Free = Runner<FreeRotation, { FreeRotation::STATE_LENGTH }>;
        type Euler = Runner<EulerAngles, { EulerAngles::STATE_LENGTH }>;
        type Body = Runner<BodyRotation, { BodyRotation::STATE_LENGTH }>;
        Ok(Self {
            run: match scenario.formulation {
                // A free peg has one formulation; scenarios are checked to name no other.
                _ if scenario.model.support.is_free() => {
                    Box::new(Free::new(scenario, Detail::All)?)
                }
                FormulationKind::Euler => Box::new(Euler::new(scenario, Detail::All)?),
                FormulationKind::Body => Box::new(Body::new(scenario, Detail::All)?),
            },
            carry_on: Box::new(|| true),
            tally: Tally::default(),
        })
    }

    /// Sets a function that is called before each integrator step; there may be millions of steps between two records.
    /// If it returns false, the run ends as interrupted.
    pub fn continue_while(mut self, carry_on: impl FnMut() -> bool + 'static) -> Self {
        self.carry_on = Box::new(carry_on);
        self
    }

    /// State of the run at the last record; final after the iterator is exhausted.
    ///
    /// Before the end, `stop` is [`StopReason::Interrupted`], the reason if the iterator is dropped early.
    pub fn end(&self) -> RunEnd {
        self.run.end()
    }

    /// Counts of the events so far.
    pub fn tally(&self) -> &Tally {
        &self.tally
    }
}

impl Iterator for Simulation {
    type Item = Result<Record, SimulationError>;

    fn next(&mut self) -> Option<Self::Item> {
        let record = self.run.next_record(&mut *self.carry_on).transpose();
        if let Some(Ok(Record::Event(event))) = &record {
            self.tally.record(event.kind, event.time);
        }
        record
    }
}

/// Runs a scenario without samples, rate extremes and the integrals needed only for recordings, and returns its end and
/// event counts. Steps, events and end are bit-identical to those of the [`Simulation`]; the derivative is evaluated
/// less often.
///
/// `carry_on` is called before each integrator step; if it returns false, the run ends as interrupted.
///
/// # Errors
/// As those of a [`Simulation`].
pub fn run_without_samples(
    scenario: &Scenario,
    mut carry_on: impl FnMut() -> bool,
) -> Result<(RunEnd, Tally), SimulationError> {
    // Fewer running integrals make a step cheaper and don't change the motion.
    let (detail, carry_on) = (Detail::Outcome, &mut carry_on);
    match scenario.formulation {
        _ if scenario.model.support.is_free() => {
            ShortFree::new(scenario, detail)?.run_without_samples(carry_on)
        }
        FormulationKind::Euler => ShortEuler::new(scenario, detail)?.run_without_samples(carry_on),
        FormulationKind::Body => ShortBody::new(scenario, detail)?.run_without_samples(carry_on),
    }
}

/// Simulates a scenario and passes the sample at each of these times (s, ascending, from 0 on) to `take`, with the index
/// of the time. Steps are those of the [`Simulation`], but only the events that end a phase or the run are located.
///
/// The running integrals of a sample (work, slip path) are not computed beyond the first two. The run ends at
/// `stop.duration` of the scenario, or before; later times have no sample.
///
/// # Errors
/// As those of a [`Simulation`].
pub fn sample_at(
    scenario: &Scenario,
    times: &[f64],
    take: &mut dyn FnMut(usize, &Sample),
) -> Result<RunEnd, SimulationError> {
    sample_at_while(scenario, times, take, &mut || true)
}

/// As [`sample_at`]. `carry_on` is called before each integrator step; if it returns false, the run ends as interrupted.
///
/// # Errors
/// As those of a [`Simulation`].
pub fn sample_at_while(
    scenario: &Scenario,
    times: &[f64],
    take: &mut dyn FnMut(usize, &Sample),
    carry_on: &mut dyn FnMut() -> bool,
) -> Result<RunEnd, SimulationError> {
    let detail = Detail::Motion;
    match scenario.formulation {
        _ if scenario.model.support.is_free() => {
            ShortFree::new(scenario, detail)?.take_samples(times, take, carry_on)
        }
        FormulationKind::Euler => {
            ShortEuler::new(scenario, detail)?.take_samples(times, take, carry_on)
        }
        FormulationKind::Body => {
            ShortBody::new(scenario, detail)?.take_samples(times, take, carry_on)
        }
    }
}
