//! Checks that the index of a file is complete and agrees with its data.
//!
//! Some readers use the data, others the index; an inconsistent file would look different to them.

use super::difference::Difference;
use crate::archive::container::record::{HEAD, RecordSpan, fields_length, parse};
use crate::archive::container::scan::{Found, Scanner};
use crate::archive::container::section::{Buffers, MessageRecord, Section, record_at, times};
use crate::archive::container::source::Source;
use crate::archive::recording::Recording;
use mcap::MAGIC;
use mcap::records::{
    AttachmentIndex, ChunkHeader, ChunkIndex, Footer, MessageIndex, MessageIndexEntry,
    MetadataIndex, Record, Statistics, SummaryOffset, op,
};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Debug;
use std::{io, mem};

/// The first bytes of a frame of lz4.
const LZ4_MAGIC: [u8; 4] = [0x04, 0x22, 0x4d, 0x18];

type Checked = Result<(), Difference>;

/// The first inconsistency of a complete file.
pub(super) fn index_difference(recording: &Recording) -> Option<Difference> {
    Survey::default().run(&recording.source).err()
}

fn fault(place: &RecordSpan, found: &str) -> Difference {
    let place = format!("the record at byte {}", place.offset);
    Difference::of(&place, "", [Some(found.to_owned()), None])
}

/// Expected and found index entries.
fn equal<T: Debug + PartialEq>(place: &str, found: &T, expected: &T) -> Checked {
    if found == expected {
        return Ok(());
    }
    // Enough to see the difference in numbers; the contents of schemas are long.
    let text = |value: &T| Some(format!("{value:?}").chars().take(300).collect());
    Err(Difference::of(place, "", [found, expected].map(text)))
}

impl From<io::Error> for Difference {
    fn from(error: io::Error) -> Self {
        Self::of("the file", "", [Some(error.to_string()), None])
    }
}

