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

    /// Receives the number of further bytes of the files that have been read.
    fn progress(&mut self, _bytes: u64) {}

    /// Returns, on other threads too, whether the comparison is still wanted.
    fn carry_on(&self) -> Box<dyn Fn() -> bool + Send + Sync> {
        Box::new(|| true)
    }
}

/// An observer that looks away.
impl Observer for () {}

/// An observer that ends the comparison once this returns false.
pub(super) struct While<'a>(pub(super) &'a (dyn Fn() -> bool + Sync));

impl Observer for While<'_> {
    fn message(&mut self, _: Side, _: &Message<'_>) -> Result<(), SinkError> {
        if self.0() {
            Ok(())
        } else {
            Err(SinkError::Viewer("interrupted".into()))
        }
    }
}
