//! Shared parts of the decoders: rows, errors, message structure.

use super::channel::ChannelInfo;
use std::fmt::Display;
use thiserror::Error;

/// A decoded message (reusable buffer).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Its timestamp, ns.
    pub time_ns: u64,
    /// Its numbers in the order of the channel's; NaN for missing ones.
    pub numbers: Vec<f64>,
    /// Its texts in the order of the channel's; empty for missing ones.
    pub texts: Vec<String>,
}

impl Row {
    /// Empties the row and resizes it for a channel.
    pub(super) fn clear(&mut self, channel: &ChannelInfo) {
        self.time_ns = 0;
        self.numbers.clear();
        self.numbers.resize(channel.numbers.len(), f64::NAN);
        self.texts.resize(channel.texts.len(), String::new());
        self.texts.iter_mut().for_each(String::clear);
    }

    /// Adds a part of the timestamp, ns, if it is in range. A repeated part is added, which eventually fails.
    #[inline]
    pub(super) fn add_time(&mut self, part_ns: Option<u64>) -> Result<(), &'static str> {
        let time = part_ns.and_then(|part| self.time_ns.checked_add(part));
        self.time_ns = time.ok_or("its timestamp is out of range")?;
        Ok(())
    }
}

/// Error of decoding a channel or message of a file, as a text.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct DecodeError(pub(crate) String);

impl DecodeError {
    /// The schema of the channel can't be read.
    pub(super) fn of_schema(reason: impl Display) -> Self {
        Self(format!("its schema can't be read: {reason}"))
    }
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
        let known = |path: &String| channel.leaves().any(|leaf| leaf.path == *path);
        let paths = channel.leaves().map(|leaf| &leaf.path);
        let missing = paths.filter(|path| !present.contains(path));
        let unknown = present.iter().filter(|path| !known(path));
        Self {
            missing: missing.cloned().collect(),
            unknown: unknown.cloned().collect(),
        }
    }

    /// Whether there are no differences.
    pub fn is_empty(&self) -> bool {
        self.missing.is_empty() && self.unknown.is_empty()
    }
}

/// The members of a message or of an object in it, by their keys: names in JSON, numbers in protobuf.
#[derive(Clone, Debug, Default)]
pub(super) struct Object<K>(pub(super) Vec<(K, Target<K>)>);

/// The storage place of a member.
#[derive(Clone, Debug)]
pub(super) enum Target<K> {
    Seconds,
    Nanoseconds,
    Number(usize),
    Text(usize),
    Object(Object<K>),
    /// Ignored.
    Skipped,
}

impl<K> Target<K> {
    /// That of the field at `path` in a channel's messages.
    pub(super) fn of(channel: &ChannelInfo, path: &str) -> Self {
        let text = || channel.texts.iter().position(|text| text.path == path);
        match channel.number_index(path) {
            Some(index) => Self::Number(index),
            None => text().map_or(Self::Skipped, Self::Text),
        }
    }
}

impl<K> Object<K> {
    /// The position of the member whose key satisfies `is`; `next` is tried first.
    #[inline]
    pub(super) fn position(&self, next: usize, is: impl Fn(&K) -> bool) -> Option<usize> {
        let is_at = |position: &usize| self.0.get(*position).is_some_and(|(key, _)| is(key));
        Some(next)
            .filter(is_at)
            .or_else(|| (0..self.0.len()).find(is_at))
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
    pub(super) fn count(&mut self, path: &str) -> Result<(), DecodeError> {
        self.bytes += path.len() + 1;
        if self.bytes <= MAX_PATHS_LENGTH {
            return Ok(());
        }
        let reason = format!("its field paths exceed {MAX_PATHS_LENGTH} bytes");
        Err(DecodeError::of_schema(reason))
    }
}
