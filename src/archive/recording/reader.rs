//! Reading messages in the order of the file, a section at a time.

use super::file::Recording;
use crate::archive::container::channels::FileChannel;
use crate::archive::container::loss::{Loss, Span};
use crate::archive::container::section::{Buffers, MessageRecord, Section, record_at};
use crate::archive::error::MessageError;
use crate::telemetry::encoding::{DecodeError, Decoder, Row};
use crate::telemetry::{ChannelInfo, Message, Topic, Topics};
use mcap::records::op;
use std::ops::Range;

/// Which messages to read.
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
    fn wants_time(&self, time_ns: u64) -> bool {
        self.from_ns.is_none_or(|from| from <= time_ns) && self.to_ns.is_none_or(|to| time_ns <= to)
    }

    fn wants_span(&self, (first, last): (u64, u64)) -> bool {
        self.from_ns.is_none_or(|from| from <= last) && self.to_ns.is_none_or(|to| first <= to)
    }
}

/// A message of any channel, as it stands in the file.
#[derive(Clone, Copy, Debug)]
pub struct Undecoded<'a> {
    /// Its channel.
    pub channel: &'a FileChannel,
    /// Where that stands among the channels of the recording.
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

/// A message of a channel of the table, or of another.
#[derive(Clone, Copy, Debug)]
pub enum Any<'a> {
    /// Of the table.
    Decoded(Message<'a>),
    /// Of another channel.
    Other(Undecoded<'a>),
}

/// Reads the messages of a recording from start to end.
///
/// It holds one chunk in memory. Parts of the file that can't be read are left out and told by
/// [`Reader::losses`].
#[derive(Debug)]
pub struct Reader<'r> {
    recording: &'r Recording,
    selection: Selection,
    /// The sections that are to be read, and how many of them have been.
    sections: Vec<usize>,
    read: usize,
    buffers: Buffers,
    /// Where the next record starts in the section that is being read.
    position: usize,
    /// What to do with the messages of each of the file's channels.
    plans: Vec<Plan>,
    row: Row,
    losses: Vec<Loss>,
    /// How much of the progress has been told, bytes.
    told: u64,
}

/// What to do with the messages of a channel.
#[derive(Debug)]
enum Plan {
    Leave,
    /// Give them undecoded.
    Raw,
    Decode {
        channel: usize,
        info: &'static ChannelInfo,
        decoder: Result<Box<Decoder>, DecodeError>,
    },
}

