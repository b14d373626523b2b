//! Nutation cycles.

use crate::telemetry::Message;
use crate::telemetry::fields::{NumberField, nutation};

/// A nutation cycle.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cycle {
    /// Time of its beginning, s.
    pub(crate) start: f64,
    /// Its duration, s.
    pub(crate) period: f64,
    /// Means of θ, θ̇, φ̇ and ψ̇ (rad, rad/s).
    pub(crate) means: [f64; 4],
    /// The numbers of its message.
    numbers: Vec<f64>,
}

impl Cycle {
    pub(super) fn of(message: &Message<'_>) -> Self {
        let means = [
            nutation::THETA_MEAN,
            nutation::THETA_DOT_MEAN,
            nutation::PHI_DOT_MEAN,
            nutation::PSI_DOT_MEAN,
        ];
        Self {
            start: nutation::START.of(message),
            period: nutation::PERIOD.of(message),
            means: means.map(|field| field.of(message)),
            numbers: message.numbers.to_vec(),
        }
    }

    /// A field of its message.
    pub(crate) fn of_field(&self, field: NumberField) -> f64 {
        self.numbers[field.index()]
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
        0.5 * (self.of_field(nutation::THETA_DOT_MAX) - self.of_field(nutation::THETA_DOT_MIN))
    }
}
