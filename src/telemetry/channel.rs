//! The channels as sinks and readers see them: the table without the functions that fill it.

use super::quantity::Quantity;
use super::table::{Channel, EVENTS, Field, IMPACTS, NUTATION, SAMPLES, Source};
use std::sync::OnceLock;

/// A channel: a stream of messages with the same fields.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelInfo {
    /// Topic, as in `/top/state`: the channel's name.
    pub topic: &'static str,
    /// Name of the message type.
    pub schema: &'static str,
    /// Content of the channel.
    pub meaning: &'static str,
    /// Its texts, in the order of [`Message::texts`](super::Message::texts); in an encoded message they come first.
    pub texts: Vec<Leaf>,
    /// Its numbers, in the order of [`Message::numbers`](super::Message::numbers).
    pub numbers: Vec<Leaf>,
    /// Whether there is a message for each sample; otherwise there is one for each event or nutation.
    pub is_sampled: bool,
    /// Whether some samples have no message on this channel.
    pub is_optional: bool,
    /// Whether only the recordings of tops with a free peg have it.
    pub is_of_free_peg: bool,
}

/// One number or text of a message.
#[derive(Clone, Debug, PartialEq)]
pub struct Leaf {
    /// Its name in the message, behind that of its object if it is in one: `theta`, `omega_body.x`.
    pub path: String,
    /// The measured quantity.
    pub quantity: Quantity,
    /// Unit, empty for pure numbers and texts.
    pub unit: &'static str,
    /// Frame of a vector's components, empty for others.
    pub frame: &'static str,
    /// Its meaning.
    pub meaning: &'static str,
    /// Name of the plot that shows it; leaves of a channel with the same plot are shown together.
    pub plot: &'static str,
    /// Whether it is a component of a vector or a quaternion.
    pub is_component: bool,
    /// The index of its time derivative among the channel's numbers, if that is recorded.
    pub derivative: Option<usize>,
}

/// A member of an encoded message: a leaf, or an object of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Member<'a> {
    /// Name.
    pub name: &'a str,
    /// Its content.
    pub content: Content<'a>,
}

/// Content of a member of an encoded message.
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
    /// The members of an encoded message: leaves, and objects for paths with a dot.
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

    /// All leaves in the order of an encoded message: texts, then numbers.
    pub fn leaves(&self) -> impl Iterator<Item = &Leaf> {
        self.texts.iter().chain(&self.numbers)
    }

    /// The index of the number at `path`.
    #[must_use]
    pub fn number_index(&self, path: &str) -> Option<usize> {
        self.numbers.iter().position(|leaf| leaf.path == path)
    }
}

/// All channels, in table order.
pub fn channels() -> &'static [ChannelInfo] {
    static CHANNELS: OnceLock<Vec<ChannelInfo>> = OnceLock::new();
    CHANNELS.get_or_init(|| {
        let samples = SAMPLES.iter().map(|channel| info(channel, true));
        let others = [
            info(&NUTATION, false),
            info(&EVENTS, false),
            info(&IMPACTS, false),
        ];
        samples.chain(others).collect()
    })
}

fn info<S>(channel: &Channel<S>, is_sampled: bool) -> ChannelInfo {
    let (texts, numbers): (Vec<_>, Vec<_>) = channel
        .fields
        .iter()
        .partition(|field| matches!(field.source, Source::Text(_)));
    let leaves = |fields: Vec<&Field<S>>| fields.into_iter().flat_map(leaves).collect();
    let mut numbers: Vec<Leaf> = leaves(numbers);
    for field in channel.fields {
        let find = |name: &str| numbers.iter().position(|leaf| leaf.path == name);
        if let (Some(number), Some(derivative)) = (find(field.name), field.derivative) {
            numbers[number].derivative = find(derivative);
        }
    }
    ChannelInfo {
        topic: channel.topic,
        schema: channel.schema,
        meaning: channel.meaning,
        texts: leaves(texts),
        numbers,
        is_sampled,
        is_optional: channel.present.is_some(),
        is_of_free_peg: channel.is_of_free_peg,
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
        quantity: field.quantity,
        unit: field.quantity.unit(),
        frame: field.frame,
        meaning: field.meaning,
        plot: field.plot,
        is_component: components.len() > 1,
        derivative: None,
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
}
