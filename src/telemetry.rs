//! What is logged: one table, from which everything else follows.
//!
//! [`table`] declares each channel once: its topic, and for each field the name, unit, frame, meaning
//! and where in a sample it comes from. From it follow the messages each way ([`encoding`]: [`json`] and
//! [`protobuf`]) and their schemas ([`schema`]), the content digest ([`digest`]), the MCAP channels and
//! the Rerun entities.
//!
//! Sinks see only [`Message`]s: rows of numbers and texts in the order of [`channels`].

pub mod digest;
pub mod encoding;
pub mod json;
pub mod proportions;
pub mod protobuf;
pub mod schema;
pub mod side;
pub mod table;
pub mod views;

use crate::run::simulation::Record;
use std::sync::OnceLock;
use table::{Channel, EVENTS, Field, NUTATION, SAMPLES, Source};
use thiserror::Error;

/// A channel as the sinks see it.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelInfo {
    /// Topic, as in `/top/state`.
    pub topic: &'static str,
    /// Name of the message type.
    pub schema: &'static str,
    /// What the channel carries.
    pub meaning: &'static str,
    /// Its texts, which stand first in a message: as in [`Message::texts`].
    pub texts: Vec<Leaf>,
    /// Its numbers: as in [`Message::numbers`].
    pub numbers: Vec<Leaf>,
    /// Whether there is a message for each sample; else for each event or cycle.
    pub is_sampled: bool,
    /// Whether a sample may be without a message of this channel.
    pub is_optional: bool,
}

/// One number or text of a message.
#[derive(Clone, Debug, PartialEq)]
pub struct Leaf {
    /// Where it stands in the message: a name, or an object's name and a component, `omega_body.x`.
    pub path: String,
    /// Unit, empty for pure numbers and texts.
    pub unit: &'static str,
    /// Frame of a vector's components, empty for others.
    pub frame: &'static str,
    /// What it means.
    pub meaning: &'static str,
    /// The plot in which its channel shows it; those with the same plot belong together.
    pub plot: &'static str,
}

/// A member of a message: a leaf, or an object of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Member<'a> {
    /// Its name in the message.
    pub name: &'a str,
    /// What it is.
    pub content: Content<'a>,
}

/// What a member of a message is.
#[derive(Clone, Debug, PartialEq)]
pub enum Content<'a> {
    /// The text with this index.
    Text(usize),
    /// The number with this index.
    Number(usize),
    /// Numbers, with their names in the object and their indices.
    Object(Vec<(&'a str, usize)>),
}

impl ChannelInfo {
    /// How a message is built from its leaves: a dot in a path makes an object.
    #[must_use]
    pub fn members(&self) -> Vec<Member<'_>> {
        let mut members: Vec<Member<'_>> = Vec::new();
        for (index, leaf) in self.texts.iter().enumerate() {
            members.push(Member {
                name: &leaf.path,
                content: Content::Text(index),
            });
        }
        for (index, leaf) in self.numbers.iter().enumerate() {
            let Some((parent, name)) = leaf.path.split_once('.') else {
                members.push(Member {
                    name: &leaf.path,
                    content: Content::Number(index),
                });
                continue;
            };
            match members.last_mut() {
                Some(Member {
                    name: open,
                    content: Content::Object(inner),
                }) if *open == parent => inner.push((name, index)),
                _ => members.push(Member {
                    name: parent,
                    content: Content::Object(vec![(name, index)]),
                }),
            }
        }
        members
    }

    /// Texts and numbers, in the order of a message.
    pub fn leaves(&self) -> impl Iterator<Item = &Leaf> {
        self.texts.iter().chain(&self.numbers)
    }

    /// Where the number `path` stands in [`Message::numbers`].
    #[must_use]
    pub fn number_index(&self, path: &str) -> Option<usize> {
        self.numbers.iter().position(|leaf| leaf.path == path)
    }
}

/// One message: a row of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Message<'a> {
    /// Index of the channel in [`channels`].
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

/// Why a record can't be logged.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TelemetryError {
    /// A quantity became infinite or not a number.
    #[error("{topic} {field} is {value} at t = {} s: only finite numbers are recorded", *time_ns as f64 / 1e9)]
    NonFinite {
        /// The channel.
        topic: &'static str,
        /// The field.
        field: String,
        /// What it was.
        value: f64,
        /// When, ns.
        time_ns: u64,
    },
    /// A topic that does not exist was asked for.
    #[error("there is no topic {topic}; topics: {allowed}")]
    UnknownTopic {
        /// The topic.
        topic: String,
        /// Those that exist.
        allowed: String,
    },
}

/// All channels, in table order.
pub fn channels() -> &'static [ChannelInfo] {
    static CHANNELS: OnceLock<Vec<ChannelInfo>> = OnceLock::new();
    CHANNELS.get_or_init(|| {
        let samples = SAMPLES.iter().map(|channel| info(channel, true));
        let others = [info(&NUTATION, false), info(&EVENTS, false)];
        samples.chain(others).collect()
    })
}

/// Where the channel with a topic stands in [`channels`].
#[must_use]
pub fn channel_index(topic: &str) -> Option<usize> {
    channels().iter().position(|channel| channel.topic == topic)
}

/// Turns records into messages.
#[derive(Debug)]
pub struct Telemetry {
    wanted: Vec<bool>,
    numbers: Vec<f64>,
    texts: Vec<String>,
}

