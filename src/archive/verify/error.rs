//! Errors of verification.

use super::difference::Difference;
use std::io;
use thiserror::Error;

/// The reason why a file can't be verified.
#[derive(Debug, Error)]
pub enum VerifyError {
    /// The file has no scenario: it is not a recording of toprise, or was cut off before it.
    #[error("there is no scenario in it")]
    NoScenario,
    /// Reading the file through its index takes too much memory.
    #[error(
        "its chunks overlap in time so much that reading it in order of time takes {needed} MiB of memory (limit {limit} MiB); sort it by log time first, e.g. with `mcap sort`"
    )]
    Overlap {
        /// Size of all chunks that are needed at the same time, MiB.
        needed: u64,
        /// The limit, MiB.
        limit: u64,
    },
    /// An I/O error.
    #[error(transparent)]
    Io(#[from] io::Error),
}

/// The reason why an index is not accepted.
#[derive(Debug)]
pub(super) enum IndexFault {
    /// It contradicts the data.
    Contradiction(Difference),
    /// An I/O error.
    Io(io::Error),
}

impl From<Difference> for IndexFault {
    fn from(difference: Difference) -> Self {
        Self::Contradiction(difference)
    }
}

impl From<io::Error> for IndexFault {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}
