//! Errors of reading files and messages.

use crate::run::time::seconds;
use crate::telemetry::encoding::DecodeError;
use std::io;
use thiserror::Error;

/// The reason why a file, or its scenario, can't be read at all.
#[derive(Debug, Error)]
pub enum RecordingError {
    /// An I/O error.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// Not an MCAP file, an ambiguous one, or one without a usable scenario.
    #[error("{0}")]
    Unusable(String),
}

impl RecordingError {
    /// The error for this reason.
    pub(super) fn because(reason: impl Into<String>) -> Self {
        Self::Unusable(reason.into())
    }
}

/// The reason why a message can't be decoded.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{topic} message {sequence} at {} s: {reason}", seconds(*time_ns))]
pub struct MessageError {
    /// Its topic.
    pub topic: &'static str,
    /// Its sequence number.
    pub sequence: u32,
    /// Its time, ns.
    pub time_ns: u64,
    /// The reason.
    pub reason: DecodeError,
}
