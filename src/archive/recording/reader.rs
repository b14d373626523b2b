//! Reading messages in the order of the file, a section at a time.

use super::file::Recording;
use super::order::{Misplaced, Order};
use crate::archive::container::channels::FileChannel;
use crate::archive::container::loss::Loss;
use crate::archive::container::section::{Buffers, MessageRecord, Section, record_at, times};
use crate::archive::error::MessageError;
use crate::telemetry::encoding::{DecodeError, Decoder, Row};
use crate::telemetry::{Message, Topic, Topics};
use mcap::records::op;
use std::vec;

/// Selection of messages.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// Only these topics.
    pub topics: Topics<String>,
    /// From this time on, ns.
    pub from_ns: Option<u64>,
    /// Up to this time, ns.
    pub to_ns: Option<u64>,
}

impl Selection {
    /// Whether it may have messages in a time span, ns.
    fn wants_span(&self, (first, last): (u64, u64)) -> bool {
        self.from_ns.is_none_or(|from| from <= last) && self.to_ns.is_none_or(|to| first <= to)
    }
}

/// A raw message of any channel.
#[derive(Clone, Copy, Debug)]
pub struct Undecoded<'a> {
    /// Its channel.
    pub channel: &'a FileChannel,
    /// Index of its channel in the recording.
    pub position: usize,
    /// Sequence number.
    pub sequence: u32,
    /// Time of logging, ns.
    pub log_time: u64,
    /// Time of publishing, ns.
    pub publish_time: u64,
    /// Its bytes.
    pub data: &'a [u8],
}

/// Maximum total size of overlapping sections that are sorted together, bytes.
const LARGEST_BATCH: usize = 1 << 26;

/// Limit of decompressed content: this many bytes plus `LARGEST_GROWTH` times the file size.
const LARGEST_CONTENT: u64 = 1 << 26;
const LARGEST_GROWTH: u64 = 1000;

/// Reads the messages of a recording from start to end.
///
/// Holds one chunk in memory, or several if chunks overlap in time and order matters. Unreadable parts are skipped and
/// listed by [`Reader::losses`].
#[derive(Debug)]
pub struct Reader<'r> {
    recording: &'r Recording,
    selection: Selection,
    /// The sections that are still to be read, in batches.
    batches: vec::IntoIter<Vec<usize>>,
    buffers: Buffers,
    /// The records of the batch that is being read.
    records: Vec<u8>,
    /// Positions of the selected messages, and the number already returned.
    starts: Vec<u32>,
    given: usize,
    /// Treatment of each of the file's channels.
    plans: Vec<Plan>,
    row: Row,
    losses: Vec<Loss>,
    order: Option<Order>,
    /// Bytes of decompressed content that may still be read; what is beyond is reported as a loss (decompression bombs).
    left: u64,
    /// Number of bytes that have been read, and of those that have been reported.
    seen: u64,
    reported: u64,
}

/// Treatment of the messages of a channel.
#[derive(Debug)]
enum Plan {
    Leave,
    /// Return raw messages.
    Raw,
    Decode {
        topic: Topic,
        decoder: Result<Box<Decoder>, DecodeError>,
    },
}

impl Recording {
    /// A reader for some of its messages.
    pub fn reader(&self, selection: Selection) -> Reader<'_> {
        Reader::new(self, selection)
    }
}

impl<'r> Reader<'r> {
    pub(super) fn new(recording: &'r Recording, selection: Selection) -> Self {
        let plan = |channel: &FileChannel| {
            if !selection.topics.include(&channel.topic) {
                return Plan::Leave;
            }
            match (channel.table, channel.decoder()) {
                (Some(topic), Some(decoder)) => Plan::Decode {
                    topic,
                    decoder: decoder.map(Box::new),
                },
                _ => Plan::Raw,
            }
        };
        let batches = (0..recording.layout.sections.len()).map(|section| vec![section]);
        let growth = recording.size().saturating_mul(LARGEST_GROWTH);
        Self {
            batches: batches.collect::<Vec<_>>().into_iter(),
            plans: recording.channels().iter().map(plan).collect(),
            recording,
            selection,
            buffers: Buffers::default(),
            records: Vec::new(),
            starts: Vec::new(),
            given: 0,
            row: Row::default(),
            losses: Vec::new(),
            order: None,
            left: LARGEST_CONTENT.saturating_add(growth),
            seen: 0,
            reported: 0,
        }
    }

    /// Returns the messages in time order.
    ///
    /// Chunks are sorted, and messages within them. Late or repeated messages are skipped and counted by
    /// [`Reader::left_out`].
    pub(crate) fn in_order_of_time(mut self) -> Self {
        if !self.are_sections_in_order() {
            self.batches = self.batches_by_time().into_iter();
        }
        self.order = Some(Order::new(self.recording));
        self
    }

