//! Messages that are in memory together.

use crate::archive::container::section::{MessageRecord, record_at};

/// Messages that have been loaded.
#[derive(Debug, Default)]
pub(super) struct Batch {
    /// Records, among them the messages.
    pub(super) records: Vec<u8>,
    pub(super) entries: Vec<Entry>,
}

/// A message of a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Entry {
    /// Log time, ns.
    pub(super) time_ns: u64,
    /// Index of the section.
    pub(super) section: u32,
    /// Start of the record in the batch.
    pub(super) start: u32,
}

impl Batch {
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

    /// Head and data of a message.
    pub(super) fn message(&self, entry: &Entry) -> Option<MessageRecord<'_>> {
        let (record, _) = record_at(&self.records, entry.start as usize)?.ok()?;
        MessageRecord::parse(&record)
    }
}
