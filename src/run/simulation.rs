//! From a scenario to the stream of what happens: samples at exact times, events, nutation cycles.
//!
//! [`Simulation`] is an iterator of [`Record`]s in the order of their times. It does no input or output
//! and has no clock. Samples and events are read off the integrator's dense output and never change
//! its steps.

mod event;
mod free;
mod nutation;
mod progress;
mod queue;
mod record;
mod runner;
mod sample;
mod tally;
mod watch;

pub use event::{Event, EventKind, StopReason, UPRIGHT};
pub use free::{FreeSample, Landing};
pub use nutation::NutationCycle;
pub use record::{Record, RunEnd, SimulationError};
pub use sample::{Energies, Frames, Momenta, Pose, Precession, Sample, Slip, Torques};
pub use tally::{EventCount, Tally};

use crate::physics::dynamics::{BodyRotation, EulerAngles, FreeRotation};
use crate::run::scenario::{FormulationKind, Scenario};
use runner::{Detail, RecordStream, Runner};

/// A run in progress.
pub struct Simulation {
    run: Box<dyn RecordStream>,
    carry_on: Box<dyn FnMut() -> bool>,
}

impl Simulation {
    /// Starts the run that `scenario` defines.
    ///
    /// # Errors
    /// [`SimulationError::Integrate`] if the accelerations are not finite at the start.
    pub fn new(scenario: &Scenario) -> Result<Self, SimulationError> {
        type Free = Runner<FreeRotation, { FreeRotation::STATE_LENGTH }>;
        type Euler = Runner<EulerAngles, { EulerAngles::STATE_LENGTH }>;
        type Body = Runner<BodyRotation, { BodyRotation::STATE_LENGTH }>;
        Ok(Self {
            run: match scenario.formulation {
                _ if scenario.model.support.is_free() => {
                    Box::new(Free::new(scenario, Detail::All)?)
                }
                FormulationKind::Euler => Box::new(Euler::new(scenario, Detail::All)?),
                FormulationKind::Body => Box::new(Body::new(scenario, Detail::All)?),
            },
            carry_on: Box::new(|| true),
        })
    }

    /// Ends the run early, as interrupted, once `carry_on` returns false. It is called before each step of the integrator, of
    /// which there may be millions between two records.
    #[must_use]
    pub fn running_while(mut self, carry_on: impl FnMut() -> bool + 'static) -> Self {
        self.carry_on = Box::new(carry_on);
        self
    }

    /// State of the run at the last record; final once the iterator has ended.
    ///
    /// Before the end, `stop` is [`StopReason::Interrupted`]: that is why a run ends that no one
    /// carries on.
    #[must_use]
    pub fn end(&self) -> RunEnd {
        self.run.end()
    }
}

impl Iterator for Simulation {
    type Item = Result<Record, SimulationError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.run.next_record(&mut *self.carry_on).transpose()
    }
}

/// Runs a scenario to its end for nothing but that end and what happens before: without samples, without the least and
/// greatest rates of nutations, and without the integrals that only recordings need. The steps, the events and the end
/// are those of the [`Simulation`], to the last bit; the derivative is evaluated less often.
///
/// `carry_on` is asked before each step of the integrator; once it returns false, the run ends early, as interrupted.
///
/// # Errors
/// As those of a [`Simulation`].
pub fn tallied(
    scenario: &Scenario,
    mut carry_on: impl FnMut() -> bool,
) -> Result<(RunEnd, Tally), SimulationError> {
    type Free = Runner<FreeRotation, { FreeRotation::SHORT_STATE_LENGTH }>;
    type Euler = Runner<EulerAngles, { EulerAngles::SHORT_STATE_LENGTH }>;
    type Body = Runner<BodyRotation, { BodyRotation::SHORT_STATE_LENGTH }>;
    let (detail, carry_on) = (Detail::Outcome, &mut carry_on);
    match scenario.formulation {
        _ if scenario.model.support.is_free() => Free::new(scenario, detail)?.tallied(carry_on),
        FormulationKind::Euler => Euler::new(scenario, detail)?.tallied(carry_on),
        FormulationKind::Body => Body::new(scenario, detail)?.tallied(carry_on),
    }
}
