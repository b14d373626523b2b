//! Errors of a sweep as a whole. Errors of rows are in the table.

use super::counts::RowError;
use crate::archive::input::InputError;
use crate::archive::sink::SinkError;
use crate::run::scenario::ScenarioError;
use std::io;
use std::path::Path;
use thiserror::Error;

/// Error of a sweep.
#[derive(Debug, Error)]
pub enum SweepError {
    /// The spec of the sweep is wrong.
    #[error("{0}")]
    Spec(String),
    /// A key that scenarios don't have, or a scenario to start from with a value that it can't have.
    #[error("{0}")]
    Scenario(String),
    /// Base scenario not found.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A table, a part or the directory of parts belongs to another sweep, is damaged, or can't be read as a table.
    #[error("{0}")]
    File(String),
    /// A row failed (with `fail_fast`).
    #[error("run {}: {}", .0.run, .0.error)]
    Row(RowError),
    /// The Parquet writer failed.
    #[error("cannot write Parquet: {0}")]
    Parquet(#[from] parquet::errors::ParquetError),
    /// The threads can't be started.
    #[error("cannot start threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A file can't be read or published.
    #[error(transparent)]
    Sink(#[from] SinkError),
}

impl From<ScenarioError> for SweepError {
    fn from(error: ScenarioError) -> Self {
        Self::Scenario(error.to_string())
    }
}

impl SweepError {
    /// An error for an existing file or directory that can't be used.
    pub(super) fn unusable(path: &Path, reason: impl AsRef<str>) -> Self {
        Self::File(format!("{} {}", path.display(), reason.as_ref()))
    }

    /// A conversion of reasons why a table can't be read into errors.
    pub(super) fn table<E: ToString>(path: &Path) -> impl Fn(E) -> Self {
        move |reason| Self::File(format!("{}: {}", path.display(), reason.to_string()))
    }

    /// A conversion of errors of the file system into errors with the operation and the path.
    pub(super) fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |reason| {
            Self::Sink(SinkError::Io {
                action,
                path,
                reason,
            })
        }
    }
}
