//! The reasons why two runs can't be compared.

use crate::archive::sink::SinkError;
use thiserror::Error;

/// The reason why two runs can't be compared.
#[derive(Debug, Error)]
pub enum DiffError {
    /// A tolerance can't be understood.
    #[error("tolerance {text:?}: {reason}")]
    Tolerance {
        /// The tolerance as it was written.
        text: String,
        /// The reason.
        reason: String,
    },
    /// A pattern matches no field.
    #[error("no field matches {pattern:?}; {}",
            if near.is_empty() { "there are no fields".to_owned() } else { format!("the nearest: {near}") })]
    UnknownField {
        /// The pattern.
        pattern: String,
        /// Fields with similar names.
        near: String,
    },
    /// A topic was asked for that not both runs have.
    #[error("the topic {topic} can't be compared; topics that both have: {common}")]
    UnknownTopic {
        /// The topic.
        topic: String,
        /// Topics that both have.
        common: String,
    },
    /// There is nothing to compare.
    #[error("they have no topic in common that is compared: A has {a}; B has {b}")]
    NoCommonTopics {
        /// A's topics.
        a: String,
        /// B's topics.
        b: String,
    },
    /// One of the runs is empty.
    #[error("{side} has no messages that can be read{}",
            if losses.is_empty() { String::new() } else { format!(" ({losses})") })]
    NoMessages {
        /// Which run, A or B.
        side: &'static str,
        /// Parts that could not be read.
        losses: String,
    },
    /// A run of toprise is compared with another file.
    #[error(
        "{side} is not a recording of toprise: only two such files, or two runs, can be compared"
    )]
    Mixed {
        /// Which one, A or B.
        side: &'static str,
    },
    /// An observer could not write what it was shown.
    #[error(transparent)]
    Sink(#[from] SinkError),
}
