//! Channel descriptions for sinks and readers (the table without its source functions).

use super::quantity::Quantity;

/// A channel: a stream of messages with the same fields.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelInfo {
    /// Topic, e.g. `/top/state`.
    pub topic: &'static str,
    /// Name of the message type.
    pub schema: &'static str,
    /// Description of the channel.
    pub meaning: &'static str,
    /// Text fields, in the order of [`Message::texts`](crate::telemetry::Message::texts); encoded before the numbers.
    pub texts: Vec<Leaf>,
    /// Number fields, in the order of [`Message::numbers`](crate::telemetry::Message::numbers).
    pub numbers: Vec<Leaf>,
    /// Whether the channel has messages for samples; otherwise it has one for each event, nutation or impact.
    pub is_sampled: bool,
    /// Whether some samples have no message on this channel.
    pub is_optional: bool,
    /// Whether the channel exists only for a free peg.
    pub is_free_peg_only: bool,
}

/// A number or text of a message.
#[derive(Clone, Debug, PartialEq)]
pub struct Leaf {
    /// Path in the message, e.g. `theta` or `omega_body.x`.
    pub path: String,
    /// The measured quantity.
    pub quantity: Quantity,
    /// Unit; empty for pure numbers and texts.
    pub unit: &'static str,
    /// Frame of a vector's components; empty for others.
    pub frame: &'static str,
    /// Description.
    pub meaning: &'static str,
    /// Plot name; fields of a channel with the same plot name share a plot.
    pub plot: &'static str,
    /// Whether it is a component of a vector or a quaternion.
    pub is_component: bool,
    /// The index of its time derivative among the channel's numbers, if that is recorded.
    pub derivative: Option<usize>,
}

/// A member of an encoded message, a leaf or an object of numbers: its name and content.
pub type Member<'a> = (&'a str, Content<'a>);

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
    pub fn members(&self) -> Vec<Member<'_>> {
        let mut members: Vec<Member<'_>> = Vec::new();
        for (index, leaf) in self.texts.iter().enumerate() {
            members.push((&leaf.path, Content::Text(index)));
        }
        for (index, leaf) in self.numbers.iter().enumerate() {
            let Some((parent, name)) = leaf.path.split_once('.') else {
                members.push((&leaf.path, Content::Number(index)));
                continue;
            };
            // The leaves of an object are neighbours in the table, so only the last member can be the one that is open.
            match members.last_mut() {
                Some((open, Content::Object(inner))) if *open == parent => {
                    inner.push((name, index));
                }
                _ => members.push((parent, Content::Object(vec![(name, index)]))),
            }
        }
        members
    }

    /// All leaves in the order of an encoded message: texts, then numbers.
    pub fn leaves(&self) -> impl Iterator<Item = &Leaf> {
        self.texts.iter().chain(&self.numbers)
    }

    /// The index of the number at `path`.
    pub fn number_index(&self, path: &str) -> Option<usize> {
        self.numbers.iter().position(|leaf| leaf.path == path)
    }
}
