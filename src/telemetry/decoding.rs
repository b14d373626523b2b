//! Shared parts of all decoders: the rows that they fill, their errors, and the shape of a message.

use super::channel::ChannelInfo;
use thiserror::Error;

/// A decoded message; used again for the next one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Its timestamp, ns.
    pub time_ns: u64,
    /// Its numbers in the order of the channel's; NaN for those that it doesn't have.
    pub numbers: Vec<f64>,
    /// Its texts in the order of the channel's; empty for those that it doesn't have.
    pub texts: Vec<String>,
}

impl Row {
    /// Makes room for the leaves of a channel.
    pub(super) fn clear(&mut self, channel: &ChannelInfo) {
        self.time_ns = 0;
        self.numbers.clear();
        self.numbers.resize(channel.numbers.len(), f64::NAN);
        self.texts.resize(channel.texts.len(), String::new());
        self.texts.iter_mut().for_each(String::clear);
    }
}

/// The reason why a channel or message of a file can't be decoded.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum DecodeError {
    /// An encoding that is neither JSON nor protobuf.
    #[error("messages are encoded as {0:?}; json and protobuf can be read")]
    Encoding(String),
    /// The schema of the channel can't be read.
    #[error("its schema can't be read: {0}")]
    Schema(String),
    /// The message is not what its encoding demands.
    #[error("not a {encoding} message: {reason}")]
    Malformed {
        /// The encoding.
        encoding: &'static str,
        /// The reason.
        reason: String,
    },
    /// The message's timestamp is not the time at which the file logs it.
    #[error("its timestamp is {stamp_ns} ns")]
    Timestamp {
        /// The timestamp, ns.
        stamp_ns: u64,
    },
    /// The message has other fields than its schema.
    #[error("{found} of {expected} fields of its schema are there, and {unknown} others")]
    Fields {
        /// Fields of the schema that are there.
        found: usize,
        /// Fields of the schema.
        expected: usize,
        /// Fields that the schema doesn't have.
        unknown: usize,
    },
}

/// In what a channel of a file differs from the table's: the file is from another version.
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
        let known = |path: &String| channel.leaves().any(|leaf| leaf.path == *path);
        Self {
            missing: channel
                .leaves()
                .filter(|leaf| !present.contains(&leaf.path))
                .map(|leaf| leaf.path.clone())
                .collect(),
            unknown: present
                .iter()
                .filter(|path| !known(path))
                .cloned()
                .collect(),
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.missing.is_empty() && self.unknown.is_empty()
    }
}

/// The members of a message or of an object in it, by their keys: names in JSON, numbers in protobuf.
#[derive(Clone, Debug, Default)]
pub(super) struct Object<K>(pub(super) Vec<(K, Target<K>)>);

/// The destination of a member.
#[derive(Clone, Debug)]
pub(super) enum Target<K> {
    Seconds,
    Nanoseconds,
    Number(usize),
    Text(usize),
    Object(Object<K>),
    /// Nowhere.
    Skipped,
}

impl<K> Object<K> {
    /// The place of the member whose key `is` it; members mostly come in order, so at `next`.
    #[inline]
    pub(super) fn position(&self, next: usize, is: impl Fn(&K) -> bool) -> Option<usize> {
        let is_at = |position: &usize| self.0.get(*position).is_some_and(|(key, _)| is(key));
        Some(next)
            .filter(is_at)
            .or_else(|| (0..self.0.len()).find(is_at))
    }
}

/// The paths of all fields of a file's schema may take this number of bytes together.
const LARGEST_PATHS: usize = 1 << 16;

/// The paths of the fields that a file's schema describes.
///
/// Types within types unfold with the power of their depth: a few hundred bytes can describe more fields
/// than fit into memory.
#[derive(Debug, Default)]
pub(super) struct Paths {
    /// The leaves'.
    pub(super) leaves: Vec<String>,
    bytes: usize,
}

impl Paths {
    /// Counts a field, before it is unfolded.
    pub(super) fn count(&mut self, path: &str) -> Result<(), DecodeError> {
        self.bytes += path.len() + 1;
        if self.bytes <= LARGEST_PATHS {
            return Ok(());
        }
        let reason = format!("its fields unfold to more than {LARGEST_PATHS} bytes");
        Err(DecodeError::Schema(reason))
    }
}
