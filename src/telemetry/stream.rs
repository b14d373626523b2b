//! The way out of a run: simulates it and yields its messages.

use super::logging::{Telemetry, TelemetryError};
use super::message::Message;
use super::topic::Topics;
use crate::run::outcome::Outcome;
use crate::run::scenario::Scenario;
use crate::run::simulation::{Record, RunEnd, Simulation, SimulationError, StopReason};
use thiserror::Error;

/// The reason why a run has no further messages.
#[derive(Debug, Error)]
pub enum RunError {
    /// The motion could not be computed further.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A quantity could not be recorded.
    #[error(transparent)]
    Telemetry(#[from] TelemetryError),
}

/// A run that is simulated and turned into messages, record by record.
///
/// Everything that is recorded, shown, analysed or verified comes from here, so it is the same to the last bit.
pub struct RunMessages {
    scenario: Scenario,
    simulation: Simulation,
    telemetry: Telemetry,
    has_failed: bool,
}

impl RunMessages {
    /// Starts the run of `scenario` with some topics.
    ///
    /// # Errors
    /// As [`Simulation::new`].
    pub fn new(scenario: &Scenario, topics: &Topics) -> Result<Self, SimulationError> {
        Ok(Self {
            scenario: scenario.clone(),
            simulation: Simulation::new(scenario)?,
            telemetry: Telemetry::with_topics(topics),
            has_failed: false,
        })
    }

    /// As [`Simulation::continue_while`].
    pub fn continue_while(mut self, carry_on: impl FnMut() -> bool + 'static) -> Self {
        self.simulation = self.simulation.continue_while(carry_on);
        self
    }

    /// The topics that are produced.
    pub fn telemetry(&self) -> &Telemetry {
        &self.telemetry
    }

    /// Simulates the next record and passes its messages to `take`; `None` at the end of the run, and after an error.
    ///
    /// # Errors
    /// [`RunError`], or the first error of `take`.
    pub fn next<E: From<RunError>>(
        &mut self,
        mut take: impl FnMut(&Message<'_>) -> Result<(), E>,
    ) -> Option<Result<Record, E>> {
        if self.has_failed {
            return None;
        }
        let record = match self.simulation.next()? {
            Ok(record) => record,
            Err(error) => {
                self.has_failed = true;
                return Some(Err(RunError::Simulation(error).into()));
            }
        };
        let taken = self
            .telemetry
            .messages(&record, |message| take(message).map_err(TakeError::Taker));
        // Either error ends the run: messages of this record are missing, and what follows would not show it.
        self.has_failed = taken.is_err();
        Some(match taken {
            Ok(()) => Ok(record),
            Err(TakeError::Telemetry(error)) => Err(RunError::Telemetry(error).into()),
            Err(TakeError::Taker(error)) => Err(error),
        })
    }

    /// The state of the run at its last record. A run that an error ended has failed.
    pub fn end(&self) -> RunEnd {
        let end = self.simulation.end();
        if self.has_failed {
            let stop = StopReason::Failed;
            return RunEnd { stop, ..end };
        }
        end
    }

    /// The outcome of the run up to its last record.
    pub fn outcome(&self) -> Outcome {
        Outcome::new(&self.scenario, self.end(), self.simulation.tally().clone())
    }
}

/// The reason why the messages of a record were not all taken.
enum TakeError<E> {
    Telemetry(TelemetryError),
    Taker(E),
}

impl<E> From<TelemetryError> for TakeError<E> {
    fn from(error: TelemetryError) -> Self {
        Self::Telemetry(error)
    }
}
