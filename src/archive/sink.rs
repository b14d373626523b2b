//! Message sinks.

use crate::run::outcome::Outcome;
use crate::run::simulation::Record;
use crate::telemetry::{Message, RunError, RunMessages};
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

/// A run after it was recorded.
#[derive(Debug)]
pub struct RecordedRun {
    /// The outcome up to the last record.
    pub outcome: Outcome,
    /// The reason why the run could not be recorded to its end; what was recorded is valid.
    pub error: Option<RunError>,
}

/// Simulates a run and writes every message to all sinks, also if the motion can't be computed to its end.
///
/// `between` is called after each record, and can flush the sinks, wait, or cancel the run.
///
/// # Errors
/// The first error of a sink.
pub fn record(
    run: &mut RunMessages,
    sinks: &mut [&mut dyn Sink],
    mut between: impl FnMut(&Record, &mut [&mut dyn Sink]) -> Result<ControlFlow<()>, SinkError>,
) -> Result<RecordedRun, SinkError> {
    let mut error = None;
    loop {
        let next = run.next(|message| {
            for sink in &mut *sinks {
                sink.write(message)?;
            }
            Ok::<(), Unrecorded>(())
        });
        match next {
            Some(Ok(record)) if between(&record, sinks)?.is_continue() => {}
            Some(Ok(_)) | None => break,
            Some(Err(Unrecorded::Run(reason))) => error = Some(reason),
            Some(Err(Unrecorded::Sink(error))) => return Err(error),
        }
    }
    let outcome = run.outcome();
    Ok(RecordedRun { outcome, error })
}

/// Like [`record`], to the end of the run.
///
/// # Errors
/// The first error of a sink.
pub fn record_all(
    run: &mut RunMessages,
    sinks: &mut [&mut dyn Sink],
) -> Result<RecordedRun, SinkError> {
    record(run, sinks, |_, _| Ok(ControlFlow::Continue(())))
}

/// The reason why a message was not recorded.
enum Unrecorded {
    Run(RunError),
    Sink(SinkError),
}

impl From<RunError> for Unrecorded {
    fn from(error: RunError) -> Self {
        Self::Run(error)
    }
}

impl From<SinkError> for Unrecorded {
    fn from(error: SinkError) -> Self {
        Self::Sink(error)
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
