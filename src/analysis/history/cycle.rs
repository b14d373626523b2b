//! Nutation cycles.

use crate::telemetry::Message;
use crate::telemetry::fields::{NumberField, nutation};
use std::f64::consts::TAU;

/// A nutation cycle.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cycle {
    /// Time of the beginning, s.
    pub(crate) start: f64,
    /// Duration, s.
    pub(crate) period: f64,
    /// Means of θ, θ̇, φ̇ and ψ̇ (rad, rad/s).
    pub(crate) means: [f64; 4],
    /// All numbers of the message.
    numbers: Vec<f64>,
}

impl Cycle {
    pub(super) fn from_message(message: &Message<'_>) -> Self {
        Self {
            start: nutation::START.of(message),
            period: nutation::PERIOD.of(message),
            means: [
                nutation::THETA_MEAN.of(message),
                nutation::THETA_DOT_MEAN.of(message),
                nutation::PHI_DOT_MEAN.of(message),
                nutation::PSI_DOT_MEAN.of(message),
            ],
            numbers: message.numbers.to_vec(),
        }
    }

    /// A field of `/top/nutation`.
    pub(crate) fn field(&self, field: NumberField) -> f64 {
        self.numbers[field.index()]
    }

    /// Time of the end, s.
    pub(crate) fn end(&self) -> f64 {
        self.start + self.period
    }

    /// Whether the axis has stopped nutating between this last cycle and a time, s, at which a motion ends: it ends in its
    /// last nutation otherwise, or in the next, which is not complete.
    pub(crate) fn is_last_before(&self, time: f64) -> bool {
        const NUTATIONS: f64 = 2.0;
        time > self.end() + NUTATIONS * self.period
    }

    /// Time of the middle, s.
    pub(crate) fn middle(&self) -> f64 {
        self.start + 0.5 * self.period
    }

    /// Amplitude of the nutation: half the range of θ̇, rad/s. That of θ is widened by the drift.
    pub(crate) fn amplitude(&self) -> f64 {
        0.5 * (self.field(nutation::THETA_DOT_MAX) - self.field(nutation::THETA_DOT_MIN))
    }

    /// Amplitude of θ in the nutation, rad: that of θ̇ over the frequency.
    pub(crate) fn amplitude_of_theta(&self) -> f64 {
        self.amplitude() * self.period / TAU
    }
}
