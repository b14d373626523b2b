//! Checks the messages of a recording whose file may be intact: other software can cut, filter or change them.
//!
//! Everything that reads a recording reports these faults, in the same words.

use super::missing::{Excess, MessageCounts, Missing};
use crate::archive::error::MessageError;
use crate::archive::format::Entries;
use crate::telemetry::{Message, Topic};
use crate::words::counted;
use std::fmt;

/// Messages that can't be decoded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Undecodable {
    /// The error of the first.
    pub first: MessageError,
    /// Number of messages.
    pub count: u64,
}

impl fmt::Display for Undecodable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { first, count } = self;
        let which = if *count > 1 { ", the first" } else { "" };
        let messages = counted(*count, "message");
        write!(f, "{messages} can't be decoded{which}: {first}")
    }
}

/// The messages of a recording that have been read.
#[derive(Debug, Default)]
pub(crate) struct ContentCheck {
    counts: MessageCounts,
    undecodable: Option<Undecodable>,
}

/// Faults of the messages of a recording.
#[derive(Debug, Default)]
pub(crate) struct ContentFaults {
    pub(crate) undecodable: Option<Undecodable>,
    /// Messages that the run has according to its end record, but the recording lacks.
    pub(crate) missing: Vec<Missing>,
    pub(crate) excess: Option<Excess>,
}

impl ContentCheck {
    /// Takes a message that was read, or the reason why it can't be decoded.
    pub(crate) fn take(&mut self, message: &Result<Message<'_>, MessageError>) {
        let error = match message {
            Ok(message) => return self.counts.take(message),
            Err(error) => error,
        };
        if let Some(topic) = Topic::find(error.topic) {
            self.counts.take_undecodable(topic);
        }
        match &mut self.undecodable {
            // A damaged file may have millions: the first is enough.
            Some(undecodable) => undecodable.count += 1,
            none => {
                *none = Some(Undecodable {
                    first: error.clone(),
                    count: 1,
                });
            }
        }
    }

    /// The faults, once all messages of the topics have been read. Without an end record no numbers are known.
    pub(crate) fn finish(self, topics: &[Topic], end: Option<&Entries>) -> ContentFaults {
        let Self {
            counts,
            undecodable,
        } = self;
        ContentFaults {
            undecodable,
            missing: end.map_or_else(Vec::new, |end| counts.missing(topics, end)),
            excess: end.and_then(|end| counts.excess(topics, end)),
        }
    }
}

impl ContentFaults {
    /// The faults in sentences. Wrong numbers of messages are left out where damage explains them.
    pub(crate) fn sentences(&self, is_damaged: bool) -> Vec<String> {
        let mut sentences = Vec::new();
        sentences.extend(self.undecodable.as_ref().map(ToString::to_string));
        if !is_damaged {
            sentences.extend(self.missing.iter().map(|part| format!("missing {part}")));
            sentences.extend(self.excess.as_ref().map(ToString::to_string));
        }
        sentences
    }
}
