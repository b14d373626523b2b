//! Watching a comparison.

use crate::archive::sink::SinkError;
use crate::telemetry::Message;
use crate::telemetry::side::Side;

/// Sees the messages of two runs, and their differences, while they are compared.
///
/// Only messages of the telemetry table are shown.
pub trait Observer {
    /// Sees a message of one run.
    ///
    /// # Errors
    /// [`SinkError`] ends the comparison.
    fn message(&mut self, _side: Side, _message: &Message<'_>) -> Result<(), SinkError> {
        Ok(())
    }

    /// Sees B − A of a pair of messages, at A's time.
    ///
    /// # Errors
    /// [`SinkError`] ends the comparison.
    fn difference(&mut self, _message: &Message<'_>) -> Result<(), SinkError> {
        Ok(())
    }

    /// Is told how many more bytes of the files have been read.
    fn progress(&mut self, _bytes: u64) {}
}

/// An observer that looks away.
impl Observer for () {}
