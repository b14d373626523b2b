//! Messages: rows of the channels.

use super::topic::Topic;

/// One message: a row of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Message<'a> {
    /// Index of the channel in [`channels`](super::channels).
    pub channel: usize,
    /// Counts samples, events or cycles from 0; samples without this message leave a gap.
    pub sequence: u32,
    /// Simulation time, ns.
    pub time_ns: u64,
    /// The numbers, finite, in the order of the leaves.
    pub numbers: &'a [f64],
    /// The texts, in the order of the leaves.
    pub texts: &'a [String],
}

impl Message<'_> {
    /// The topic of its channel.
    #[must_use]
    pub fn topic(&self) -> Topic {
        Topic::at(self.channel)
    }
}

/// Rows of numbers from which [`fields`](super::fields) read themselves: a message, or the messages of one
/// instant.
pub trait Numbers {
    /// The numbers of a channel; none if it has no message here.
    fn numbers(&self, topic: Topic) -> Option<&[f64]>;
}

impl Numbers for Message<'_> {
    #[inline]
    fn numbers(&self, topic: Topic) -> Option<&[f64]> {
        (self.channel == topic.index()).then_some(self.numbers)
    }
}
