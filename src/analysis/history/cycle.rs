//! Nutation cycles.

use crate::telemetry::Message;
use crate::telemetry::fields::nutation;

/// A nutation cycle: means, least and greatest values of θ, θ̇, φ̇ and ψ̇, in this order (rad, rad/s).
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cycle {
    /// Its number, from 0.
    pub(crate) number: f64,
    /// Time of its beginning, s.
    pub(crate) start: f64,
    /// Its duration, s.
    pub(crate) period: f64,
    /// Means.
    pub(crate) means: [f64; 4],
    /// Least and greatest values.
    pub(crate) ranges: [[f64; 2]; 4],
    /// The mean of the frictional term of φ̈, rad/s².
    pub(crate) frictional: f64,
}

impl Cycle {
    pub(super) fn of(message: &Message<'_>) -> Self {
        let means = [
            nutation::THETA_MEAN,
            nutation::THETA_DOT_MEAN,
            nutation::PHI_DOT_MEAN,
            nutation::PSI_DOT_MEAN,
        ];
        let ranges = [
            [nutation::THETA_MIN, nutation::THETA_MAX],
            [nutation::THETA_DOT_MIN, nutation::THETA_DOT_MAX],
            [nutation::PHI_DOT_MIN, nutation::PHI_DOT_MAX],
            [nutation::PSI_DOT_MIN, nutation::PSI_DOT_MAX],
        ];
        Self {
            number: nutation::CYCLE.of(message),
            start: nutation::START.of(message),
            period: nutation::PERIOD.of(message),
            means: means.map(|field| field.of(message)),
            ranges: ranges.map(|range| range.map(|field| field.of(message))),
            frictional: nutation::PHI_DDOT_FRICTIONAL_MEAN.of(message),
        }
    }

    /// Time of its end, s.
    pub(crate) fn end(&self) -> f64 {
        self.start + self.period
    }

    /// The middle of it, s.
    pub(crate) fn middle(&self) -> f64 {
        self.start + 0.5 * self.period
    }

    /// Amplitude of the nutation: half the range of θ̇, rad/s. That of θ is widened by the drift.
    pub(crate) fn amplitude(&self) -> f64 {
        let [_, [least, greatest], ..] = self.ranges;
        0.5 * (greatest - least)
    }
}
