//! Errors of comparisons.

use crate::archive::sink::SinkError;
use thiserror::Error;

/// The reason why two runs can't be compared.
#[derive(Debug, Error)]
pub enum DiffError {
    /// The runs can't be compared, or the options don't apply to them.
    #[error("{0}")]
    Refused(String),
    /// An observer could not write a message or difference.
    #[error(transparent)]
    Sink(#[from] SinkError),
}
