//! Topics: which channel of the table is meant.

use super::channel::{ChannelInfo, channel_index, channels};
use super::table::{EVENTS, NUTATION, SAMPLES};
use std::fmt;
use thiserror::Error;

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

/// Which channels are meant, by their topics: those of the table, or any names of a file's.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Topics<T = Topic> {
    /// All that there are.
    #[default]
    All,
    /// These and no others.
    Only(Vec<T>),
}

impl<T: PartialEq> Topics<T> {
    /// Whether a topic is among them.
    pub fn include<N: ?Sized>(&self, topic: &N) -> bool
    where
        T: PartialEq<N>,
    {
        match self {
            Self::All => true,
            Self::Only(topics) => topics.iter().any(|wanted| wanted == topic),
        }
    }
}

impl Topics {
    /// Only the topics of the table with these names.
    ///
    /// # Errors
    /// [`UnknownTopic`] for a name that the table doesn't have.
    pub fn named(names: &[impl AsRef<str>]) -> Result<Self, UnknownTopic> {
        let find = |name: &str| {
            Topic::find(name).ok_or_else(|| UnknownTopic {
                name: name.to_owned(),
            })
        };
        let topics: Result<_, _> = names.iter().map(|name| find(name.as_ref())).collect();
        Ok(Self::Only(topics?))
    }
}

/// A name that is not a topic of the table.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("there is no topic {name}; topics: {}", Topic::all().map(Topic::name).collect::<Vec<_>>().join(", "))]
pub struct UnknownTopic {
    /// The name.
    pub name: String,
}

impl fmt::Display for Topic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_topics_are_refused() {
        let error = Topics::named(&["/top/stat"]).unwrap_err();
        assert!(error.to_string().contains("/top/state"), "{error}");
    }
}
