//! Topics: names of the table's channels.

use crate::run::suggestion::suggestion;
use std::fmt;
use thiserror::Error;

/// The topic of a channel of the table. All of them are constants in [`fields`](super::fields).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Topic(usize);

impl Topic {
    /// The topic of the channel with this index in [`channels`].
    pub(super) const fn from_index(index: usize) -> Self {
        Self(index)
    }

    /// The channel's index in [`channels`](super::channels), equal to [`Message::channel`](super::Message::channel).
    pub const fn index(self) -> usize {
        self.0
    }
}

/// A selection of topics: of the table, or with `T = String` of any file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Topics<T = Topic> {
    /// Every channel.
    #[default]
    All,
    /// The channels with these topics; may be empty.
    Only(Vec<T>),
}

impl<T: PartialEq> Topics<T> {
    /// Whether a topic is selected.
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
    /// The topics of the table with these names.
    ///
    /// # Errors
    /// [`UnknownTopic`] for a name that is not in the table.
    pub fn named(names: &[impl AsRef<str>]) -> Result<Self, UnknownTopic> {
        let mut topics = Vec::new();
        for name in names {
            let name = name.as_ref();
            topics.push(Topic::find(name).ok_or_else(|| UnknownTopic {
                name: name.to_owned(),
            })?);
        }
        Ok(Self::Only(topics))
    }
}

/// The error for a name that is not a topic of the table.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("unknown topic {name}{}; topics: {}", suggestion(name, Topic::all().map(Topic::name)), Topic::all().map(Topic::name).collect::<Vec<_>>().join(", "))]
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
    fn rejects_unknown_topics() {
        let error = Topics::named(&["/top/stat"]).unwrap_err();
        assert!(error.to_string().contains("/top/state"), "{error}");
    }
}
