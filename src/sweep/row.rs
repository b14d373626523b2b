//! Computes one row of a sweep.

use super::caught::catch;
use crate::run::outcome::Outcome;
use crate::run::scenario::{Scenario, ScenarioError};
use crate::run::simulation::{SimulationError, StopReason};

/// Result of a run.
pub type RunResult = Result<Outcome, SimulationError>;

/// Function that computes an outcome (replaceable in tests).
pub type Run = fn(&Scenario, &mut dyn FnMut() -> bool) -> RunResult;

/// Callbacks of a sweep, called from several threads.
pub struct Watch<'a> {
    /// Cancellation check, called before each step.
    pub carry_on: &'a (dyn Fn() -> bool + Sync),
    /// Called after each row with the reason why its run stopped; `None` for a failed row.
    pub done: &'a (dyn Fn(Option<StopReason>) + Sync),
}

/// Result of a row.
pub(super) struct Row {
    /// Digest of the scenario; `None` if it is invalid.
    pub(super) digest: Option<String>,
    /// The outcome or an error text.
    pub(super) result: Result<Outcome, String>,
}

/// Computes a row; panics become errors. `None` if cancelled.
pub(super) fn row(
    scenario: Result<Scenario, ScenarioError>,
    most_steps: Option<u64>,
    run: Run,
    watch: &Watch<'_>,
) -> Option<Row> {
    let (digest, scenario) = match scenario {
        Ok(scenario) => (Some(scenario.digest()), scenario),
        Err(error) => {
            let (digest, result) = (None, Err(error.to_string()));
            return Some(Row { digest, result });
        }
    };
    let mut steps = 0;
    let mut is_over_budget = false;
    let mut carry_on = || {
        steps += 1;
        is_over_budget = most_steps.is_some_and(|most| steps > most);
        !is_over_budget && (watch.carry_on)()
    };
    let result = match catch(|| run(&scenario, &mut carry_on)) {
        Err(panic) => Err(format!("panic: {panic}")),
        Ok(Err(error)) => Err(error.to_string()),
        Ok(Ok(outcome)) if outcome.end.stop == StopReason::Interrupted => {
            if !is_over_budget {
                return None;
            }
            let most = most_steps.unwrap_or_default();
            Err(format!("not finished within {most} steps"))
        }
        Ok(Ok(outcome)) => Ok(outcome),
    };
    Some(Row { digest, result })
}
