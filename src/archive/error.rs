//! Errors of reading files, messages and scenarios.

use crate::run::scenario::ScenarioError;
use crate::telemetry::encoding::DecodeError;
use std::io;
use thiserror::Error;

/// The reason why a file can't be read at all.
#[derive(Debug, Error)]
pub enum RecordingError {
    /// An I/O error.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// A directory.
    #[error("it is a directory, not an MCAP file")]
    Directory,
    /// A device or pipe; recordings need random access.
    #[error("it is a pipe or device, not an MCAP file")]
    NoFile,
    /// An empty file.
    #[error("the file is empty")]
    Empty,
    /// Not an MCAP file.
    #[error("not an MCAP file (wrong magic bytes)")]
    NotMcap,
    /// A topic of the table has two channels.
    #[error("it has two channels named {0}, which is ambiguous")]
    TwoChannels(String),
    /// A recording without a scenario.
    #[error(transparent)]
    NoScenario(#[from] NoScenario),
}

/// The reason why a message can't be decoded.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{topic} message {sequence} at {} s: {reason}", *time_ns as f64 / 1e9)]
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

/// Error of reading the scenario of a recording.
#[derive(Debug, Error)]
pub enum NoScenario {
    /// The file has no attachment with a scenario.
    #[error("it has no scenario attached")]
    Missing,
    /// The attachment is damaged.
    #[error("its scenario is damaged: {0}")]
    Damaged(String),
    /// This version can't read it.
    #[error("its scenario can't be used: {0}")]
    Unusable(#[from] ScenarioError),
}
