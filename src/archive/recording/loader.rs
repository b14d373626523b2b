//! Loads a recording's messages in batches: section by section, or in order of time.

mod position;
mod records;

use self::position::Position;
use super::batch::{BatchEntry, LoadedMessages};
use super::clock::Stamps;
use super::file::Recording;
use super::order::MessageOrder;
use super::selection::Selection;
use super::statistics::MessageTally;
use super::windows::{Span, Window, Windows};
use crate::archive::container::loss::Losses;
use crate::archive::container::section::{Buffers, FileSection, MessageRecord};
use crate::telemetry::Topics;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::mem;
use std::ops::Range;

/// Limit of decompressed content: this many bytes plus `MAX_GROWTH` times the file size.
const MIN_CONTENT: u64 = 1 << 26;
const MAX_GROWTH: u64 = 1000;

/// Loads messages in batches.
#[derive(Debug)]
pub(super) struct Loader<'r> {
    recording: &'r Recording,
    selection: Selection,
    /// For each channel of the file, whether its messages are selected.
    is_wanted: Vec<bool>,
    /// Reads the time stamps of messages that were logged at other times.
    stamps: Option<Stamps>,
    /// Whether messages are sorted by their times; otherwise they keep the order of the file.
    is_sorted: bool,
    plan: Plan,
    buffers: Buffers,
    batch: LoadedMessages,
    /// Messages that are sorted together with those of the next section, which starts at their time.
    held: LoadedMessages,
    /// Maximum size of messages that are sorted together, bytes.
    max_window: usize,
    /// The number of messages of the batch that have been returned.
    returned: usize,
    losses: Losses,
    /// Offsets of the sections with losses.
    lost: BTreeSet<u64>,
    /// Whether sections are being read for the first time.
    is_first_pass: bool,
    /// The second definition of each channel that has one, by the channel's position in the file's list.
    redefined: BTreeMap<usize, Position>,
    /// Bytes of decompressed content that may still be read; what is beyond is reported as a loss (decompression bombs).
    bytes_left: u64,
    /// The messages of all channels that have been read.
    pub(super) tally: MessageTally,
    /// Number of bytes of the file that have been read.
    pub(super) bytes_read: u64,
}

/// The sections that are still to be read.
#[derive(Debug)]
enum Plan {
    /// One section after the other.
    Sections(Range<usize>),
    /// Sections that overlap in time, in windows of time.
    Windows(Windows),
}

/// A message of the batch that is being read.
pub(super) struct FoundMessage {
    /// Position of the channel in the file's list.
    pub(super) channel: usize,
    /// The record in the batch.
    pub(super) entry: BatchEntry,
}

/// For each channel of the file, whether its topic is selected.
fn wanted_channels(recording: &Recording, topics: &Topics<String>) -> Vec<bool> {
    let channels = recording.channels();
    match topics {
        Topics::All => vec![true; channels.len()],
        Topics::Only(topics) => {
            // There may be 65,535 channels and as many topics, so neither list is searched for each of the other.
            let topics = BTreeSet::from_iter(topics);
            channels
                .iter()
                .map(|channel| topics.contains(&channel.topic))
                .collect()
        }
    }
}

impl<'r> Loader<'r> {
    pub(super) fn new(recording: &'r Recording, selection: Selection) -> Self {
        let growth = recording.size().saturating_mul(MAX_GROWTH);
        Self {
            is_wanted: wanted_channels(recording, &selection.topics),
            plan: Plan::Sections(0..recording.layout.sections.len()),
            stamps: recording
                .relogged()
                .map(|relogged| Stamps::new(recording, relogged)),
            recording,
            selection,
            is_sorted: false,
            buffers: Buffers::default(),
            batch: LoadedMessages::default(),
            held: LoadedMessages::default(),
            max_window: 0,
            returned: 0,
            losses: Losses::default(),
            lost: BTreeSet::new(),
            is_first_pass: true,
            redefined: BTreeMap::new(),
            bytes_left: MIN_CONTENT.saturating_add(growth),
            tally: MessageTally::default(),
            bytes_read: 0,
        }
    }

    /// Loads the messages in order of time. Overlapping sections are sorted in windows of at most `max_window` bytes.
    pub(super) fn sort_by_time(&mut self, max_window: usize) {
        self.is_sorted = true;
        self.max_window = max_window;
        if !self.are_sections_in_order() {
            let spans = self.find_spans();
            self.is_first_pass = false;
            self.plan = Plan::Windows(Windows::new(spans, max_window));
        }
    }

