//! Output of a simulation: records, the error that ends it, and how it ended.

use super::event::{Event, StopReason};
use super::free::Landing;
use super::nutation::NutationCycle;
use super::sample::Sample;
use crate::physics::dynamics::Motion;
use crate::physics::integrate::{IntegrateError, Statistics};
use thiserror::Error;

/// One record of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Record {
    /// Everything at one of the equally spaced sample times.
    Sample(Box<Sample>),
    /// Something that happened.
    Event(Box<Event>),
    /// A nutation cycle that has just ended.
    Nutation(Box<NutationCycle>),
    /// An impact of a free peg.
    Impact(Box<Landing>),
}

impl Record {
    /// Its time, ns.
    #[must_use]
    pub fn time_ns(&self) -> u64 {
        match self {
            Self::Sample(sample) => sample.time_ns,
            Self::Event(event) => event.time_ns,
            Self::Nutation(cycle) => cycle.time_ns,
            Self::Impact(impact) => impact.time_ns,
        }
    }
}

/// The reason why a simulation can't go on.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SimulationError {
    /// The integrator gave up.
    #[error("the motion can't be integrated further: {0}")]
    Integrate(#[from] IntegrateError),
    /// An impact can't be computed.
    #[error(
        "the impact at t = {time:?} s can't be followed: its friction changes too steeply with the velocity of the contact point"
    )]
    Impact {
        /// When, s.
        time: f64,
    },
    /// The steps have become so short that the run would never end.
    #[error(
        "the motion has stalled at t = {time:?} s: a torque jumps back and forth there (drilling against \
             a top that has stopped turning, or a law that is too steep)"
    )]
    Stalled {
        /// When, s.
        time: f64,
    },
    /// The phases have become so short that the run would never end.
    #[error(
        "the motion has stalled at t = {time:?} s: the peg leaves the table and touches it again without end there \
             (smaller integrator.absolute_tolerance and integrator.relative_tolerance, below 1e-9, distinguish them)"
    )]
    Chatters {
        /// When, s.
        time: f64,
    },
}

/// End of a run, and its counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunEnd {
    /// The reason for its end.
    pub stop: StopReason,
    /// The time of its end, s.
    pub time: f64,
    /// The motion at that moment.
    pub motion: Motion,
    /// Total energy then, J.
    pub energy: f64,
    /// Total energy at the start, J.
    pub energy_at_start: f64,
    /// Number of samples.
    pub samples: u64,
    /// Time at which a tippe top inverted, its axis passing the horizontal, s.
    pub inversion_time: Option<f64>,
    /// Number of events.
    pub events: u64,
    /// Number of whole nutation cycles.
    pub nutations: u64,
    /// Number of impacts of a free peg.
    pub impacts: u64,
    /// Cost of the integration.
    pub statistics: Statistics,
}
