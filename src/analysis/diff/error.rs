//! Errors of comparisons.

use crate::archive::sink::SinkError;
use thiserror::Error;

/// The reason why two runs can't be compared.
#[derive(Debug, Error)]
pub enum DiffError {
    /// The runs can't be compared, or the options don't apply to them.
    #[error("{0}")]
    Refused(String),
    /// Tolerances were set for files without toprise's fields.
    #[error(
        "tolerances apply to the fields of toprise's recordings; messages of other software are compared byte by byte"
    )]
    TolerancesNeedFields,
    /// The readable parts of two runs have no message of the same time.
    #[error(
        "nothing can be compared: the readable parts of A and B have no message of the same time"
    )]
    NothingInCommon,
    /// An observer could not write a message or difference.
    #[error(transparent)]
    Sink(#[from] SinkError),
}
