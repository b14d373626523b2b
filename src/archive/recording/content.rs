//! Checks the messages of a recording whose file may be intact: other software can cut, filter or change them.
//!
//! Everything that reads a recording reports these faults, in the same words.

use super::contradiction::Contradiction;
use super::digest::DigestCheck;
use super::file::Recording;
use super::missing::{Excess, MessageCounts, Missing};
use crate::archive::error::MessageError;
use crate::archive::format::Entries;
use crate::telemetry::{Message, Topic, Topics};
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
#[derive(Debug)]
pub(crate) struct ContentCheck {
    /// The topics that are read and that the recording should have.
    topics: Vec<Topic>,
    counts: MessageCounts,
    /// The digest of all messages; `None` if it can't be compared.
    digest: Option<DigestCheck>,
    /// A contradiction that is known without the messages.
    contradiction: Option<Contradiction>,
    undecodable: Option<Undecodable>,
}

/// Faults of the messages of a recording.
#[derive(Debug, Default)]
pub(crate) struct ContentFaults {
    pub(crate) undecodable: Option<Undecodable>,
    /// Messages that the run has according to its end record, but the recording lacks.
    pub(crate) missing: Vec<Missing>,
    pub(crate) excess: Option<Excess>,
    pub(crate) contradiction: Option<Contradiction>,
}

impl ContentCheck {
    /// A check of the messages of some topics.
    pub(crate) fn new(recording: &Recording, topics: &Topics) -> Self {
        let mut expected = recording.expected_topics();
        expected.retain(|topic| topics.include(topic));
        Self {
            topics: expected,
            counts: MessageCounts::default(),
            // The digest is that of all topics.
            digest: match topics {
                Topics::All => DigestCheck::new(recording),
                Topics::Only(_) => None,
            },
            contradiction: Contradiction::find(recording),
            undecodable: None,
        }
    }

    /// Takes a message that was read, or the reason why it can't be decoded.
    pub(crate) fn take(&mut self, message: &Result<Message<'_>, MessageError>) {
        let error = match message {
            Ok(message) => {
                if let Some(digest) = &mut self.digest {
                    digest.take(message, self.counts.number(message.topic()));
                }
                return self.counts.take(message);
            }
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

    /// The faults, once all messages of the topics have been read. Without an end record neither numbers nor a digest
    /// are known.
    pub(crate) fn finish(self, end: Option<&Entries>) -> ContentFaults {
        let mut faults = ContentFaults {
            undecodable: self.undecodable,
            ..ContentFaults::default()
        };
        if let Some(end) = end {
            faults.missing = self.counts.missing(&self.topics, end);
            faults.excess = self.counts.excess(&self.topics, end);
            let by_messages = self.digest.and_then(|digest| digest.contradiction(end));
            faults.contradiction = self.contradiction.or(by_messages);
        }
        faults
    }
}

impl ContentFaults {
    /// The faults in sentences. Wrong numbers of messages are left out where damage explains them, and a wrong digest
    /// where anything else does.
    pub(crate) fn sentences(&self, is_damaged: bool) -> Vec<String> {
        let mut sentences = Vec::new();
        sentences.extend(self.undecodable.as_ref().map(ToString::to_string));
        if !is_damaged {
            sentences.extend(self.missing.iter().map(|part| format!("missing {part}")));
            sentences.extend(self.excess.as_ref().map(ToString::to_string));
            if let Some(contradiction) = self.contradiction
                && sentences.is_empty()
            {
                sentences.push(contradiction.to_string());
            }
        }
        sentences
    }
}
