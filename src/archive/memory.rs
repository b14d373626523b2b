//! Messages in memory.

use crate::telemetry::Message;

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
