//! Scales of the arrows.

use crate::run::scenario::Scenario;
use crate::telemetry::proportions::Proportions;

/// Lengths of arrows in metres per unit; `None` if the quantity is zero.
#[derive(Clone, Copy, Debug)]
pub(super) struct ViewScales {
    /// Scale of slip velocities, m per m/s.
    pub(super) slip: Option<f64>,
    /// Scale of torques, m per N m.
    pub(super) torque: Option<f64>,
}

impl ViewScales {
    /// Scales that make the arrows of the initial slip velocity and of the torque of the largest friction force
    /// somewhat longer than the top.
    pub(super) fn new(scenario: &Scenario, proportions: &Proportions) -> Self {
        let length = 1.6 * proportions.size();
        Self {
            slip: round_scale(length / scenario.slip_speed_at_start()),
            torque: round_scale(length / scenario.torque_scale()),
        }
    }
}

/// A scale rounded to two digits, because the legend shows it; `None` for a quantity that is zero or too large.
fn round_scale(scale: f64) -> Option<f64> {
    let rounded = two_digits(scale);
    (rounded.is_finite() && rounded > 0.0).then_some(rounded)
}

/// Rounds to two digits.
fn two_digits(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}
