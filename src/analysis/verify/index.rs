//! The index of a file: it leads to everything in the data, and agrees with them.
//!
//! Readers differ in what they follow, the data or the index. A file that contradicts itself would show them different things.

use super::difference::Difference;
use crate::archive::container::layout::summary_checksum;
use crate::archive::container::record::{HEAD, RecordSpan, content_length, parse};
use crate::archive::container::scan::{Found, Scanner};
use crate::archive::container::section::{Buffers, MessageRecord, Section, record_at};
use crate::archive::container::source::Source;
use crate::archive::recording::Recording;
use mcap::MAGIC;
use mcap::records::{
    AttachmentIndex, ChunkIndex, Footer, MessageIndex, MessageIndexEntry, MetadataIndex, Record,
    Statistics, SummaryOffset, op,
};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Debug;
use std::{io, mem};

/// First bytes of a frame of each compression.
const ZSTD_MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];
const LZ4_MAGIC: [u8; 4] = [0x04, 0x22, 0x4d, 0x18];

type Checked = Result<(), Difference>;

/// Whether a file ends as those with an index do. What is cut off has none to contradict its data.
pub(super) fn is_there(recording: &Recording) -> bool {
    let end = recording.size().saturating_sub(MAGIC.len() as u64);
    let mut bytes = Vec::new();
    let read = recording.source.read(end, MAGIC.len() as u64, &mut bytes);
    read.is_ok() && bytes == MAGIC
}

/// The first contradiction in a whole file.
pub(super) fn index_difference(recording: &Recording) -> Option<Difference> {
    Survey::default().run(&recording.source).err()
}

fn fault(place: &RecordSpan, found: &str) -> Difference {
    let place = format!("the record at byte {}", place.offset);
    Difference::of(&place, "", Some(found.to_owned()), None)
}

/// Expected and found index entries.
fn equal<T: Debug + PartialEq>(place: &str, found: &T, expected: &T) -> Checked {
    if found == expected {
        return Ok(());
    }
    // Enough to see the difference in numbers; the contents of schemas are long.
    let text = |value: &T| Some(format!("{value:?}").chars().take(300).collect());
    Err(Difference::of(place, "", text(found), text(expected)))
}

impl From<io::Error> for Difference {
    fn from(error: io::Error) -> Self {
        Self::of("the file", "", Some(error.to_string()), None)
    }
}

/// State of a pass through a file.
#[derive(Default)]
struct Survey {
    buffers: Buffers,
    /// The summary that the data demand and the one that is there, as text.
    expected: BTreeSet<String>,
    found: Vec<String>,
    statistics: Statistics,
    /// Schemas and channels that have been defined: opcode and id.
    defined: BTreeSet<(u8, u16)>,
    /// The last chunk, until the indexes behind it are over, and its messages that were not indexed yet.
    chunk: Option<ChunkIndex>,
    messages: BTreeMap<u16, Vec<MessageIndexEntry>>,
    /// The groups of the summary as they stand there, and as its offsets name them.
    groups: Vec<SummaryOffset>,
    named: Vec<SummaryOffset>,
    /// The beginnings of the summary, once the data are over, and of its offsets.
    summary: Option<u64>,
    offsets: u64,
}

impl Survey {
    fn run(mut self, source: &Source) -> Checked {
        let mut scanner = Scanner::new(source);
        let mut bytes = Vec::new();
        while let Some(Found::Record(place)) = scanner.next()? {
            source.read(place.offset, place.length, &mut bytes)?;
            let body = bytes.get(HEAD as usize..).unwrap_or_default();
            let record = read(&place, place.opcode, body)?;
            if let Record::Footer(footer) = record {
                return self.finish(&place, footer, source);
            }
            self.take(&place, record, source)?;
        }
        Err(io::Error::from(io::ErrorKind::UnexpectedEof).into())
    }

