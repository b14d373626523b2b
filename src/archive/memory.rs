//! Sink that stores messages in memory.

use crate::archive::sink::{Sink, SinkError};
use crate::telemetry::Message;
use crate::telemetry::digest::ContentDigest;

/// A message that owns its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Owned {
    /// Index of the channel.
    pub channel: usize,
    /// Sequence number.
    pub sequence: u32,
    /// Simulation time, ns.
    pub time_ns: u64,
    /// The numbers.
    pub numbers: Vec<f64>,
    /// The texts.
    pub texts: Vec<String>,
}

impl From<&Message<'_>> for Owned {
    fn from(message: &Message<'_>) -> Self {
        Self {
            channel: message.channel,
            sequence: message.sequence,
            time_ns: message.time_ns,
            numbers: message.numbers.to_vec(),
            texts: message.texts.to_vec(),
        }
    }
}

impl Owned {
    /// The message in the form that sinks accept.
    pub fn as_message(&self) -> Message<'_> {
        Message {
            channel: self.channel,
            sequence: self.sequence,
            time_ns: self.time_ns,
            numbers: &self.numbers,
            texts: &self.texts,
        }
    }
}

/// All messages, and their digest.
#[derive(Clone, Debug, Default)]
pub struct MemorySink {
    /// In order of arrival.
    pub messages: Vec<Owned>,
    /// Digest of all of them.
    pub digest: ContentDigest,
}

impl Sink for MemorySink {
    fn write(&mut self, message: &Message<'_>) -> Result<(), SinkError> {
        self.digest.update(message);
        self.messages.push(Owned::from(message));
        Ok(())
    }

    fn flush(&mut self) -> Result<(), SinkError> {
        Ok(())
    }
}
