//! One record of an MCAP file: where it stands, and what is in it.

use super::source::Source;
use mcap::records::{Record, op};
use mcap::{McapError, McapResult};
use std::collections::BTreeMap;
use std::io;

/// Length of a record's opcode and length field.
pub(crate) const HEAD: u64 = 9;

/// The place of a top-level record in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct RecordSpan {
    /// Kind of the record.
    pub(crate) opcode: u8,
    /// Its start.
    pub(crate) offset: u64,
    /// Its length with opcode and length field.
    pub(crate) length: u64,
}

impl RecordSpan {
    /// The position behind it.
    pub(crate) fn end(&self) -> u64 {
        self.offset + self.length
    }
}

/// Opcode and length of the body.
pub(crate) fn head(bytes: &[u8]) -> Option<(u8, u64)> {
    let length = bytes.get(1..9)?.try_into().ok()?;
    let length = u64::from_le_bytes(length);
    (length < 1 << 62).then_some((bytes[0], length))
}

/// Opcodes of the specification, and those left to applications.
pub(crate) fn is_known(opcode: u8) -> bool {
    (op::HEADER..=op::DATA_END).contains(&opcode) || opcode >= 0x80
}

/// Reads a record.
///
/// `mcap` takes memory for a text before it looks whether the text is there, up to 4 GiB of it, and panics
/// at an attachment that ends behind its head: such records are refused before.
pub(crate) fn parse(opcode: u8, body: &[u8]) -> McapResult<Record<'_>> {
    behind_texts(opcode, body).ok_or(McapError::UnexpectedEof)?;
    mcap::parse_record(opcode, body)
}

/// The length of a record's body that what is read of it takes; none for kinds that are not those of the specification. A
/// longer body holds something that is not read: bytes behind the last field, or a key twice.
pub(crate) fn content_length(record: &Record<'_>) -> Option<usize> {
    let text = |text: &str| 4 + text.len();
    let texts = |pairs: &BTreeMap<String, String>| {
        let pairs = pairs.iter().map(|(key, value)| text(key) + text(value));
        4 + pairs.sum::<usize>()
    };
    Some(match record {
        Record::Header(header) => text(&header.profile) + text(&header.library),
        Record::Schema { header, data } => {
            2 + text(&header.name) + text(&header.encoding) + 4 + data.len()
        }
        Record::Channel(channel) => {
            4 + text(&channel.topic) + text(&channel.message_encoding) + texts(&channel.metadata)
        }
        Record::Message { data, .. } => 22 + data.len(),
        Record::Chunk { header, data } => 36 + text(&header.compression) + data.len(),
        Record::MessageIndex(index) => 6 + 16 * index.records.len(),
        Record::ChunkIndex(index) => {
            60 + 10 * index.message_index_offsets.len() + text(&index.compression)
        }
        Record::Attachment { header, data, .. } => {
            28 + text(&header.name) + text(&header.media_type) + data.len()
        }
        Record::AttachmentIndex(index) => 40 + text(&index.name) + text(&index.media_type),
        Record::Metadata(metadata) => text(&metadata.name) + texts(&metadata.metadata),
        Record::MetadataIndex(index) => 16 + text(&index.name),
        Record::Statistics(statistics) => 46 + 10 * statistics.channel_message_counts.len(),
        Record::SummaryOffset(_) => 17,
        Record::DataEnd(_) => 4,
        Record::Footer(_) => 20,
        Record::Unknown { .. } => return None,
    })
}

/// A part of a record.
enum Part {
    Bytes(usize),
    Text,
    /// Pairs of texts.
    Texts,
    /// Pairs of a channel's id and a position.
    Positions,
}

/// Content after the last text of a record; none if a text or what must follow is not there.
fn behind_texts(opcode: u8, body: &[u8]) -> Option<&[u8]> {
    use Part::{Bytes, Positions, Text, Texts};
    let parts: &[Part] = match opcode {
        op::HEADER => &[Text, Text],
        op::SCHEMA => &[Bytes(2), Text, Text],
        op::CHANNEL => &[Bytes(4), Text, Text, Texts],
        op::CHUNK => &[Bytes(28), Text],
        op::CHUNK_INDEX => &[Bytes(32), Positions, Bytes(8), Text],
        op::ATTACHMENT => &[Bytes(16), Text, Text, Bytes(12)],
        op::ATTACHMENT_INDEX => &[Bytes(40), Text, Text],
        op::METADATA => &[Text, Texts],
        op::METADATA_INDEX => &[Bytes(16), Text],
        _ => &[],
    };
    let mut rest = body;
    for part in parts {
        rest = match part {
            Bytes(count) => rest.get(*count..)?,
            Text => behind_text(rest)?,
            Texts => {
                let (length, mut pairs) = length(rest)?;
                let end = pairs.len().checked_sub(length)?;
                while pairs.len() > end {
                    pairs = behind_text(behind_text(pairs)?)?;
                }
                pairs
            }
            Positions => {
                let (length, pairs) = length(rest)?;
                pairs.get(length.checked_next_multiple_of(10)?..)?
            }
        };
    }
    Some(rest)
}

fn behind_text(bytes: &[u8]) -> Option<&[u8]> {
    let (length, rest) = length(bytes)?;
    rest.get(length..)
}

/// A length, and what follows it.
fn length(bytes: &[u8]) -> Option<(usize, &[u8])> {
    let (length, rest) = bytes.split_first_chunk()?;
    Some((usize::try_from(u32::from_le_bytes(*length)).ok()?, rest))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u64> {
    let bytes = bytes.get(at..at + 4)?.try_into().ok()?;
    Some(u64::from(u32::from_le_bytes(bytes)))
}

fn u64_at(bytes: &[u8], at: usize) -> Option<u64> {
    let bytes = bytes.get(at..at + 8)?.try_into().ok()?;
    Some(u64::from_le_bytes(bytes))
}

/// The length of a chunk's body that its fields add up to.
pub(super) fn chunk_length(body: &[u8]) -> Option<u64> {
    let name = u32_at(body, 28)?;
    let size = u64_at(body, usize::try_from(32 + name).ok()?)?;
    size.checked_add(40 + name)
}

pub(super) fn message_index_length(body: &[u8]) -> Option<u64> {
    Some(u32_at(body, 2)? + 6)
}

/// The length of an attachment's body that its fields add up to.
pub(super) fn attachment_length(source: &Source, body: u64, limit: u64) -> io::Result<Option<u64>> {
    let mut bytes = Vec::new();
    let mut at = 16;
    for _ in 0..2 {
        source.read(body + at, 4, &mut bytes)?;
        let Some(length) = u32_at(&bytes, 0) else {
            return Ok(None);
        };
        at += 4 + length;
        if at > limit {
            return Ok(None);
        }
    }
    source.read(body + at, 8, &mut bytes)?;
    let data = u64_at(&bytes, 0);
    Ok(data.and_then(|data| data.checked_add(at + 12)))
}
