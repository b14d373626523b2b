//! Why two runs can't be compared.

use crate::analysis::phrase::clock_time;
use crate::archive::sink::SinkError;
use thiserror::Error;

/// Why two runs can't be compared.
#[derive(Debug, Error)]
pub enum DiffError {
    /// A tolerance can't be understood.
    #[error("tolerance {text:?}: {reason}")]
    Tolerance {
        /// The tolerance as it was given.
        text: String,
        /// What is wrong with it.
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
    #[error("the topic {topic} can't be compared; topics that can: {common}")]
    UnknownTopic {
        /// The topic.
        topic: String,
        /// Topics that both have.
        common: String,
    },
    /// There is nothing to compare.
    #[error("they have no topic in common: A has {a}; B has {b}")]
    NoCommonTopics {
        /// A's topics.
        a: String,
        /// B's topics.
        b: String,
    },
    /// One run ends before the other begins.
    #[error("their times don't overlap: A is from {} to {}, B from {} to {}; --offset start puts their first messages at one \
             time, --align index pairs messages by their order",
            clock_time(a.0), clock_time(a.1), clock_time(b.0), clock_time(b.1))]
    NoOverlap {
        /// The times of A's first and last message, ns.
        a: (u64, u64),
        /// The times of B's first and last message, ns.
        b: (u64, u64),
    },
    /// No two messages can be compared.
    #[error(
        "they have no common times, and none that lie between two of the other; --max-dt 5ms pairs messages that are so \
             near to each other, --align index pairs them by their order"
    )]
    NoCommonTimes,
    /// Too many messages wait for their counterparts.
    #[error(
        "their messages are too far apart in the files to be paired in {megabytes} MiB of memory: compare fewer \
             topics, or put the files in the order of time"
    )]
    TooFarApart {
        /// The memory for messages that wait, MiB.
        megabytes: usize,
    },
    /// One of the runs is empty.
    #[error("{side} has no messages that can be read in the topics that both have: {topics}{}",
            if losses.is_empty() { String::new() } else { format!(" ({losses})") })]
    NoMessages {
        /// Which run, A or B.
        side: &'static str,
        /// The topics.
        topics: String,
        /// What could not be read.
        losses: String,
    },
    /// The alignment that was asked for is not possible.
    #[error("can't align by {by}: {reason}")]
    Align {
        /// The alignment.
        by: &'static str,
        /// Why not.
        reason: String,
    },
    /// An observer could not write what it was shown.
    #[error(transparent)]
    Sink(#[from] SinkError),
}
