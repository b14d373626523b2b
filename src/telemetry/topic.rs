//! Topics: which channel of the table is meant.

use super::channel::{ChannelInfo, channel_index, channels};
use super::table::{EVENTS, NUTATION, SAMPLES};
use std::fmt;

/// A channel of the table: its place in [`channels`]. The topics there are stand in
/// [`fields`](super::fields).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Topic(usize);

impl Topic {
    /// The topic of the channel at a place of [`channels`].
    pub(super) const fn at(index: usize) -> Self {
        Self(index)
    }

    /// The topic with a name, if the table has it. Code that knows the name uses the topics of
    /// [`fields`](super::fields).
    #[must_use]
    pub fn find(name: &str) -> Option<Self> {
        channel_index(name).map(Self)
    }

    /// All topics, in table order.
    pub fn all() -> impl ExactSizeIterator<Item = Self> {
        (0..channels().len()).map(Self)
    }

    /// Its place in [`channels`], which is also that of [`Message::channel`](super::Message::channel).
    #[must_use]
    pub const fn index(self) -> usize {
        self.0
    }

    /// Its name, as in `/top/state`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        const AFTER_SAMPLES: usize = SAMPLES.len();
        match self.0 {
            AFTER_SAMPLES => NUTATION.topic,
            index if index < AFTER_SAMPLES => SAMPLES[index].topic,
            _ => EVENTS.topic,
        }
    }

    /// What its channel carries.
    #[must_use]
    pub fn info(self) -> &'static ChannelInfo {
        &channels()[self.0]
    }
}

impl fmt::Display for Topic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
