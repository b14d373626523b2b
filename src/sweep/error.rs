//! Errors of a sweep as a whole. Errors of rows are in the table.

use crate::archive::given::GivenError;
use crate::archive::sink::SinkError;
use crate::run::scenario::ScenarioError;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a sweep can't be started, or was not finished.
#[derive(Debug, Error)]
pub enum SweepError {
    /// The spec of the sweep is wrong.
    #[error("{0}")]
    Spec(String),
    /// A scenario that it starts from is wrong.
    #[error("{name}: {reason}")]
    Base {
        /// The preset or file.
        name: String,
        /// The reason.
        reason: ScenarioError,
    },
    /// A word names no scenario to start from.
    #[error(transparent)]
    Given(#[from] GivenError),
    /// A key that scenarios don't have.
    #[error(transparent)]
    Key(#[from] ScenarioError),
    /// The files belong to another sweep, or are damaged.
    #[error("{} {reason}", path.display())]
    Unusable {
        /// The table, a part or the directory of the parts.
        path: PathBuf,
        /// Why, and what can be done.
        reason: String,
    },
    /// A table can't be read.
    #[error("{}: {reason}", path.display())]
    Table {
        /// The table.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A row failed where none may.
    #[error("run {run}: {error}")]
    Row {
        /// The number of the row.
        run: u64,
        /// Why it failed.
        error: String,
    },
    /// The Parquet writer failed.
    #[error("cannot write Parquet: {0}")]
    Parquet(#[from] parquet::errors::ParquetError),
    /// The threads can't be started.
    #[error("cannot start threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// The file system refused.
    #[error("cannot {action} {}: {reason}", path.display())]
    Io {
        /// The attempted operation.
        action: &'static str,
        /// On what.
        path: PathBuf,
        /// Why, according to the system.
        reason: io::Error,
    },
    /// A file can't be published.
    #[error(transparent)]
    Sink(#[from] SinkError),
}

impl SweepError {
    /// The error for what is there and can't be used.
    pub(super) fn unusable(path: &Path, reason: impl Into<String>) -> Self {
        Self::Unusable {
            path: path.to_owned(),
            reason: reason.into(),
        }
    }

    /// Returns a function that makes an error of the reason why a table can't be read.
    pub(super) fn table<E: ToString>(path: &Path) -> impl Fn(E) -> Self {
        move |reason| Self::Table {
            path: path.to_owned(),
            reason: reason.to_string(),
        }
    }

    /// Returns a function that adds the attempted operation to an error of the file system.
    pub(super) fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |reason| Self::Io {
            action,
            path,
            reason,
        }
    }
}
