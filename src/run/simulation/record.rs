//! Records and end of a simulation.

use super::event::{Event, StopReason};
use super::free::ImpactRecord;
use super::nutation::NutationCycle;
use super::sample::Sample;
use crate::physics::dynamics::Motion;
use crate::physics::integrate::Statistics;

/// One record of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Record {
    /// A sample.
    Sample(Box<Sample>),
    /// An event.
    Event(Box<Event>),
    /// A nutation cycle, at its end.
    Nutation(Box<NutationCycle>),
    /// An impact of a free peg.
    Impact(Box<ImpactRecord>),
}

impl Record {
    /// Time of the record, ns.
    pub fn time_ns(&self) -> u64 {
        match self {
            Self::Sample(sample) => sample.time_ns,
            Self::Event(event) => event.time_ns,
            Self::Nutation(cycle) => cycle.time_ns,
            Self::Impact(impact) => impact.time_ns,
        }
    }
}

/// End of a run, and counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunEnd {
    /// Reason for the end.
    pub stop: StopReason,
    /// Time of the end, s.
    pub time: f64,
    /// The motion at the end.
    pub motion: Motion,
    /// Total energy at the end, J.
    pub energy: f64,
    /// Total energy at the start, J.
    pub energy_at_start: f64,
    /// Number of samples.
    pub samples: u64,
    /// Time at which the axis of a tippe top passed the horizontal, s.
    pub inversion_time: Option<f64>,
    /// Number of events.
    pub events: u64,
    /// Number of complete nutation cycles.
    pub nutations: u64,
    /// Number of impacts of a free peg.
    pub impacts: u64,
    /// Statistics of the integrator.
    pub statistics: Statistics,
}
