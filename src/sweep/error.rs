//! What can go wrong with a sweep as a whole. What goes wrong with a row stands in the table.

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
        /// What is wrong.
        reason: ScenarioError,
    },
    /// A word names no scenario to start from.
    #[error(transparent)]
    Given(#[from] GivenError),
    /// A key that scenarios don't have.
    #[error(transparent)]
    Key(#[from] ScenarioError),
    /// What is there belongs to another sweep.
    #[error(
        "{} is of another sweep: {change}; choose another name, or remove it",
        path.display()
    )]
    Changed {
        /// The table, or a directory beside it.
        path: PathBuf,
        /// What differs.
        change: String,
    },
    /// What says to which sweep something belongs is damaged.
    #[error(
        "{} doesn't say of which sweep it is, because that is damaged: choose another name, or remove it",
        path.display()
    )]
    Unreadable {
        /// The table, or a directory beside it.
        path: PathBuf,
    },
    /// A file that is there is not the table of a sweep.
    #[error("{} exists and is not the table of a sweep: choose another name", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// What has the table's name is no file.
    #[error("{} is a pipe or a device: a table is written to a file; choose another name", path.display())]
    NoFile {
        /// The pipe or device.
        path: PathBuf,
    },
    /// A part can't be merged.
    #[error("{} can't be merged: {reason}; remove it and sweep again", path.display())]
    BadPart {
        /// The part.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A file that has the name of a run's recording is something else.
    #[error(
        "{} is not the whole recording of run {run}: {reason}; remove it and sweep again",
        path.display()
    )]
    BadRecording {
        /// The file.
        path: PathBuf,
        /// The number of the row.
        run: u64,
        /// What is wrong with it.
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
        /// What was tried.
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
    /// The error of a row.
    pub(super) fn row(run: u64, error: &dyn std::error::Error) -> Self {
        let error = error.to_string();
        Self::Row { run, error }
    }

    /// What turns an error of the file system into one that says what was tried.
    pub(super) fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |reason| Self::Io {
            action,
            path,
            reason,
        }
    }
}