/// State of a pass through a file.
#[derive(Default)]
struct Survey {
    /// Summary records that the data require and that have not been found yet, as text.
    expected: BTreeSet<String>,
    statistics: Statistics,
    /// The times of the first and the last message.
    span: Option<(u64, u64)>,
    /// Schemas and channels that have been defined: opcode and id.
    defined: BTreeSet<(u8, u16)>,
    /// The current chunk with its messages that are not indexed yet.
    chunk: Option<ChunkIndex>,
    messages: BTreeMap<u16, Vec<MessageIndexEntry>>,
    /// The start of the summary, once the data section has ended.
    summary: Option<u64>,
    /// Summary groups without an offset so far, by opcode, and the start of the offsets.
    groups: BTreeMap<u8, SummaryOffset>,
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
            match (self.summary, record) {
                (_, Record::Footer(footer)) => return self.finish(&place, footer, source),
                (None, record) => self.take(&place, record, source)?,
                (Some(_), record) => self.take_summary(&place, record)?,
            }
        }
        Err(io::Error::from(io::ErrorKind::UnexpectedEof).into())
    }

    /// Processes a record of the data.
    fn take(&mut self, place: &RecordSpan, record: Record<'_>, source: &Source) -> Checked {
        if place.opcode != op::MESSAGE_INDEX {
            self.close_chunk()?;
        }
        match record {
            Record::Header(_) if place.offset == MAGIC.len() as u64 => {}
            Record::Metadata(metadata) => {
                self.statistics.metadata_count += 1;
                self.expect(&Record::MetadataIndex(MetadataIndex {
                    offset: place.offset,
                    length: place.length,
                    name: metadata.name,
                }));
            }
            Record::Attachment { header, data, crc } if crc != 0 => {
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
            Record::Chunk { header, data }
                if header.uncompressed_crc != 0 && is_one_frame(&header.compression, &data) =>
            {
                self.take_chunk(place, header, source)?;
            }
            Record::MessageIndex(index) => self.take_message_index(place, &index)?,
            Record::DataEnd(end) => {
                // 0 means no checksum; chunks have their own.
                if end.data_section_crc != 0 {
                    let sum = source.checksum(0, place.offset)?;
                    equal("the checksum of the data", &end.data_section_crc, &sum)?;
                }
                self.end_data();
                self.summary = Some(place.end());
            }
            _ => return Err(fault(place, "an unexpected record")),
        }
        Ok(())
    }

    /// Expects a record in the summary. Returns whether it was not expected before.
    fn expect(&mut self, record: &Record<'_>) -> bool {
        self.expected.insert(format!("{record:?}"))
    }

    /// Processes a schema or channel in the data. Apart from these, a chunk contains only messages.
    fn define(&mut self, place: &RecordSpan, record: &Record<'_>) -> Checked {
        // Zero means no schema.
        let is_there = |id: u16| id == 0 || self.defined.contains(&(op::SCHEMA, id));
        let id = match record {
            Record::Schema { header, .. } if header.id != 0 => header.id,
            Record::Channel(channel) if is_there(channel.schema_id) => channel.id,
            _ => return Err(fault(place, "an invalid record in a chunk")),
        };
        let is_new = self.defined.insert((record.opcode(), id));
        if self.expect(record) && !is_new {
            return Err(fault(place, "two different definitions with one id"));
        }
        Ok(())
    }

    fn take_chunk(&mut self, place: &RecordSpan, header: ChunkHeader, source: &Source) -> Checked {
        self.statistics.chunk_count += 1;
        let mut buffers = Buffers::default();
        let loaded = Section::of_chunk(place, source)?.load(source, &mut buffers);
        loaded.map_err(|error| fault(place, &error.to_string()))?;
        let mut at = 0;
        while let Some(next) = record_at(&buffers.records, at) {
            let (inner, end) = next.map_err(|reason| fault(place, reason))?;
            if let Some(message) = MessageRecord::parse(&inner) {
                let (channel, log_time) = (message.channel_id, message.log_time);
                if !self.defined.contains(&(op::CHANNEL, channel)) {
                    return Err(fault(place, "a message without its channel"));
                }
                let offset = at as u64;
                let entries = self.messages.entry(channel).or_default();
                entries.push(MessageIndexEntry { log_time, offset });
            } else {
                self.define(place, &read(place, inner.opcode, inner.body)?)?;
            }
            at = end;
        }
        for (channel, entries) in &self.messages {
            let counts = &mut self.statistics.channel_message_counts;
            *counts.entry(*channel).or_default() += entries.len() as u64;
        }
        let (start, end) = (header.message_start_time, header.message_end_time);
        let found = times(&buffers.records);
        equal(
            "the times of a chunk",
            &(start, end),
            &found.unwrap_or_default(),
        )?;
        if found.is_some() {
            let (first, last) = self.span.unwrap_or((start, end));
            self.span = Some((first.min(start), last.max(end)));
        }
        self.chunk = Some(ChunkIndex {
            message_start_time: start,
            message_end_time: end,
            chunk_start_offset: place.offset,
            chunk_length: place.length,
            message_index_offsets: BTreeMap::new(),
            message_index_length: 0,
            compression: header.compression,
            compressed_size: header.compressed_size,
            uncompressed_size: header.uncompressed_size,
        });
        Ok(())
    }

    fn take_message_index(&mut self, place: &RecordSpan, index: &MessageIndex) -> Checked {
        let entries = self.messages.remove(&index.channel_id).unwrap_or_default();
        let Some(chunk) = self.chunk.as_mut().filter(|_| !entries.is_empty()) else {
            return Err(fault(place, "an index without a chunk"));
        };
        let offsets = &mut chunk.message_index_offsets;
        offsets.insert(index.channel_id, place.offset);
        chunk.message_index_length += place.length;
        equal("the index of a chunk", &index.records, &entries)
    }

    /// Finishes the index of the last chunk.
    fn close_chunk(&mut self) -> Checked {
        equal(
            "messages without an index",
            &self.messages,
            &BTreeMap::new(),
        )?;
        if let Some(chunk) = self.chunk.take() {
            self.expect(&Record::ChunkIndex(chunk));
        }
        Ok(())
    }

    /// Expects the statistics of the data, which are complete now.
    fn end_data(&mut self) {
        let mut statistics = mem::take(&mut self.statistics);
        let is_schema = |(opcode, _): &&(u8, u16)| *opcode == op::SCHEMA;
        let schemas = self.defined.iter().filter(is_schema).count();
        statistics.schema_count = schemas as u16;
        statistics.channel_count = (self.defined.len() - schemas) as u32;
        statistics.message_count = statistics.channel_message_counts.values().sum();
        let (first, last) = self.span.unwrap_or_default();
        statistics.message_start_time = first;
        statistics.message_end_time = last;
        self.expect(&Record::Statistics(statistics));
    }

    /// Processes a record of the summary. Each kind forms a group; offsets follow the groups that they refer to.
    fn take_summary(&mut self, place: &RecordSpan, mut record: Record<'_>) -> Checked {
        if let Record::SummaryOffset(offset) = record {
            if self.offsets == 0 {
                self.offsets = place.offset;
            }
            let group = self.groups.remove(&offset.group_opcode);
            return equal("the groups of the summary", &Some(offset), &group);
        }
        if let Record::Statistics(statistics) = &mut record {
            // Some writers count channels without messages, too.
            let counts = &mut statistics.channel_message_counts;
            counts.retain(|_, count| *count > 0);
        }
        if !self.expected.remove(&format!("{record:?}")) {
            return Err(fault(place, "a record that doesn't match the data"));
        }
        let group = self.groups.entry(place.opcode).or_insert(SummaryOffset {
            group_opcode: place.opcode,
            group_start: place.offset,
            group_length: 0,
        });
        if group.group_start + group.group_length != place.offset {
            return Err(fault(place, "a record apart from its group"));
        }
        group.group_length += place.length;
        Ok(())
    }

    /// Checks that nothing is missing, and checks the end of the file.
    fn finish(self, place: &RecordSpan, footer: Footer, source: &Source) -> Checked {
        if let Some(missing) = self.expected.first() {
            let kind = missing.split('(').next().unwrap_or_default();
            let simulated = Some(format!("a {kind} record"));
            return Err(Difference::of("the summary", "", [None, simulated]));
        }
        equal("the groups of the summary", &BTreeMap::new(), &self.groups)?;
        let expected = Footer {
            summary_start: self.summary.unwrap_or_default(),
            summary_offset_start: self.offsets,
            // The checksum includes opcode, length and the two offsets.
            summary_crc: source.checksum(footer.summary_start, place.offset + HEAD + 16)?,
        };
        equal("the footer", &footer, &expected)?;
        let behind = source.length() - place.end();
        equal("bytes after the footer", &behind, &(MAGIC.len() as u64))
    }
}

/// Reads a record without trailing bytes.
fn read<'a>(place: &RecordSpan, opcode: u8, body: &'a [u8]) -> Result<Record<'a>, Difference> {
    if fields_length(opcode, body) != Some(body.len() as u64) {
        return Err(fault(place, "trailing bytes"));
    }
    parse(opcode, body).map_err(|error| fault(place, &error.to_string()))
}

/// Whether a chunk is compressed as one frame, which takes all of its data. With several frames, some readers read only
/// the first.
fn is_one_frame(compression: &str, data: &[u8]) -> bool {
    match compression {
        "zstd" => zstd::zstd_safe::find_frame_compressed_size(data) == Ok(data.len()),
        "lz4" => {
            let mut decoder = lz4_flex::frame::FrameDecoder::new(data);
            let read = io::copy(&mut decoder, &mut io::sink());
            data.starts_with(&LZ4_MAGIC) && read.is_ok() && decoder.get_ref().is_empty()
        }
        _ => true,
    }
}