    /// The messages that have been left out because they repeat others or go back in time.
    pub(crate) fn left_out(&self) -> Option<&Misplaced> {
        self.order.as_ref()?.misplaced()
    }

    /// Whether the time spans of the chunks, per their headers, are in order.
    fn are_sections_in_order(&self) -> bool {
        let mut last = 0;
        self.recording.layout.sections.iter().all(|section| {
            section.span.is_some_and(|(start, end)| {
                let follows = last <= start;
                last = end;
                follows
            })
        })
    }

    /// The sections by the times of their messages, with those that overlap in one batch.
    ///
    /// Chunk header times have no checksum; if they are out of order, message times are used.
    fn batches_by_time(&self) -> Vec<Vec<usize>> {
        let mut buffers = Buffers::default();
        let mut found = Vec::new();
        let mut last = 0;
        let mut left = self.left;
        for (index, section) in self.recording.layout.sections.iter().enumerate() {
            let is_read = left > 0 && section.load(&self.recording.source, &mut buffers).is_ok();
            let span = is_read.then(|| times(&buffers.records)).flatten();
            left = left.saturating_sub(buffers.records.len() as u64);
            // Unreadable sections keep their position.
            let (start, end) = span.unwrap_or((last, last));
            last = start;
            found.push((start, end, buffers.records.len(), index));
        }
        found.sort_by_key(|(start, ..)| *start);
        let mut batches: Vec<Vec<usize>> = Vec::new();
        let (mut batch_end, mut batch_size) = (0, 0);
        for (start, end, size, index) in found {
            match batches.last_mut() {
                Some(batch) if start <= batch_end && batch_size + size <= LARGEST_BATCH => {
                    batch.push(index);
                    batch_end = end.max(batch_end);
                    batch_size += size;
                }
                _ => {
                    batches.push(vec![index]);
                    (batch_end, batch_size) = (end, size);
                }
            }
        }
        // Foreign messages with equal times keep the file order.
        for batch in &mut batches {
            batch.sort_unstable();
        }
        batches
    }

    /// Parts that could not be read so far; complete once the reader has come to its end.
    pub fn losses(&self) -> &[Loss] {
        &self.losses
    }

