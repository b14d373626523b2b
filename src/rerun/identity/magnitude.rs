//! Typical magnitudes of the quantities of a run. Variations far below them are rounding errors.

use crate::physics::kinematics::Tilt;
use crate::run::scenario::Scenario;
use crate::telemetry::Quantity;
use crate::telemetry::proportions::Proportions;

/// Magnitudes at the start of a run, from which those of all quantities follow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Magnitudes {
    /// Angular speed, rad/s.
    rate: f64,
    /// Height of the top, m.
    length: f64,
    /// Weight, N.
    weight: f64,
    /// Angular momentum, N m s.
    momentum: f64,
}

impl Magnitudes {
    /// The magnitudes of a scenario's runs.
    pub(super) fn new(scenario: &Scenario) -> Self {
        let top = &scenario.model.top;
        let rate = Tilt::from_rates(scenario.angles.theta, scenario.rates)
            .omega_lean
            .norm();
        Self {
            rate,
            length: Proportions::new(top).size(),
            weight: top.weight(),
            momentum: top.axial_moment * rate,
        }
    }

    /// The typical magnitude of a quantity, in its SI unit; 0 for times, counts and states, which have no rounding
    /// errors.
    pub(in crate::rerun) fn typical(&self, quantity: Quantity) -> f64 {
        let speed = self.rate * self.length;
        match quantity {
            Quantity::Force => self.weight,
            Quantity::Torque | Quantity::Energy => self.weight * self.length,
            Quantity::Acceleration => self.rate * self.rate,
            Quantity::Rate | Quantity::ReferenceRate => self.rate,
            Quantity::Velocity => speed,
            Quantity::Angle | Quantity::Direction | Quantity::Orientation => 1.0,
            Quantity::Length => self.length,
            Quantity::Power => self.weight * speed,
            Quantity::Momentum => self.momentum,
            Quantity::LinearAcceleration => self.rate * speed,
            Quantity::Impulse => self.momentum / self.length,
            Quantity::Jellett => self.momentum * self.length,
            Quantity::Time | Quantity::Number | Quantity::Flag | Quantity::Text => 0.0,
        }
    }
}
