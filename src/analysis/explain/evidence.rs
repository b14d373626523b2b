//! Input data of an explanation.

use super::observations::Observations;
use crate::analysis::history::{Event, Interval, RunHistory, RunSummary};
use crate::archive::format::STEPS;
use crate::run::scenario::Scenario;
use crate::run::simulation::EventKind;
use std::ops::Range;

/// Steps that the integrator takes per nutation, if the end record doesn't state them.
const STEPS_PER_NUTATION: f64 = 30.0;

/// Relative size beyond which a change is never taken for an integration error, however loose the tolerances. What the
/// equations keep constant is called so only if it varies by less.
pub(super) const ROUNDED: f64 = 1e-6;

/// The deviations of a quantity, relative, that show whether it is constant as the equations say.
pub(super) fn known_deviations(is_constant: bool) -> Range<f64> {
    if is_constant {
        0.0..ROUNDED
    } else {
        16.0 * f64::EPSILON..f64::INFINITY
    }
}

/// The data of an explanation.
pub(super) struct Evidence {
    pub(super) scenario: Scenario,
    pub(super) history: RunHistory,
    pub(super) observations: Observations,
    pub(super) summary: RunSummary,
    /// Phases of a free peg, in the order of time; empty if they are not known.
    pub(super) peg_intervals: Vec<Interval>,
    /// Parts that could not be read.
    pub(super) losses: Vec<String>,
}

impl Evidence {
    /// Mean θ in the first and the last nutation, rad; `None` if there are fewer than two.
    pub(super) fn mean_theta(&self) -> Option<[f64; 2]> {
        let [first, .., last] = &self.history.cycles[..] else {
            return None;
        };
        Some([first.means[0], last.means[0]])
    }

    /// The fall: the axis passes its level from above, where it also starts.
    pub(super) fn fall(&self) -> Option<&Event> {
        let start = self.scenario.angles.theta;
        self.history
            .first(EventKind::Fallen)
            .filter(|event| event.state.theta > start)
    }

    /// Whether the change from one inclination to another, rad, is not larger than the integration error.
    pub(super) fn is_constant_theta(&self, [first, last]: [f64; 2]) -> bool {
        (last - first).abs() <= self.integration_error(first.abs().max(last.abs()))
    }

    /// Accumulated integration error at the end of the run in a quantity of this size; an upper estimate.
    pub(super) fn integration_error(&self, size: f64) -> f64 {
        let steps = self
            .history
            .end_entry(STEPS)
            .and_then(|steps| steps.parse().ok());
        // The end record is missing if the run or its recording was cut off.
        let nutations = self.history.cycles.len() as f64;
        let steps: f64 = steps.unwrap_or(STEPS_PER_NUTATION * (nutations + 1.0));
        let tolerances = &self.scenario.tolerances;
        // Even a run of a few steps has rounding errors.
        let errors = steps.max(10.0) * (tolerances.absolute + tolerances.relative * size.abs());
        errors.min(ROUNDED * size.abs())
    }
}
