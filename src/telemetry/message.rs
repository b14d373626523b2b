//! Messages: the values of a channel at one instant.

use super::topic::Topic;

/// A message: the numbers and texts of one channel at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Message<'a> {
    /// Index of the channel in [`channels`](super::channels).
    pub channel: usize,
    /// Number of the sample, event or nutation, from 0; gaps where samples have no message on this channel.
    pub sequence: u32,
    /// Simulation time, ns.
    pub time_ns: u64,
    /// The numbers, in the order of [`ChannelInfo::numbers`](super::ChannelInfo::numbers): finite, or NaN for fields
    /// missing in a file.
    pub numbers: &'a [f64],
    /// The texts, in the order of [`ChannelInfo::texts`](super::ChannelInfo::texts).
    pub texts: &'a [String],
}

impl Message<'_> {
    /// The channel's topic.
    pub fn topic(&self) -> Topic {
        Topic::from_index(self.channel)
    }
}

/// A source of numbers for [`fields`](super::fields): a message, or all messages of one instant.
pub trait Numbers {
    /// The numbers of a channel; `None` if there is no message on it.
    fn numbers(&self, topic: Topic) -> Option<&[f64]>;
}

impl Numbers for Message<'_> {
    #[inline]
    fn numbers(&self, topic: Topic) -> Option<&[f64]> {
        (self.channel == topic.index()).then_some(self.numbers)
    }
}
