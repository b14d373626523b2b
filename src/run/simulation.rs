//! From a scenario to the stream of what happens: samples at exact times, events, nutation cycles.
//!
//! [`Simulation`] is an iterator of [`Record`]s in the order of their times. It does no input or output
//! and knows no clock. Samples and events are read off the integrator's dense output and never change
//! its steps.

mod event;
mod nutation;
mod runner;
mod sample;

pub use event::{Event, EventKind, StopReason};
pub use nutation::NutationCycle;
pub use sample::{Frames, Sample};

use crate::physics::dynamics::{BodyRotation, EulerAngles, Motion};
use crate::physics::integrate::{IntegrateError, Statistics};
use crate::run::scenario::{FormulationKind, Scenario};
use runner::{Run, Runner};
use thiserror::Error;

/// One thing that a run has to tell.
#[derive(Clone, Debug, PartialEq)]
pub enum Record {
    /// Everything at one of the equally spaced sample times.
    Sample(Box<Sample>),
    /// Something that happened.
    Event(Box<Event>),
    /// A nutation cycle that has just ended.
    Nutation(Box<NutationCycle>),
}

impl Record {
    /// When it happens, ns.
    #[must_use]
    pub fn time_ns(&self) -> u64 {
        match self {
            Self::Sample(sample) => sample.time_ns,
            Self::Event(event) => event.time_ns,
            Self::Nutation(cycle) => cycle.time_ns,
        }
    }
}

/// Why a simulation can't go on.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SimulationError {
    /// The integrator gave up.
    #[error("the motion can't be integrated further: {0}")]
    Integrate(#[from] IntegrateError),
    /// The steps have become too short.
    #[error(
        "the motion doesn't get on beyond t = {time} s: a torque jumps back and forth there (drilling against \
             a top that has stopped turning, or a law that is too steep)"
    )]
    Stalled {
        /// When, s.
        time: f64,
    },
}

/// How a run ended, and what it consisted of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Why it ended.
    pub stop: StopReason,
    /// When, s.
    pub time: f64,
    /// The motion at that moment.
    pub motion: Motion,
    /// Total energy then, J.
    pub energy: f64,
    /// Total energy at the start, J.
    pub energy_at_start: f64,
    /// Number of samples.
    pub samples: u64,
    /// Number of events.
    pub events: u64,
    /// Number of whole nutation cycles.
    pub nutations: u64,
    /// What the integration cost.
    pub statistics: Statistics,
}

/// A run in progress.
pub struct Simulation(Box<dyn Run>);

impl Simulation {
    /// Starts the run that `scenario` defines.
    ///
    /// # Errors
    /// [`SimulationError::Integrate`] if the accelerations are not finite at the start.
    pub fn new(scenario: &Scenario) -> Result<Self, SimulationError> {
        let model = scenario.model;
        Ok(Self(match scenario.formulation {
            FormulationKind::Euler => Box::new(Runner::new(EulerAngles::new(model), scenario)?),
            FormulationKind::Body => Box::new(Runner::new(BodyRotation::new(model), scenario)?),
        }))
    }

    /// What has happened up to the last record; final once the iterator has ended.
    ///
    /// Before the end, `stop` is [`StopReason::Interrupted`]: that is why a run ends that nobody
    /// carries on.
    #[must_use]
    pub fn outcome(&self) -> Outcome {
        self.0.outcome()
    }
}

impl Iterator for Simulation {
    type Item = Result<Record, SimulationError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.0.next_record().transpose()
    }
}
