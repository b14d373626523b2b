//! Errors of reading files and messages.

use crate::run::scenario::ScenarioError;
use crate::run::time::seconds;
use crate::telemetry::Topic;
use crate::telemetry::encoding::DecodeError;
use std::io;
use std::string::FromUtf8Error;
use thiserror::Error;

/// The reason why a file, or its scenario, can't be read at all.
#[derive(Debug, Error)]
pub enum RecordingError {
    /// An I/O error.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The path is a directory.
    #[error("it is a directory, not an MCAP file")]
    Directory,
    /// The file has no bytes.
    #[error("the file is empty")]
    Empty,
    /// The file does not begin as an MCAP file.
    #[error("not an MCAP file (wrong magic bytes)")]
    NotMcap,
    /// Two channels of a topic of the table have different encodings or schemas.
    #[error("it has channels named {0} with different encodings or schemas, which is ambiguous")]
    AmbiguousTopic(Topic),
    /// Several recordings were merged into one file.
    #[error(
        "it holds {0} runs that were merged into one file; their messages can't be told apart, so use the original files"
    )]
    MergedRuns(usize),
    /// No scenario is attached.
    #[error("it has no scenario attached")]
    NoScenario,
    /// The scenario's checksum is wrong.
    #[error("its scenario is damaged: its checksum is wrong")]
    DamagedScenario,
    /// The scenario is larger than this number of bytes.
    #[error("its scenario is damaged: it is longer than {0} bytes")]
    LargeScenario(u64),
    /// The scenario is not UTF-8.
    #[error("its scenario is damaged: {0}")]
    ScenarioText(#[source] FromUtf8Error),
    /// The scenario is not one that this version can run.
    #[error("its scenario can't be used: {0}")]
    UnusableScenario(#[source] ScenarioError),
}

/// The reason why a message can't be decoded.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{topic} message {sequence} at {} s: {reason}", seconds(*time_ns))]
pub struct MessageError {
    /// The topic.
    pub topic: &'static str,
    /// The sequence number.
    pub sequence: u32,
    /// The log time, ns.
    pub time_ns: u64,
    /// The reason.
    pub reason: DecodeError,
}
