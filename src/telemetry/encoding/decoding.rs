//! Shared parts of the decoders: rows, errors, message structure.

use crate::telemetry::table::channel::ChannelInfo;
use crate::words::counted;
use std::str::Utf8Error;
use thiserror::Error;

/// A decoded message (reusable buffer).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// The timestamp, ns.
    pub time_ns: u64,
    /// The numbers in the order of the channel's; NaN for missing ones.
    pub numbers: Vec<f64>,
    /// The texts in the order of the channel's; empty for missing ones.
    pub texts: Vec<String>,
}

impl Row {
    /// Empties the row and resizes it for a channel.
    pub(super) fn clear(&mut self, channel: &ChannelInfo) {
        self.time_ns = 0;
        self.numbers.clear();
        self.numbers.resize(channel.numbers.len(), f64::NAN);
        self.texts.resize(channel.texts.len(), String::new());
        // Cleared one by one: the next message reuses their memory.
        self.texts.iter_mut().for_each(String::clear);
    }

    /// Adds a part of the timestamp, ns, if it is in range. A part that is repeated makes a time that is not the log time,
    /// which the reader rejects.
    #[inline]
    pub(super) fn add_time(&mut self, part_ns: Option<u64>) -> Result<(), TimestampOverflow> {
        self.time_ns = part_ns
            .and_then(|part| self.time_ns.checked_add(part))
            .ok_or(TimestampOverflow)?;
        Ok(())
    }
}

/// A timestamp of more nanoseconds than a recording can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("its timestamp is out of range")]
pub struct TimestampOverflow;

/// Error of decoding a channel or message of a file.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum DecodeError {
    /// The schema of the channel can't be read.
    #[error("its schema can't be read: {0}")]
    Schema(#[from] SchemaError),
    /// No encoding has this name.
    #[error("unknown message encoding {0:?}; json and protobuf can be read")]
    UnknownEncoding(String),
    /// The message is not JSON of its schema, for the reason that the parser gives.
    #[error("not a json message: {0}")]
    Json(String),
    /// The message is not protobuf of its schema.
    #[error("not a protobuf message: {0}")]
    Protobuf(#[from] WireError),
    /// The message has other fields than its schema.
    #[error("{}", describe_fields(*found, *expected, *unknown))]
    Fields {
        /// Number of fields of the schema that the message has.
        found: usize,
        /// Number of fields of the schema.
        expected: usize,
        /// Number of other fields.
        unknown: usize,
    },
    /// The message's own timestamp is not its log time.
    #[error("its timestamp, {0} ns, differs from its log time")]
    Timestamp(u64),
}

/// The fields in which a message differs from its schema.
fn describe_fields(found: usize, expected: usize, unknown: usize) -> String {
    // A field that is there twice is one more, too.
    let others = counted((unknown + found.saturating_sub(expected)) as u64, "field");
    match (expected.saturating_sub(found), unknown) {
        (0, _) => format!("it has {others} more than its schema"),
        (lacking, 0) => format!("it lacks {lacking} of the {expected} fields of its schema"),
        (lacking, _) => {
            format!(
                "it lacks {lacking} of the {expected} fields of its schema, and has {others} more"
            )
        }
    }
}

/// Error of reading the schema of a channel.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SchemaError {
    /// The schema is longer than any that is read, bytes.
    #[error("longer than {0} bytes")]
    TooLong(usize),
    /// The schema is not JSON, for the reason that the parser gives.
    #[error("{0}")]
    Json(String),
    /// The schema is not a set of protobuf descriptors.
    #[error(transparent)]
    Protobuf(#[from] prost::DecodeError),
    /// The descriptors lack the message type.
    #[error("it has no message {0}")]
    NoMessage(String),
    /// Nested types expand to too many fields.
    #[error("its field paths exceed {MAX_PATHS_LENGTH} bytes")]
    TooManyPaths,
}

/// Error of reading a protobuf message.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum WireError {
    /// A key, number or group can't be read.
    #[error(transparent)]
    Malformed(#[from] prost::DecodeError),
    /// The message ends too early.
    #[error("it ends within a field")]
    Truncated,
    /// A text is not UTF-8.
    #[error(transparent)]
    Text(#[from] Utf8Error),
    /// The timestamp is too large.
    #[error(transparent)]
    Timestamp(#[from] TimestampOverflow),
    /// A field is not in the schema.
    #[error("field {0} is not in the schema")]
    UnknownField(u32),
    /// A field has another type than in the schema.
    #[error("field {0} has the wrong wire type")]
    WireType(u32),
}

/// Field differences between a channel of a file and the table (other version).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FieldDifferences {
    /// Fields of the table that the file doesn't have.
    pub missing: Vec<String>,
    /// Fields of the file that the table doesn't have.
    pub unknown: Vec<String>,
}

impl FieldDifferences {
    /// Fields that a file with the fields `present` lacks, and those that the table lacks.
    pub(super) fn between(channel: &ChannelInfo, present: &[String]) -> Self {
        Self {
            missing: channel
                .leaves()
                .map(|leaf| &leaf.path)
                .filter(|path| !present.contains(path))
                .cloned()
                .collect(),
            unknown: present
                .iter()
                .filter(|path| channel.leaves().all(|leaf| leaf.path != **path))
                .cloned()
                .collect(),
        }
    }

    /// Whether there are no differences.
    pub fn is_empty(&self) -> bool {
        self.missing.is_empty() && self.unknown.is_empty()
    }
}

/// The members of a message or of an object in it, by their keys: names in JSON, numbers in protobuf.
#[derive(Clone, Debug, Default)]
pub(super) struct Object<K>(pub(super) Vec<(K, Storage<K>)>);

/// The storage place of a member.
#[derive(Clone, Debug)]
pub(super) enum Storage<K> {
    Seconds,
    Nanoseconds,
    Number(usize),
    Text(usize),
    Object(Object<K>),
    /// Ignored.
    Skipped,
}

impl<K> Storage<K> {
    /// The storage place of the field at `path` in a channel's messages.
    pub(super) fn for_field(channel: &ChannelInfo, path: &str) -> Self {
        if let Some(index) = channel.number_index(path) {
            return Self::Number(index);
        }
        channel
            .texts
            .iter()
            .position(|text| text.path == path)
            .map_or(Self::Skipped, Self::Text)
    }
}

impl<K> Object<K> {
    /// The position of the member whose key satisfies `is`; `next` is tried first.
    #[inline]
    pub(super) fn position(&self, next: usize, is: impl Fn(&K) -> bool) -> Option<usize> {
        // Writers keep the order of the fields, so the member after the last one is nearly always the next. Both encodings
        // allow any order.
        if self.0.get(next).is_some_and(|(key, _)| is(key)) {
            return Some(next);
        }
        self.0.iter().position(|(key, _)| is(key))
    }
}

/// Maximum total length of the field paths of a schema, bytes.
const MAX_PATHS_LENGTH: usize = 1 << 16;

/// The paths of the fields of a file's schema.
///
/// Nested types expand exponentially, so a malicious schema of a few hundred bytes could exhaust memory.
#[derive(Debug, Default)]
pub(super) struct Paths {
    /// Paths of the leaves.
    pub(super) leaves: Vec<String>,
    bytes: usize,
}

impl Paths {
    /// Counts a field before it is expanded.
    pub(super) fn count(&mut self, path: &str) -> Result<(), SchemaError> {
        self.bytes += path.len() + 1;
        if self.bytes <= MAX_PATHS_LENGTH {
            return Ok(());
        }
        Err(SchemaError::TooManyPaths)
    }
}
