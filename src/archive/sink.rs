//! Message sinks.

use crate::run::simulation::{Record, RunEnd, Simulation, SimulationError, StopReason};
use crate::telemetry::{Message, Telemetry, TelemetryError};
use std::ops::ControlFlow;
use std::path::PathBuf;
use thiserror::Error;

/// A destination for messages in time order.
pub trait Sink {
    /// Accepts a message. It may still be buffered when this returns.
    ///
    /// # Errors
    /// [`SinkError`] if this message or an earlier one could not be stored.
    fn write(&mut self, message: &Message<'_>) -> Result<(), SinkError>;

    /// Flushes buffered messages, e.g. to a viewer. Does not affect the bytes of a file.
    ///
    /// # Errors
    /// [`SinkError`] if an earlier message could not be stored.
    fn flush(&mut self) -> Result<(), SinkError>;
}

/// Error of a sink.
#[derive(Debug, Error)]
pub enum SinkError {
    /// The file exists and must not be overwritten.
    #[error("{} exists: {advice}", path.display())]
    Exists {
        /// The existing file.
        path: PathBuf,
        /// Advice.
        advice: String,
    },
    /// The file can't have this name.
    #[error("{path:?} {reason}")]
    Name {
        /// The name.
        path: PathBuf,
        /// The reason.
        reason: &'static str,
    },
    /// The file is also an input or another output.
    #[error("{} is also an input or another output: choose another file", path.display())]
    IsInUse {
        /// The file.
        path: PathBuf,
    },
    /// A file operation failed.
    #[error("cannot {action} {}: {reason}", path.display())]
    Io {
        /// The attempted operation.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// The system error.
        reason: std::io::Error,
    },
    /// The MCAP writer failed.
    #[error("cannot write {}: {}", path.display(), with_causes(reason))]
    Mcap {
        /// The file.
        path: PathBuf,
        /// The reason reported by the writer.
        reason: ::mcap::McapError,
    },
    /// A viewer, or the file of one, failed.
    #[error(transparent)]
    Viewer(Box<dyn std::error::Error + Send + Sync>),
    /// A writer thread panicked.
    #[error("the writer thread of {} panicked", path.display())]
    WriterDied {
        /// The file.
        path: PathBuf,
    },
}

/// The reason why a run could not be recorded to its end.
#[derive(Debug, Error)]
pub enum RecordError {
    /// The motion could not be computed further.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A quantity could not be logged.
    #[error(transparent)]
    Telemetry(#[from] TelemetryError),
    /// A sink failed.
    #[error(transparent)]
    Sink(#[from] SinkError),
}

/// Runs a simulation and writes every message to all sinks.
///
/// `between` is called after each record, and can flush the sinks, wait, or cancel the run.
///
/// # Errors
/// The first error of the simulation, the telemetry or a sink.
pub fn record(
    simulation: &mut Simulation,
    telemetry: &mut Telemetry,
    sinks: &mut [&mut dyn Sink],
    mut between: impl FnMut(&Record, &mut [&mut dyn Sink]) -> Result<ControlFlow<()>, SinkError>,
) -> Result<RunEnd, RecordError> {
    for record in simulation.by_ref() {
        let record = record?;
        telemetry.messages(&record, |message| {
            for sink in &mut *sinks {
                sink.write(message)?;
            }
            Ok::<(), RecordError>(())
        })?;
        if between(&record, sinks)?.is_break() {
            break;
        }
    }
    Ok(simulation.end())
}

/// Like [`record`], but a simulation error is returned together with the end of the run up to that point.
///
/// # Errors
/// The first error of a sink.
pub fn record_to_end(
    simulation: &mut Simulation,
    telemetry: &mut Telemetry,
    sinks: &mut [&mut dyn Sink],
    between: impl FnMut(&Record, &mut [&mut dyn Sink]) -> Result<ControlFlow<()>, SinkError>,
) -> Result<(RunEnd, Option<RecordError>), SinkError> {
    match record(simulation, telemetry, sinks, between) {
        Ok(end) => Ok((end, None)),
        Err(RecordError::Sink(error)) => Err(error),
        Err(error) => {
            let stop = StopReason::Failed;
            let end = simulation.end();
            Ok((RunEnd { stop, ..end }, Some(error)))
        }
    }
}

/// An error with its chain of causes: `McapError` does not display its source.
fn with_causes(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        text.push_str(&format!(": {error}"));
        cause = error.source();
    }
    text
}