    fn take(&mut self, place: &RecordSpan, record: Record<'_>, source: &Source) -> Checked {
        if place.opcode != op::MESSAGE_INDEX {
            self.close_chunk()?;
        }
        match (self.summary, record) {
            (None, Record::Header(_)) if place.offset == MAGIC.len() as u64 => {}
            (None, record @ (Record::Schema { .. } | Record::Channel(_))) => {
                self.define(place, &record)?;
            }
            (None, Record::Metadata(metadata)) => {
                self.statistics.metadata_count += 1;
                self.expect(&Record::MetadataIndex(MetadataIndex {
                    offset: place.offset,
                    length: place.length,
                    name: metadata.name,
                }));
            }
            (None, Record::Attachment { header, data, crc }) if crc != 0 => {
                self.statistics.attachment_count += 1;
                self.expect(&Record::AttachmentIndex(AttachmentIndex {
                    offset: place.offset,
                    length: place.length,
                    log_time: header.log_time,
                    create_time: header.create_time,
                    data_size: data.len() as u64,
                    name: header.name,
                    media_type: header.media_type,
                }));
            }
            (None, Record::Chunk { header, data })
                if header.uncompressed_crc != 0 && is_one_frame(&header.compression, &data) =>
            {
                self.chunk = Some(ChunkIndex {
                    message_start_time: header.message_start_time,
                    message_end_time: header.message_end_time,
                    chunk_start_offset: place.offset,
                    chunk_length: place.length,
                    message_index_offsets: BTreeMap::new(),
                    message_index_length: 0,
                    compression: header.compression,
                    compressed_size: header.compressed_size,
                    uncompressed_size: header.uncompressed_size,
                });
                let times = (header.message_start_time, header.message_end_time);
                self.take_chunk(place, times, source)?;
            }
            (None, Record::MessageIndex(index)) => self.take_message_index(place, &index)?,
            (None, Record::DataEnd(end)) => {
                // 0 is none, as other programs leave it: chunks have checksums of their own.
                if end.data_section_crc != 0 {
                    let sum = source.checksum(0, place.offset)?;
                    equal("the checksum of the data", &end.data_section_crc, &sum)?;
                }
                self.summary = Some(place.end());
            }
            (Some(_), Record::SummaryOffset(offset)) => {
                if self.named.is_empty() {
                    self.offsets = place.offset;
                }
                self.named.push(offset);
            }
            (
                Some(_),
                mut record @ (Record::Schema { .. }
                | Record::Channel(_)
                | Record::Statistics(_)
                | Record::ChunkIndex(_)
                | Record::AttachmentIndex(_)
                | Record::MetadataIndex(_)),
            ) => {
                if let Record::Statistics(statistics) = &mut record {
                    // Some writers count channels without messages, too.
                    statistics
                        .channel_message_counts
                        .retain(|_, count| *count > 0);
                }
                self.found.push(format!("{record:?}"));
                self.group(place)?;
            }
            _ => return Err(fault(place, "a record that doesn't belong there")),
        }
        Ok(())
    }

    fn expect(&mut self, record: &Record<'_>) {
        self.expected.insert(format!("{record:?}"));
    }

    /// Takes in a schema or a channel in the data. A chunk holds no other records but messages.
    fn define(&mut self, place: &RecordSpan, record: &Record<'_>) -> Checked {
        let (id, needs) = match record {
            Record::Schema { header, .. } => (header.id, 0),
            Record::Channel(channel) => (channel.id, channel.schema_id),
            _ => return Err(fault(place, "a record that doesn't belong into a chunk")),
        };
        let is_schema = record.opcode() == op::SCHEMA;
        let has_schema = needs == 0 || self.defined.contains(&(op::SCHEMA, needs));
        // Zero stands for no schema.
        if !has_schema || (is_schema && id == 0) {
            return Err(fault(place, "a channel without its schema"));
        }
        if self.defined.insert((record.opcode(), id)) {
            self.statistics.schema_count += u16::from(is_schema);
            self.statistics.channel_count += u32::from(!is_schema);
        }
        self.expect(record);
        Ok(())
    }

    fn take_chunk(&mut self, place: &RecordSpan, times: (u64, u64), source: &Source) -> Checked {
        self.statistics.chunk_count += 1;
        let section = Section::of_chunk(place, source)?;
        let mut buffers = mem::take(&mut self.buffers);
        let loaded = section.load(source, &mut buffers);
        loaded.map_err(|error| fault(place, &error.to_string()))?;
        let mut at = 0;
        let mut span: Option<(u64, u64)> = None;
        while let Some(next) = record_at(&buffers.records, at) {
            let (inner, end) = next.map_err(|reason| fault(place, reason))?;
            if let Some(message) = MessageRecord::parse(&inner) {
                let (channel, time) = (message.channel_id, message.log_time);
                if !self.defined.contains(&(op::CHANNEL, channel)) {
                    return Err(fault(place, "a message without its channel"));
                }
                let entries = self.messages.entry(channel).or_default();
                entries.push(MessageIndexEntry {
                    log_time: time,
                    offset: at as u64,
                });
                let (first, last) = span.unwrap_or((time, time));
                span = Some((first.min(time), last.max(time)));
            } else {
                self.define(place, &read(place, inner.opcode, inner.body)?)?;
            }
            at = end;
        }
        self.buffers = buffers;
        equal("the times of a chunk", &times, &span.unwrap_or_default())?;
        if let Some((first, last)) = span {
            let statistics = &mut self.statistics;
            let is_first = statistics.message_count == 0;
            let start = statistics.message_start_time;
            statistics.message_start_time = if is_first { first } else { start.min(first) };
            statistics.message_end_time = statistics.message_end_time.max(last);
        }
        for (channel, entries) in &self.messages {
            let count = entries.len() as u64;
            self.statistics.message_count += count;
            let counts = &mut self.statistics.channel_message_counts;
            *counts.entry(*channel).or_default() += count;
        }
        Ok(())
    }

