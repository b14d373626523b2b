//! The numbers in the messages of any channel, whoever wrote it.

mod json;
mod protobuf;
mod tree;

use self::protobuf::Types;
use self::tree::{Filling, Node, Tree};
use crate::archive::container::channels::FileChannel;
use thiserror::Error;

pub use self::tree::MAX_FIELDS;

/// Why numbers can't be read from a channel or from one of its messages.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NumbersError {
    /// An encoding that is neither JSON nor protobuf.
    #[error("messages are encoded as {0:?}; numbers can be read from json and protobuf")]
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

/// Decodes the numeric fields of the messages of any channel: JSON with or without a schema, protobuf
/// through its descriptors.
///
/// A field is named by its path: `pose.position.x`, `ranges.0`. In JSON each number has one; where two
/// have the same, as in `{"a.b":1,"a":{"b":2}}`, the last counts. Booleans count as 0 and 1, enums as
/// their numbers; texts and bytes are left out, also texts that spell numbers. Integers beyond 2⁵³ become
/// the nearest number. `null` is no number; `NaN` and `Infinity`, which JSON doesn't have but Python writes, are
/// read. A JSON message that is nothing but a number has a field with an empty name.
///
/// In protobuf a number that is not in a message is zero, as proto3 has it. It is NaN if the message type can
/// tell that it was not set: if it is optional, of a `oneof`, of proto2 or editions, or within a message
/// that isn't there.
#[derive(Debug)]
pub struct NumberDecoder {
    tree: Tree,
    root: Node,
    format: Format,
}

#[derive(Debug)]
enum Format {
    Json,
    Protobuf(Types),
}

impl NumberDecoder {
    /// A decoder for the messages of a channel.
    ///
    /// # Errors
    /// [`NumbersError::Encoding`] or [`NumbersError::Schema`].
    pub fn new(channel: &FileChannel) -> Result<Self, NumbersError> {
        let mut tree = Tree::default();
        let mut root = Node::default();
        let format = match channel.encoding.as_str() {
            "json" => Format::Json,
            "protobuf" => {
                let none = || NumbersError::Schema("there is none".to_owned());
                let schema = channel.schema.as_ref().ok_or_else(none)?;
                let types = Types::new(&schema.name, &schema.data).map_err(NumbersError::Schema)?;
                types.foresee(&mut root, &mut tree);
                Format::Protobuf(types)
            }
            other => return Err(NumbersError::Encoding(other.to_owned())),
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

    /// Decodes a message into `values`: one for each of [`NumberDecoder::fields`], NaN for those that it
    /// doesn't have.
    ///
    /// # Errors
    /// [`NumbersError::Malformed`] if it can't be decoded. `values` then mean nothing, and fields
    /// that were found in it stay.
    pub fn decode(&mut self, data: &[u8], values: &mut Vec<f64>) -> Result<(), NumbersError> {
        let filling = Filling::new(&mut self.tree, values);
        let (encoding, filled) = match &self.format {
            Format::Json => ("json", json::fill(data, &mut self.root, filling)),
            Format::Protobuf(types) => ("protobuf", types.fill(data, &mut self.root, filling)),
        };
        let filled = filled.or_else(|reason| match &self.format {
            // Rare enough to be tried only where plain JSON fails.
            Format::Json => {
                let data = json::without_literals(data).ok_or(reason)?;
                let filling = Filling::new(&mut self.tree, values);
                json::fill(&data, &mut self.root, filling)?;
                json::restore(values);
                Ok(())
            }
            Format::Protobuf(_) => Err(reason),
        });
        filled.map_err(|reason| NumbersError::Malformed { encoding, reason })
    }

    /// How many numbers a message has had, at most, that were left out because there are too many fields:
    /// more than [`MAX_FIELDS`], or some with very long paths.
    #[must_use]
    pub fn left_out(&self) -> u64 {
        self.tree.left_out()
    }
}
