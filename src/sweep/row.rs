//! Computes one row of a sweep.

use crate::archive::caught::{Panic, catch};
use crate::run::outcome::Outcome;
use crate::run::scenario::{Scenario, ScenarioError};
use crate::run::simulation::{SimulationError, StopReason};
use thiserror::Error;

/// Result of a run.
pub type RunResult = Result<Outcome, SimulationError>;

/// Function that computes an outcome (replaceable in tests).
pub type Run = fn(&Scenario, &mut dyn FnMut() -> bool) -> RunResult;

/// Callbacks of a sweep, called from several threads.
pub struct Watch<'a> {
    /// Cancellation check, called before each step.
    pub carry_on: &'a (dyn Fn() -> bool + Sync),
    /// Called after each row with the reason why its run stopped; `None` for a failed row.
    pub row_done: &'a (dyn Fn(Option<StopReason>) + Sync),
}

/// Why a row has no outcome.
#[derive(Debug, Error)]
pub(super) enum RowFailure {
    /// The scenario is invalid.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The motion can't be computed.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A mistake in this program.
    #[error(transparent)]
    Panic(#[from] Panic),
    /// The run takes more steps than the sweep allows.
    #[error("not finished within {0} steps")]
    TooManySteps(u64),
}

/// Result of a row.
pub(super) struct RowResult {
    /// Digest of the scenario; `None` if it is invalid.
    pub(super) digest: Option<String>,
    /// The outcome, if there is one.
    pub(super) result: Result<Outcome, RowFailure>,
}

/// Computes a row; panics become errors. `None` if cancelled.
pub(super) fn row(
    scenario: Result<Scenario, ScenarioError>,
    max_steps: Option<u64>,
    run: Run,
    watch: &Watch<'_>,
) -> Option<RowResult> {
    let scenario = match scenario {
        Ok(scenario) => scenario,
        Err(error) => {
            return Some(RowResult {
                digest: None,
                result: Err(error.into()),
            });
        }
    };
    let mut steps = 0;
    // The step limit, once it is exceeded.
    let mut exceeded = None;
    let caught = catch(|| {
        run(&scenario, &mut || {
            steps += 1;
            exceeded = max_steps.filter(|max| steps > *max);
            exceeded.is_none() && (watch.carry_on)()
        })
    });
    let result = match caught {
        Err(panic) => Err(panic.into()),
        Ok(Err(error)) => Err(error.into()),
        Ok(Ok(outcome)) if outcome.end.stop == StopReason::Interrupted => {
            // Unless the limit is exceeded, the caller has cancelled the whole sweep, and this row has no result.
            Err(RowFailure::TooManySteps(exceeded?))
        }
        Ok(Ok(outcome)) => Ok(outcome),
    };
    Some(RowResult {
        digest: Some(scenario.digest()),
        result,
    })
}
