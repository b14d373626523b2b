//! Observers of a comparison.

use crate::archive::sink::SinkError;
use crate::telemetry::Message;
use crate::telemetry::side::Side;

/// Receives the messages and differences during a comparison.
///
/// Only messages of the telemetry table are passed.
pub trait Observer {
    /// Called for each message of a run.
    ///
    /// # Errors
    /// [`SinkError`] ends the comparison.
    fn message(&mut self, _side: Side, _message: &Message<'_>) -> Result<(), SinkError> {
        Ok(())
    }

    /// Called with the difference B − A of each pair, at A's time.
    ///
    /// # Errors
    /// [`SinkError`] ends the comparison.
    fn difference(&mut self, _message: &Message<'_>) -> Result<(), SinkError> {
        Ok(())
    }

    /// Receives the number of further bytes of the files that have been read.
    fn progress(&mut self, _bytes: u64) {}

    /// Returns a thread-safe check whether to carry on; otherwise the comparison ends with an error.
    fn carry_on(&self) -> Box<dyn Fn() -> bool + Send + Sync> {
        Box::new(|| true)
    }
}

/// An observer that ignores everything.
impl Observer for () {}