impl Recording {
    /// A reader for some of its messages.
    #[must_use]
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
            match (channel.table, channel.info(), channel.decoder()) {
                (Some(table), Some(info), Some(decoder)) => Plan::Decode {
                    channel: table.index(),
                    info,
                    decoder: decoder.map(Box::new),
                },
                _ => Plan::Raw,
            }
        };
        Self {
            sections: (0..recording.layout.sections.len()).collect(),
            read: 0,
            plans: recording.channels().iter().map(plan).collect(),
            recording,
            selection,
            buffers: Buffers::default(),
            position: 0,
            row: Row::default(),
            losses: Vec::new(),
            told: 0,
        }
    }

    /// Restricts it to some of the sections.
    pub(super) fn within(mut self, sections: Range<usize>) -> Self {
        self.sections = sections.collect();
        self
    }

    /// Reads the chunks in the order of their times, wherever they stand.
    ///
    /// The times in the heads of chunks have no checksum: where they are not in order, those of the
    /// messages count.
    pub(crate) fn in_order_of_time(mut self) -> Self {
        let sections = &self.recording.layout.sections;
        let noted = |section: &usize| sections[*section].span.map(|(start, _)| start);
        if !self.sections.is_sorted_by_key(noted) {
            let mut last = 0;
            let mut starts = Vec::new();
            for section in &self.sections {
                // What can't be read stays where it is.
                last = self.first_time(*section).unwrap_or(last);
                starts.push((last, *section));
            }
            starts.sort_by_key(|(start, _)| *start);
            self.sections = starts.into_iter().map(|(_, section)| section).collect();
        }
        self
    }

    /// The time of the first message in a section.
    fn first_time(&self, section: usize) -> Option<u64> {
        let mut buffers = Buffers::default();
        let section = &self.recording.layout.sections[section];
        section.load(&self.recording.source, &mut buffers).ok()?;
        let mut position = 0;
        while let Some(Ok((inner, next))) = record_at(&buffers.records, position) {
            if let Some(message) = MessageRecord::parse(&inner) {
                return Some(message.log_time);
            }
            position = next;
        }
        None
    }

    /// Decodes only some numbers of a channel.
    pub(super) fn only(mut self, topic: Topic, numbers: &[usize]) -> Self {
        for plan in &mut self.plans {
            match plan {
                Plan::Decode {
                    channel,
                    decoder: Ok(decoder),
                    ..
                } if *channel == topic.index() => **decoder = decoder.only(numbers),
                _ => {}
            }
        }
        self
    }

    /// What could not be read so far; complete once the reader has come to its end.
    #[must_use]
    pub fn losses(&self) -> &[Loss] {
        &self.losses
    }

    /// The next message of a channel of the table, decoded; messages of other channels are passed over.
    ///
    /// After an error reading can go on: it is about one message.
    #[allow(clippy::should_implement_trait)] // the message borrows from the reader
    pub fn next(&mut self) -> Option<Result<Message<'_>, MessageError>> {
        loop {
            let at = self.advance()?;
            if matches!(self.plans[at.channel], Plan::Decode { .. }) {
                return self.decode(&at);
            }
        }
    }

    /// The next message, decoded if its channel is of the table.
    ///
    /// After an error reading can go on: it is about one message.
    pub fn next_of_any(&mut self) -> Option<Result<Any<'_>, MessageError>> {
        let at = self.advance()?;
        if !matches!(self.plans[at.channel], Plan::Decode { .. }) {
            return Some(Ok(Any::Other(self.undecoded(&at))));
        }
        Some(self.decode(&at)?.map(Any::Decoded))
    }

    fn decode(&mut self, at: &At) -> Option<Result<Message<'_>, MessageError>> {
        let Plan::Decode {
            channel,
            info,
            decoder,
        } = &self.plans[at.channel]
        else {
            return None;
        };
        let raw = at.raw(&self.buffers.records);
        let decoded = match decoder {
            Ok(decoder) => decoder.decode(raw.data, &mut self.row),
            Err(error) => Err(error.clone()),
        };
        let decoded = decoded.and_then(|()| {
            let stamp_ns = self.row.time_ns;
            if stamp_ns == raw.log_time {
                Ok(())
            } else {
                Err(DecodeError::Timestamp { stamp_ns })
            }
        });
        Some(match decoded {
            Ok(()) => Ok(Message {
                channel: *channel,
                sequence: raw.sequence,
                time_ns: raw.log_time,
                numbers: &self.row.numbers,
                texts: &self.row.texts,
            }),
            Err(reason) => Err(MessageError {
                topic: info.topic,
                sequence: raw.sequence,
                time_ns: raw.log_time,
                reason,
            }),
        })
    }

    fn undecoded(&self, at: &At) -> Undecoded<'_> {
        let raw = at.raw(&self.buffers.records);
        Undecoded {
            channel: &self.recording.channels()[at.channel],
            position: at.channel,
            sequence: raw.sequence,
            log_time: raw.log_time,
            publish_time: raw.publish_time,
            data: raw.data,
        }
    }

    /// How many bytes of the file have been looked at since this was asked last.
    pub fn progress(&mut self) -> u64 {
        let last = self.current();
        let offset = last.map_or(0, |section| section.offset + section.length);
        // Where chunks are out of order, it goes back.
        let more = offset.saturating_sub(self.told);
        self.told = self.told.max(offset);
        more
    }

    /// The section that is being read.
    fn current(&self) -> Option<&'r Section> {
        let index = self.sections.get(self.read.checked_sub(1)?)?;
        Some(&self.recording.layout.sections[*index])
    }

    /// The next message as it stands in the file, whatever its channel.
    pub fn next_undecoded(&mut self) -> Option<Undecoded<'_>> {
        let at = self.advance()?;
        Some(self.undecoded(&at))
    }

    /// Finds the next message that is wanted.
    fn advance(&mut self) -> Option<At> {
        loop {
            match record_at(&self.buffers.records, self.position) {
                None => self.load_next()?,
                Some(Err(reason)) => {
                    self.lose(reason.to_owned());
                    self.buffers.records.clear();
                }
                Some(Ok((inner, next))) => {
                    let start = std::mem::replace(&mut self.position, next);
                    if inner.opcode != op::MESSAGE {
                        continue;
                    }
                    let Some(raw) = MessageRecord::parse(&inner) else {
                        self.lose("a message in it is shorter than its head".to_owned());
                        continue;
                    };
                    let Some(channel) = self.recording.layout.channels.position(raw.channel_id)
                    else {
                        let reason = format!("nothing is known of its channel {}", raw.channel_id);
                        self.lose(reason);
                        self.buffers.records.clear();
                        continue;
                    };
                    if !matches!(self.plans[channel], Plan::Leave)
                        && self.selection.wants_time(raw.log_time)
                    {
                        return Some(At {
                            channel,
                            start,
                            head: raw.without_data(),
                            end: next,
                        });
                    }
                }
            }
        }
    }

    /// Loads the next section that may have wanted messages.
    fn load_next(&mut self) -> Option<()> {
        loop {
            let index = *self.sections.get(self.read)?;
            self.read += 1;
            let section = &self.recording.layout.sections[index];
            if section
                .span
                .is_some_and(|span| !self.selection.wants_span(span))
            {
                continue;
            }
            self.position = 0;
            match section.load(&self.recording.source, &mut self.buffers) {
                Ok(()) => return Some(()),
                Err(error) => {
                    self.buffers.records.clear();
                    self.lose(error.to_string());
                }
            }
        }
    }

    /// Notes that something of the section is lost.
    fn lose(&mut self, reason: String) {
        let Some(section) = self.current() else {
            return;
        };
        // A chunk decompresses to a thousand times its size: not each of its records is a loss of its own.
        let last = self.losses.last();
        if last.is_some_and(|loss| loss.offset == section.offset) {
            return;
        }
        self.losses.push(Loss {
            offset: section.offset,
            length: section.length,
            span: section.span.map(|(from_ns, to_ns)| Span {
                from_ns,
                to_ns: Some(to_ns),
            }),
            reason,
        });
    }
}

/// A message within the section that is being read.
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
