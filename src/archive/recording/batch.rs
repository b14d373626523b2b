//! Messages that are in memory together.

use crate::archive::container::section::{MessageRecord, record_at};
use std::mem;

/// Messages that have been loaded.
#[derive(Debug, Default)]
pub(super) struct LoadedMessages {
    /// Records, among them the messages.
    pub(super) records: Vec<u8>,
    pub(super) entries: Vec<BatchEntry>,
}

/// A message of a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct BatchEntry {
    /// The time by which it is read, ns: see [`Relogged`](super::clock::Relogged).
    pub(super) time_ns: u64,
    /// Index of the section.
    pub(super) section: u32,
    /// Start of the record in the batch.
    pub(super) start: u32,
}

impl LoadedMessages {
    pub(super) fn clear(&mut self) {
        self.records.clear();
        self.entries.clear();
    }

    /// Drops the messages after a time, and their records.
    pub(super) fn drop_after(&mut self, time_ns: u64) {
        let mut end = 0;
        let records = &mut self.records;
        self.entries.retain_mut(|entry| {
            let start = entry.start as usize;
            let length = record_at(records, start)
                .and_then(Result::ok)
                .map_or(0, |(_, end)| end - start);
            let is_kept = entry.time_ns <= time_ns;
            if is_kept {
                records.copy_within(start..start + length, end);
                entry.start = end as u32;
                end += length;
            }
            is_kept
        });
        self.records.truncate(end);
    }

    /// Adds the messages of another batch.
    pub(super) fn append(&mut self, other: &Self) {
        for entry in &other.entries {
            let start = entry.start as usize;
            if let Some(Ok((_, end))) = record_at(&other.records, start) {
                self.entries.push(BatchEntry {
                    start: self.records.len() as u32,
                    ..*entry
                });
                self.records.extend_from_slice(&other.records[start..end]);
            }
        }
    }

    /// Takes the messages from a time on. Their records are copied, the others keep their places.
    pub(super) fn split_off(&mut self, from_ns: u64) -> Self {
        let (late, early) = mem::take(&mut self.entries)
            .into_iter()
            .partition(|entry| entry.time_ns >= from_ns);
        self.entries = late;
        let mut rest = Self::default();
        rest.append(self);
        self.entries = early;
        rest
    }

    /// Head and data of a message.
    pub(super) fn message(&self, entry: &BatchEntry) -> Option<MessageRecord<'_>> {
        let (record, _) = record_at(&self.records, entry.start as usize)?.ok()?;
        let message = MessageRecord::parse(&record)?;
        Some(MessageRecord {
            time_ns: entry.time_ns,
            ..message
        })
    }
}
