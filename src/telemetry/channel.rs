//! Channels as sinks and readers see them: the table without the functions that fill it.

use super::quantity::Quantity;

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