    fn take_message_index(&mut self, place: &RecordSpan, index: &MessageIndex) -> Checked {
        let entries = self.messages.remove(&index.channel_id).unwrap_or_default();
        let Some(chunk) = self.chunk.as_mut().filter(|_| !entries.is_empty()) else {
            return Err(fault(place, "an index of nothing"));
        };
        let offsets = &mut chunk.message_index_offsets;
        offsets.insert(index.channel_id, place.offset);
        chunk.message_index_length += place.length;
        equal("the index of a chunk", &index.records, &entries)
    }

    /// The indexes behind the last chunk are over.
    fn close_chunk(&mut self) -> Checked {
        let indexed = BTreeMap::new();
        equal("messages without an index", &self.messages, &indexed)?;
        if let Some(chunk) = self.chunk.take() {
            self.expect(&Record::ChunkIndex(chunk));
        }
        Ok(())
    }

    /// Adds a record of the summary to its group; each kind has one.
    fn group(&mut self, place: &RecordSpan) -> Checked {
        let opcode = place.opcode;
        let known = self.groups.iter().position(|g| g.group_opcode == opcode);
        match known {
            None => self.groups.push(SummaryOffset {
                group_opcode: opcode,
                group_start: place.offset,
                group_length: place.length,
            }),
            Some(at) if at + 1 == self.groups.len() => self.groups[at].group_length += place.length,
            Some(_) => return Err(fault(place, "a record apart from its group")),
        }
        Ok(())
    }

    /// Compares the summary with what the data demand.
    fn finish(mut self, place: &RecordSpan, footer: Footer, source: &Source) -> Checked {
        let statistics = mem::take(&mut self.statistics);
        self.expect(&Record::Statistics(statistics));
        self.found.sort_unstable();
        for (found, expected) in self.found.iter().zip(&self.expected) {
            equal("the summary", found, expected)?;
        }
        let count = self.expected.len();
        equal(
            "the number of records in the summary",
            &self.found.len(),
            &count,
        )?;
        let by_kind = |offset: &SummaryOffset| offset.group_opcode;
        self.groups.sort_by_key(by_kind);
        self.named.sort_by_key(by_kind);
        equal("the groups of the summary", &self.named, &self.groups)?;
        let expected = Footer {
            summary_start: self.summary.unwrap_or_default(),
            summary_offset_start: self.offsets,
            summary_crc: summary_checksum(place, &footer, source)?,
        };
        equal("the footer", &footer, &expected)?;
        let behind = source.length() - place.end();
        equal("bytes behind the footer", &behind, &(MAGIC.len() as u64))
    }
}

/// Reads a record without trailing bytes.
fn read<'a>(place: &RecordSpan, opcode: u8, body: &'a [u8]) -> Result<Record<'a>, Difference> {
    let record = parse(opcode, body).map_err(|error| fault(place, &error.to_string()))?;
    match content_length(&record) {
        Some(length) if length == body.len() => Ok(record),
        Some(_) => Err(fault(place, "more than is read of it")),
        None => Err(fault(place, "a record of another kind")),
    }
}

/// Whether a chunk is compressed as one frame, which takes all of its data. Of several frames some readers see all, and
/// some the first.
fn is_one_frame(compression: &str, data: &[u8]) -> bool {
    match compression {
        "zstd" => {
            let length = zstd::zstd_safe::find_frame_compressed_size(data);
            data.starts_with(&ZSTD_MAGIC) && length == Ok(data.len())
        }
        "lz4" => {
            let mut decoder = lz4_flex::frame::FrameDecoder::new(data);
            let read = io::copy(&mut decoder, &mut io::sink());
            data.starts_with(&LZ4_MAGIC) && read.is_ok() && decoder.get_ref().is_empty()
        }
        _ => true,
    }
}
