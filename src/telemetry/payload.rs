//! Messages of any channel, whoever wrote it, field by field.

mod cdr;
mod digits;
mod json;
mod literals;
mod protobuf;
mod tree;
mod value;

use self::literals::Literals;
use self::tree::{Filling, Node, Tree};
use thiserror::Error;

pub use self::tree::MAX_FIELDS;
pub use self::value::Value;

/// Why the messages of a channel, or one of them, can't be decoded.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum PayloadError {
    /// An encoding that is not known.
    #[error("messages are encoded as {0:?}; json, protobuf and cdr can be read")]
    Encoding(String),
    /// The schema of the channel can't be used.
    #[error("its schema can't be used: {0}")]
    Schema(String),
    /// The message is not what its encoding demands.
    #[error("not a {encoding} message: {reason}")]
    Malformed {
        /// The encoding.
        encoding: &'static str,
        /// What is wrong.
        reason: String,
    },
}

/// The description of a channel's messages.
#[derive(Clone, Copy, Debug)]
pub struct Schema<'a> {
    /// The name of the message type.
    pub name: &'a str,
    /// The language of the description.
    pub encoding: &'a str,
    /// The description.
    pub data: &'a [u8],
}

/// Decodes the fields of the messages of any channel: JSON with or without a schema, protobuf through its descriptors, and
/// ROS 2's `cdr` through definitions in `ros2msg`.
///
/// A field is named by its path: `pose.position.x`, `ranges.0`. In JSON each number, text, boolean and null has one, and
/// each list or object with nothing in it. In a name, a backslash stands before dots, quotes and backslashes, and before
/// one that is an integer, which would read as the position of an element; the empty name is `""`. Numbers with more
/// digits than their type holds become the nearest double, and are told by [`PayloadDecoder::unsaid`]. `NaN` and `Infinity`, which JSON doesn't have
/// but Python writes, are read. A JSON message that is nothing but a number has a field with an empty name.
///
/// In `cdr` a list of `uint8`, `byte` or `char` is one field of bytes.
///
/// In protobuf a field that is not in a message is zero or empty, as proto3 has it. It is absent if the message type
/// can tell that it was not set: if it is optional, of a `oneof`, of proto2 or editions, or within a message that
/// isn't there.
#[derive(Debug)]
pub struct PayloadDecoder {
    tree: Tree,
    root: Node,
    format: Format,
}

#[derive(Debug)]
enum Format {
    Json,
    Protobuf(protobuf::Types),
    Cdr(cdr::Types),
}

impl PayloadDecoder {
    /// A decoder for messages with an encoding and, if they have one, a schema.
    ///
    /// # Errors
    /// [`PayloadError::Encoding`] or [`PayloadError::Schema`].
    pub fn new(encoding: &str, schema: Option<Schema<'_>>) -> Result<Self, PayloadError> {
        let none = || PayloadError::Schema("there is none".to_owned());
        let mut tree = Tree::default();
        let mut root = Node::default();
        let format = match encoding {
            "json" => Format::Json,
            "protobuf" => {
                let Schema { name, data, .. } = schema.ok_or_else(none)?;
                let types = protobuf::Types::new(name, data).map_err(PayloadError::Schema)?;
                types.foresee(&mut root, &mut tree);
                Format::Protobuf(types)
            }
            "cdr" => match schema.ok_or_else(none)? {
                Schema {
                    name,
                    encoding: "ros2msg",
                    data,
                } => Format::Cdr(cdr::Types::new(name, data).map_err(PayloadError::Schema)?),
                other => {
                    let reason = format!("it is {:?}; ros2msg can be read", other.encoding);
                    return Err(PayloadError::Schema(reason));
                }
            },
            other => return Err(PayloadError::Encoding(other.to_owned())),
        };
        Ok(Self { tree, root, format })
    }

    /// The paths of the fields that have been found, in the order of their first appearance.
    ///
    /// They grow as messages come. In protobuf those that the descriptors foretell are there from the
    /// start: not elements of lists and maps, and types within themselves only as messages have them.
    #[must_use]
    pub fn fields(&self) -> &[String] {
        self.tree.paths()
    }

    /// Decodes a message into `values`: one for each of [`PayloadDecoder::fields`].
    ///
    /// # Errors
    /// [`PayloadError::Malformed`] if it can't be decoded. `values` then mean nothing, and fields
    /// that were found in it stay.
    pub fn decode(&mut self, data: &[u8], values: &mut Vec<Value>) -> Result<(), PayloadError> {
        let filling = Filling::new(&mut self.tree, values);
        let root = &mut self.root;
        let (encoding, filled) = match &self.format {
            Format::Json => {
                let filled = json::fill(data, &mut Literals::default(), root, filling);
                let filled = filled.or_else(|reason| {
                    // Rare enough to be tried only where plain JSON fails.
                    let (data, mut literals) = Literals::replace(data).ok_or(reason)?;
                    let filling = Filling::new(&mut self.tree, values);
                    json::fill(&data, &mut literals, root, filling)
                });
                ("json", filled)
            }
            Format::Protobuf(types) => ("protobuf", types.fill(data, root, filling)),
            Format::Cdr(types) => ("cdr", types.fill(data, root, filling)),
        };
        if encoding == "json" && filled.is_ok() {
            for number in digits::lost(data) {
                self.tree.keep_unknown(number);
                self.tree.keep_unknown(b",");
            }
        }
        filled.map_err(|reason| PayloadError::Malformed { encoding, reason })
    }

    /// What the last message, which is given again, says beyond its values: the fields that its schema doesn't know and
    /// the numbers with more digits than a value holds, or
    /// all of it where there are too many fields or something is said twice. Nothing if the values say it all.
    #[must_use]
    pub fn unsaid<'a>(&'a self, message: &'a [u8]) -> Option<&'a [u8]> {
        self.tree.unsaid(message)
    }

    /// How many values a message has had, at most, that were left out because there are too many fields:
    /// more than [`MAX_FIELDS`], or some with very long paths.
    #[must_use]
    pub fn left_out(&self) -> u64 {
        self.tree.left_out()
    }
}