    pub(super) fn losses(&self) -> &Losses {
        &self.losses
    }

    /// Finds the next message. `order` ranks messages of the same time.
    pub(super) fn next(&mut self, order: Option<&MessageOrder>) -> Option<FoundMessage> {
        loop {
            let Some(entry) = self.batch.entries.get(self.returned).copied() else {
                self.load_next(order)?;
                continue;
            };
            self.returned += 1;
            let id = self.batch.message(&entry)?.channel_id;
            // Always found: `scan_records` leaves out messages of undefined channels.
            if let Some(channel) = self.recording.layout.channels.position(id) {
                return Some(FoundMessage { channel, entry });
            }
        }
    }

    /// Head and data of a message that was found in the current batch.
    pub(super) fn message(&self, found: &FoundMessage) -> Option<MessageRecord<'_>> {
        self.batch.message(&found.entry)
    }

    /// The time span of a section's messages according to its header, which has log times.
    fn span(&self, section: &FileSection) -> Option<(u64, u64)> {
        section.span.filter(|_| self.stamps.is_none())
    }

    /// Whether the time spans of the chunks, according to their headers, follow each other.
    fn are_sections_in_order(&self) -> bool {
        let mut last = 0;
        self.recording.layout.sections.iter().all(|section| {
            self.span(section).is_some_and(|(start, end)| {
                let follows = last <= start;
                last = end;
                follows
            })
        })
    }

    /// The time spans of the selected messages in all sections, by reading them: the times in a chunk's header have no
    /// checksum of their own.
    fn find_spans(&mut self) -> Vec<Span> {
        let sections = &self.recording.layout.sections;
        let mut spans = Vec::new();
        for (index, section) in sections.iter().enumerate() {
            if !self.load(section) {
                continue;
            }
            let mut times: Option<(u64, u64)> = None;
            self.scan(section, |time, _| {
                let (first, last) = times.unwrap_or((time, time));
                times = Some((first.min(time), last.max(time)));
            });
            if let Some((first, last)) = times {
                spans.push(Span {
                    first,
                    last,
                    section: index as u32,
                });
            }
        }
        spans
    }

    /// Loads the next batch.
    fn load_next(&mut self, order: Option<&MessageOrder>) -> Option<()> {
        self.batch.clear();
        self.returned = 0;
        match &mut self.plan {
            Plan::Sections(sections) => {
                let index = sections.next()?;
                self.load_section(index);
                if self.is_sorted {
                    self.hold_back(index);
                }
            }
            Plan::Windows(_) => self.load_window()?,
        }
        if self.is_sorted {
            self.sort(order);
        }
        Some(())
    }

    /// Loads all selected messages of a section.
    fn load_section(&mut self, index: usize) {
        let section = &self.recording.layout.sections[index];
        self.bytes_read = section.offset + section.length;
        // The memory of the last section is used again: with two of them, large chunks would take twice their size.
        mem::swap(&mut self.batch.records, &mut self.buffers.records);
        // The times in a chunk's header spare reading it.
        if self
            .span(section)
            .is_some_and(|span| !self.selection.wants_span(span))
            || !self.load(section)
        {
            return;
        }
        let mut entries = mem::take(&mut self.batch.entries);
        self.scan(section, |time_ns, record| {
            entries.push(BatchEntry {
                time_ns,
                section: index as u32,
                start: record.start as u32,
            });
        });
        self.batch.entries = entries;
        mem::swap(&mut self.batch.records, &mut self.buffers.records);
    }

    /// Adds the messages that were held back to those of a section, and holds back those at the time at which the next
    /// section starts: a writer may end a chunk between the topics of a sample. Beyond the limit of memory they keep the
    /// order of the file.
    fn hold_back(&mut self, index: usize) {
        self.batch.append(&mem::take(&mut self.held));
        let sections = &self.recording.layout.sections;
        let Some((from_ns, _)) = sections.get(index + 1).and_then(|next| next.span) else {
            return;
        };
        let held = self.batch.split_off(from_ns);
        if held.records.len() > self.max_window {
            self.batch.append(&held);
        } else {
            self.held = held;
        }
    }

    /// Loads the messages of the next window of time.
    fn load_window(&mut self) -> Option<()> {
        let Plan::Windows(windows) = &mut self.plan else {
            return None;
        };
        let mut windows = mem::take(windows);
        let mut batch = mem::take(&mut self.batch);
        let loaded = windows.load_next(&mut batch, &mut |section, window, batch| {
            self.append(section, window, batch);
        });
        // Sections are read several times, so their bytes say nothing about the progress.
        self.bytes_read = (self.recording.size() as f64 * windows.progress()) as u64;
        self.batch = batch;
        self.plan = Plan::Windows(windows);
        loaded
    }

    /// Adds a section's messages of a window to a batch.
    fn append(&mut self, index: u32, window: Window, batch: &mut LoadedMessages) {
        let section = &self.recording.layout.sections[index as usize];
        // It was read before, so this can only fail if the file is being changed.
        if let Err(error) = section.load(&self.recording.source, &mut self.buffers) {
            return self.report_loss(section, error.to_string());
        }
        let records = mem::take(&mut self.buffers.records);
        self.scan_records(section, &records, |time_ns, record| {
            if window.includes(time_ns) {
                batch.entries.push(BatchEntry {
                    time_ns,
                    section: index,
                    start: batch.records.len() as u32,
                });
                batch.records.extend_from_slice(&records[record]);
            }
        });
        self.buffers.records = records;
    }

    /// Sorts the batch by time. Messages of the same time are ranked by `order`, then in the order of the file.
    fn sort(&mut self, order: Option<&MessageOrder>) {
        let mut entries = mem::take(&mut self.batch.entries);
        // Most files are sorted, and a check takes linear time.
        if !entries.is_sorted_by(|a, b| self.compare(order, a, b).is_le()) {
            entries.sort_unstable_by(|a, b| self.compare(order, a, b));
        }
        self.batch.entries = entries;
    }

    fn compare(&self, order: Option<&MessageOrder>, a: &BatchEntry, b: &BatchEntry) -> Ordering {
        // Ranks need the head of the message, which only messages of the same time are worth.
        a.time_ns
            .cmp(&b.time_ns)
            .then_with(|| self.rank(order, a).cmp(&self.rank(order, b)))
            .then_with(|| a.cmp(b))
    }

    /// Rank of a message among those of the same time; all are equal without an order.
    fn rank(&self, order: Option<&MessageOrder>, entry: &BatchEntry) -> Option<(usize, u32)> {
        let order = order?;
        let message = self.batch.message(entry)?;
        let channel = self
            .recording
            .layout
            .channels
            .position(message.channel_id)?;
        order.rank(channel, &message)
    }

    /// Loads a section for the first time, within the limit of content. Returns whether it can be read.
    fn load(&mut self, section: &FileSection) -> bool {
        if self.bytes_left == 0 {
            self.report_rest(section);
            return false;
        }
        let loaded = section.load(&self.recording.source, &mut self.buffers);
        let length = self.buffers.records.len() as u64;
        self.bytes_left = self.bytes_left.saturating_sub(length);
        if let Err(error) = loaded {
            self.report_loss(section, error.to_string());
            return false;
        }
        self.tally.count_section();
        true
    }

    /// Calls `take` with time and place of each selected message of the section that has been loaded.
    fn scan(&mut self, section: &FileSection, take: impl FnMut(u64, Range<usize>)) {
        let records = mem::take(&mut self.buffers.records);
        self.scan_records(section, &records, take);
        self.buffers.records = records;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mcap::records::MessageHeader;
    use std::fs::File;
    use std::io::BufWriter;

    #[test]
    fn large_chunks_are_in_memory_once() {
        const SIZE: usize = 8 << 20;
        let path = tempfile::NamedTempFile::new().unwrap().into_temp_path();
        let file = BufWriter::new(File::create(&path).unwrap());
        let options = mcap::WriteOptions::new().compression(None);
        let mut writer = options.create(file).unwrap();
        let id = writer
            .add_channel(0, "/a", "json", &BTreeMap::new())
            .unwrap();
        for sequence in 0..3_u32 {
            let header = MessageHeader {
                channel_id: id,
                sequence,
                log_time: u64::from(sequence),
                publish_time: 0,
            };
            writer
                .write_to_known_channel(&header, &vec![b'1'; SIZE])
                .unwrap();
            writer.flush().unwrap();
        }
        writer.finish().unwrap();
        let recording = Recording::open(&path).unwrap();
        assert_eq!(recording.layout.sections.len(), 3);
        let mut loader = Loader::new(&recording, Selection::default());
        loader.sort_by_time(SIZE);
        let mut read = 0;
        while loader.next(None).is_some() {
            read += 1;
            let Buffers { raw, records } = &loader.buffers;
            let memory = raw.capacity() + records.capacity() + loader.batch.records.capacity();
            assert!(memory < SIZE + SIZE / 2, "{memory} bytes");
        }
        assert_eq!(read, 3);
    }
}