    /// The next message of a channel of the table, decoded; messages of other channels are skipped.
    ///
    /// An error concerns one message; reading can continue.
    #[allow(clippy::should_implement_trait)] // the message borrows from the reader
    pub fn next(&mut self) -> Option<Result<Message<'_>, MessageError>> {
        loop {
            let at = self.advance()?;
            if matches!(self.plans[at.channel], Plan::Decode { .. }) {
                return self.decode(&at);
            }
        }
    }

    /// Decodes a message of a channel of the table.
    fn decode(&mut self, at: &At) -> Option<Result<Message<'_>, MessageError>> {
        let Plan::Decode { topic, decoder } = &self.plans[at.channel] else {
            return None;
        };
        let (sequence, time_ns) = (at.head.sequence, at.head.log_time);
        let mut decoded = match decoder {
            Ok(decoder) => decoder.decode(at.raw(&self.records).data, &mut self.row),
            Err(error) => Err(error.clone()),
        };
        let stamp = self.row.time_ns;
        if decoded.is_ok() && stamp != time_ns {
            let reason = format!("its timestamp, {stamp} ns, differs from its log time");
            decoded = Err(DecodeError(reason));
        }
        Some(match decoded {
            Ok(()) => Ok(Message {
                channel: topic.index(),
                sequence,
                time_ns,
                numbers: &self.row.numbers,
                texts: &self.row.texts,
            }),
            Err(reason) => Err(MessageError {
                topic: topic.name(),
                sequence,
                time_ns,
                reason,
            }),
        })
    }

    /// Number of bytes that have been read since the last call.
    pub fn progress(&mut self) -> u64 {
        let more = self.seen - self.reported;
        self.reported = self.seen;
        more
    }

    /// The next message as stored in the file, from any channel.
    pub fn next_undecoded(&mut self) -> Option<Undecoded<'_>> {
        let at = self.advance()?;
        let raw = at.raw(&self.records);
        Some(Undecoded {
            channel: &self.recording.channels()[at.channel],
            position: at.channel,
            sequence: raw.sequence,
            log_time: raw.log_time,
            publish_time: raw.publish_time,
            data: raw.data,
        })
    }

    /// Finds the next selected message.
    fn advance(&mut self) -> Option<At> {
        loop {
            let Some(start) = self.starts.get(self.given) else {
                self.load_next()?;
                continue;
            };
            self.given += 1;
            let Some(at) = self.message_at(*start as usize) else {
                continue;
            };
            let order = self.order.as_mut();
            let is_in_order = order
                .is_none_or(|order| order.accepts(at.channel, at.head.log_time, at.head.sequence));
            if is_in_order {
                return Some(at);
            }
        }
    }

    /// The message that starts at a position of the records.
    fn message_at(&self, start: usize) -> Option<At> {
        let (record, end) = record_at(&self.records, start)?.ok()?;
        let head = MessageRecord::parse(&record)?.without_data();
        Some(At {
            channel: self.recording.layout.channels.position(head.channel_id)?,
            start,
            end,
            head,
        })
    }

    /// Loads the next batch that may have selected messages.
    fn load_next(&mut self) -> Option<()> {
        let batch = self.batches.next()?;
        self.records.clear();
        self.starts.clear();
        self.given = 0;
        let recording = self.recording;
        let sections = &recording.layout.sections;
        for section in batch.iter().map(|index| &sections[*index]) {
            // Not if chunks are out of order.
            self.seen = self.seen.max(section.offset + section.length);
            let is_unwanted = |span| !self.selection.wants_span(span);
            if section.span.is_some_and(is_unwanted) {
                continue;
            }
            if self.left == 0 {
                self.losses.push(Loss {
                    offset: section.offset,
                    length: recording.size() - section.offset,
                    is_unread: true,
                    reason: format!(
                        "the content before it already exceeds {LARGEST_GROWTH} times the file size"
                    ),
                    ..Loss::default()
                });
                self.batches = Vec::new().into_iter();
                return None;
            }
            match section.load(&recording.source, &mut self.buffers) {
                Ok(()) => {
                    let length = self.buffers.records.len() as u64;
                    self.left = self.left.saturating_sub(length);
                    self.take_section(section);
                }
                Err(error) => self.lose(section, error.to_string()),
            }
        }
        let mut starts = std::mem::take(&mut self.starts);
        if let Some(order) = &self.order {
            let at = |start: &u32| self.message_at(*start as usize);
            let time = |start: &u32| at(start).map(|at| at.head.log_time);
            let rank = |start: &u32| at(start).map(|at| order.rank(at.channel, &at.head));
            if !starts.is_sorted_by_key(time) {
                starts.sort_by_key(rank);
            }
        }
        self.starts = starts;
        Some(())
    }

    /// Adds the records of a section that has been loaded, and finds the selected messages in them.
    fn take_section(&mut self, section: &Section) {
        let mut position = self.records.len();
        if position == 0 {
            std::mem::swap(&mut self.records, &mut self.buffers.records);
        } else {
            self.records.extend_from_slice(&self.buffers.records);
        }
        while let Some(next) = record_at(&self.records, position) {
            let (record, end) = match next {
                Ok(found) => found,
                Err(reason) => return self.lose(section, reason.to_owned()),
            };
            let start = std::mem::replace(&mut position, end);
            if record.opcode != op::MESSAGE {
                continue;
            }
            let Some(message) = MessageRecord::parse(&record) else {
                self.lose(section, "truncated message header".to_owned());
                continue;
            };
            let Some(channel) = self.recording.layout.channels.position(message.channel_id) else {
                let reason = format!("undefined channel {}", message.channel_id);
                return self.lose(section, reason);
            };
            let is_wanted = !matches!(self.plans[channel], Plan::Leave)
                && self
                    .selection
                    .wants_span((message.log_time, message.log_time));
            if is_wanted && let Ok(start) = u32::try_from(start) {
                self.starts.push(start);
            }
        }
    }

    /// Records a loss in a section.
    fn lose(&mut self, section: &Section, reason: String) {
        // At most one loss per section.
        let last = self.losses.last();
        if last.is_some_and(|loss| loss.offset == section.offset) {
            return;
        }
        self.losses.push(Loss {
            offset: section.offset,
            length: section.length,
            from_ns: section.span.map(|(from, _)| from),
            to_ns: section.span.map(|(_, to)| to),
            is_unread: false,
            reason,
        });
    }
}

/// A message within the batch that is being read.
struct At {
    /// Position of its channel in the file's list.
    channel: usize,
    start: usize,
    end: usize,
    head: MessageRecord<'static>,
}

impl At {
    fn raw<'a>(&self, records: &'a [u8]) -> MessageRecord<'a> {
        MessageRecord {
            data: &records[self.start + MessageRecord::HEAD..self.end],
            ..self.head
        }
    }
}