impl Default for Telemetry {
    /// All topics.
    fn default() -> Self {
        Self {
            wanted: vec![true; channels().len()],
            numbers: Vec::new(),
            texts: Vec::new(),
        }
    }
}

impl Telemetry {
    /// Only some topics.
    ///
    /// # Errors
    /// [`TelemetryError::UnknownTopic`] for one that does not exist.
    pub fn with_topics(topics: &[String]) -> Result<Self, TelemetryError> {
        let mut telemetry = Self::default();
        telemetry.wanted.fill(false);
        for topic in topics {
            let channel = channel_index(topic).ok_or_else(|| TelemetryError::UnknownTopic {
                topic: topic.clone(),
                allowed: channels()
                    .iter()
                    .map(|c| c.topic)
                    .collect::<Vec<_>>()
                    .join(", "),
            })?;
            telemetry.wanted[channel] = true;
        }
        Ok(telemetry)
    }

    /// Whether the channel with this index is logged.
    #[must_use]
    pub fn wants(&self, channel: usize) -> bool {
        self.wanted[channel]
    }

    /// Gives the messages of `record` to `emit`, in table order.
    ///
    /// # Errors
    /// [`TelemetryError::NonFinite`], or the first error of `emit`.
    pub fn messages<E: From<TelemetryError>>(
        &mut self,
        record: &Record,
        mut emit: impl FnMut(&Message<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        match record {
            Record::Sample(sample) => {
                for (channel, row) in SAMPLES.iter().enumerate() {
                    let at = (channel, sample.index, sample.time_ns);
                    self.message(row, at, sample.as_ref(), &mut emit)?;
                }
                Ok(())
            }
            Record::Nutation(cycle) => {
                let at = (SAMPLES.len(), cycle.index, cycle.time_ns);
                self.message(&NUTATION, at, cycle.as_ref(), &mut emit)
            }
            Record::Event(event) => {
                let at = (SAMPLES.len() + 1, event.index, event.time_ns);
                self.message(&EVENTS, at, event.as_ref(), &mut emit)
            }
        }
    }

    fn message<S, E: From<TelemetryError>>(
        &mut self,
        row: &Channel<S>,
        (channel, sequence, time_ns): (usize, u32, u64),
        source: &S,
        emit: &mut impl FnMut(&Message<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        if !self.wanted[channel] || row.present.is_some_and(|present| !present(source)) {
            return Ok(());
        }
        self.numbers.clear();
        self.texts.clear();
        for field in row.fields {
            match field.source {
                Source::Number(get) => self.numbers.push(get(source)),
                Source::Vector(get) => self.numbers.extend(get(source).iter()),
                Source::Rotation(get) => self.numbers.extend(get(source).coords.iter()),
                Source::Text(get) => self.texts.push(get(source).to_owned()),
            }
        }
        if let Some(wrong) = self.numbers.iter().position(|number| !number.is_finite()) {
            let leaf = channels()[channel].numbers.get(wrong);
            return Err(E::from(TelemetryError::NonFinite {
                topic: row.topic,
                field: leaf.map(|leaf| leaf.path.clone()).unwrap_or_default(),
                value: self.numbers[wrong],
                time_ns,
            }));
        }
        emit(&Message {
            channel,
            sequence,
            time_ns,
            numbers: &self.numbers,
            texts: &self.texts,
        })
    }
}

fn info<S>(channel: &Channel<S>, is_sampled: bool) -> ChannelInfo {
    let (texts, numbers): (Vec<_>, Vec<_>) = channel
        .fields
        .iter()
        .partition(|field| matches!(field.source, Source::Text(_)));
    let leaves = |fields: Vec<&Field<S>>| fields.into_iter().flat_map(leaves).collect();
    ChannelInfo {
        topic: channel.topic,
        schema: channel.schema,
        meaning: channel.meaning,
        texts: leaves(texts),
        numbers: leaves(numbers),
        is_sampled,
        is_optional: channel.present.is_some(),
    }
}

fn leaves<S>(field: &Field<S>) -> Vec<Leaf> {
    let components: &[&str] = match field.source {
        Source::Number(_) | Source::Text(_) => &[""],
        Source::Vector(_) => &[".x", ".y", ".z"],
        Source::Rotation(_) => &[".x", ".y", ".z", ".w"],
    };
    let leaf = |component: &&str| Leaf {
        path: format!("{}{component}", field.name),
        unit: field.unit,
        frame: field.frame,
        meaning: field.meaning,
        plot: field.plot,
    };
    components.iter().map(leaf).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_unique_and_objects_are_contiguous() {
        for channel in channels() {
            let mut closed: Vec<&str> = Vec::new();
            for leaf in channel.leaves() {
                let parent = leaf.path.split('.').next().unwrap_or_default();
                if closed.last() != Some(&parent) {
                    assert!(!closed.contains(&parent), "{} {}", channel.topic, leaf.path);
                    closed.push(parent);
                }
            }
            let mut paths: Vec<_> = channel.leaves().map(|leaf| &leaf.path).collect();
            paths.sort();
            paths.dedup();
            assert_eq!(paths.len(), channel.leaves().count(), "{}", channel.topic);
        }
    }

    #[test]
    fn unknown_topics_are_refused() {
        let error = Telemetry::with_topics(&["/top/stat".to_owned()]).unwrap_err();
        assert!(error.to_string().contains("/top/state"), "{error}");
    }
}
