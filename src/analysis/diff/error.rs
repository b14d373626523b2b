//! Errors of comparisons.

use crate::archive::sink::SinkError;
use crate::telemetry::fields::state::THETA;
use crate::telemetry::side::Side;
use thiserror::Error;

/// Error in a tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum ToleranceProblem {
    /// There is no `=`, or no pattern before it.
    #[error("must be PATTERN=VALUE, e.g. {THETA}=1e-9")]
    NoPattern,
    /// The value is not one number, or two with their kinds.
    #[error("the value must be NUMBER, abs:NUMBER, rel:NUMBER or abs:NUMBER,rel:NUMBER")]
    Bounds,
    /// A bound is negative, infinite or NaN.
    #[error("must be finite and not negative")]
    OutOfRange,
}

/// The reason why two runs can't be compared.
#[derive(Debug, Error)]
pub enum DiffError {
    /// A tolerance can't be read.
    #[error("tolerance {text:?}: {problem}")]
    Tolerance {
        /// The tolerance.
        text: String,
        /// The error in it.
        problem: ToleranceProblem,
    },
    /// A pattern of a tolerance or of an ignored field matches nothing.
    #[error("no field matches {pattern:?}; {}", hint(similar))]
    NoField {
        /// The pattern.
        pattern: String,
        /// The names most like it.
        similar: Vec<String>,
    },
    /// A run has no message that can be read, although the other has.
    #[error("{} has no readable messages{}", side.name(), in_brackets(losses))]
    NoReadableMessages {
        /// The run.
        side: Side,
        /// The unreadable parts.
        losses: Vec<String>,
    },
    /// The files have no topic in common.
    #[error("no common topics to compare: A has {}; B has {}", list(&topics[0]), list(&topics[1]))]
    NoCommonTopics {
        /// The topics of A and B.
        topics: [Vec<String>; 2],
    },
    /// A topic that was named is not in both runs.
    #[error("topic {topic} can't be compared; common topics: {}", common.join(", "))]
    TopicNotCommon {
        /// The topic.
        topic: String,
        /// The topics that both runs have.
        common: Vec<String>,
    },
    /// A file of other software is compared with a scenario.
    #[error("{} is not a toprise recording; it can only be compared with another MCAP file", side.name())]
    OnlyWithFile {
        /// The file of other software.
        side: Side,
    },
    /// The comparison was interrupted.
    #[error("interrupted")]
    Interrupted,
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
    /// All topics are ignored.
    #[error("nothing can be compared: all topics are ignored")]
    AllIgnored,
    /// An observer could not write a message or difference.
    #[error(transparent)]
    Sink(#[from] SinkError),
}

fn hint(similar: &[String]) -> String {
    if similar.is_empty() {
        "there are no fields".to_owned()
    } else {
        format!("did you mean {}?", similar.join(", "))
    }
}

fn in_brackets(losses: &[String]) -> String {
    if losses.is_empty() {
        String::new()
    } else {
        format!(" ({})", losses.join("; "))
    }
}

fn list(topics: &[String]) -> String {
    if topics.is_empty() {
        "none".to_owned()
    } else {
        topics.join(", ")
    }
}
