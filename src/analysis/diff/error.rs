//! Errors of comparisons.

use crate::archive::sink::SinkError;
use thiserror::Error;

/// The reason why two runs can't be compared.
#[derive(Debug, Error)]
pub enum DiffError {
    /// An invalid tolerance.
    #[error("tolerance {text:?}: {reason}")]
    Tolerance {
        /// The tolerance argument.
        text: String,
        /// The reason.
        reason: String,
    },
    /// A pattern matches no field.
    #[error("no field matches {pattern:?}; {}",
            if near.is_empty() { "there are no fields".to_owned() } else { format!("did you mean {near}?") })]
    UnknownField {
        /// The pattern.
        pattern: String,
        /// Fields with similar names.
        near: String,
    },
    /// A requested topic is missing in one of the runs.
    #[error("topic {topic} can't be compared; common topics: {common}")]
    UnknownTopic {
        /// The topic.
        topic: String,
        /// Topics that both have.
        common: String,
    },
    /// There is nothing to compare.
    #[error("no common topics to compare: A has {a}; B has {b}")]
    NoCommonTopics {
        /// A's topics.
        a: String,
        /// B's topics.
        b: String,
    },
    /// One of the runs is empty.
    #[error("{side} has no readable messages{}",
            if losses.is_empty() { String::new() } else { format!(" ({losses})") })]
    NoMessages {
        /// The run, A or B.
        side: &'static str,
        /// Parts that could not be read.
        losses: String,
    },
    /// A run of toprise is compared with another file.
    #[error("{side} is not a toprise recording; it can only be compared with another MCAP file")]
    Mixed {
        /// The run, A or B.
        side: &'static str,
    },
    /// An observer could not write a message or difference.
    #[error(transparent)]
    Sink(#[from] SinkError),
}
