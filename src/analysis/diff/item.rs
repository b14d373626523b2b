//! A message of one of the runs, on its way to its counterpart.

use crate::telemetry::Message;
use crate::telemetry::payload::Value;
use std::sync::Arc;

/// A message that is compared with one of the other run.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Item {
    /// The position of its topic.
    pub(super) topic: usize,
    pub(super) sequence: u32,
    /// The time on the clock that both runs have in common, ns.
    pub(super) time_ns: u64,
    /// The numbers of its fields; NaN for fields that are none.
    pub(super) numbers: Vec<f64>,
    /// The texts of a message of the telemetry table.
    pub(super) texts: Vec<String>,
    /// Of a message of others, the exact values of its fields.
    pub(super) values: Vec<Value>,
    /// Of a message of others, what it says beyond its fields: all of it if it can't be decoded.
    pub(super) rest: Option<Box<[u8]>>,
    /// How its file has it; none for what is simulated or interpolated.
    pub(super) written: Option<Written>,
    /// Whether it repeats another of its topic or goes back in time, as no message of a run does.
    pub(super) is_misplaced: bool,
}

/// How a file has a message, beside what the message says.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Written {
    pub(super) encoding: Arc<str>,
    pub(super) sequence: u32,
    pub(super) publish_time: u64,
    /// Its bytes; none if they are compared as such anyway.
    pub(super) bytes: Option<Box<[u8]>>,
}

impl From<&Message<'_>> for Item {
    fn from(message: &Message<'_>) -> Self {
        Self {
            topic: message.channel,
            sequence: message.sequence,
            time_ns: message.time_ns,
            numbers: message.numbers.to_vec(),
            texts: message.texts.to_vec(),
            ..Self::default()
        }
    }
}

impl Item {
    /// A message of the table, as sinks take it.
    pub(super) fn as_message(&self) -> Message<'_> {
        Message {
            channel: self.topic,
            sequence: self.sequence,
            time_ns: self.time_ns,
            numbers: &self.numbers,
            texts: &self.texts,
        }
    }

    /// What of it is compared exactly.
    pub(super) fn content(&self) -> Content<'_> {
        Content {
            texts: &self.texts,
            values: &self.values,
            rest: self.rest.as_deref(),
            written: self.written.as_ref(),
        }
    }

    /// How much memory it takes, bytes.
    pub(super) fn memory(&self) -> usize {
        let texts = self.texts.iter();
        let texts = texts.map(|text| size_of::<String>() + text.capacity());
        let values = self.values.iter();
        let values = values.map(|value| size_of::<Value>() + value.memory());
        let rest = self.rest.as_ref().map_or(0, |rest| rest.len());
        let written = self.written.as_ref();
        let written = written.and_then(|written| written.bytes.as_ref());
        size_of::<Self>()
            + size_of_val(self.numbers.as_slice())
            + texts.sum::<usize>()
            + values.sum::<usize>()
            + rest
            + written.map_or(0, |bytes| bytes.len())
    }
}

/// What of a message is compared exactly, and not as numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Content<'a> {
    pub(super) texts: &'a [String],
    pub(super) values: &'a [Value],
    pub(super) rest: Option<&'a [u8]>,
    pub(super) written: Option<&'a Written>,
}
