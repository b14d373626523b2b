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
    /// Neither run has a message.
    #[error("nothing can be compared: neither run has a message in the topics that are compared")]
    NoMessages,
    /// The samples of two recordings have few times in common, and B can't be sampled anew.
    #[error(
        "the sampling periods of A ({} s) and B ({} s) are no multiples of each other, and B can't be simulated with A's \
         period because it does not have exactly what its scenario gives: `toprise verify` shows how it differs",
        periods[0], periods[1]
    )]
    NotReproduced {
        /// The sampling periods of A and B, s.
        periods: [f64; 2],
    },
    /// All topics are ignored.
    #[error("nothing can be compared: all topics are ignored")]
    AllIgnored,
    /// An observer could not write a message or difference.
    #[error(transparent)]
    Sink(#[from] SinkError),
}
