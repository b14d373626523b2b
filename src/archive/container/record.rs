//! MCAP records: position and content.

use mcap::records::{AttachmentHeader, ChunkHeader, Record, op};
use mcap::{McapError, McapResult};
use std::collections::BTreeSet;

/// Length of a record's opcode and length field.
pub(crate) const HEAD: u64 = 9;

/// The place of a top-level record in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct RecordSpan {
    /// Kind of the record.
    pub(crate) opcode: u8,
    /// Start in the file.
    pub(crate) offset: u64,
    /// Length with opcode and length field, bytes.
    pub(crate) length: u64,
}

impl RecordSpan {
    /// Offset of the end.
    pub(crate) fn end(&self) -> u64 {
        self.offset + self.length
    }
}

/// Opcode and length of the body.
pub(crate) fn head(bytes: &[u8]) -> Option<(u8, u64)> {
    let length = bytes.get(1..9)?.try_into().ok()?;
    let length = u64::from_le_bytes(length);
    // So sums with offsets don't overflow.
    (length < 1 << 62).then_some((bytes[0], length))
}

/// Whether the specification defines records of this opcode. Readers skip all others, except 0, which is invalid.
pub(crate) fn is_specified(opcode: u8) -> bool {
    (op::HEADER..=op::DATA_END).contains(&opcode)
}

/// Reads a record of the specification; bytes after its fields are ignored.
///
/// Rejects records with invalid lengths first, because the `mcap` crate allocates up to 4 GiB for a string before
/// checking its length, and panics on truncated attachments.
pub(crate) fn parse(opcode: u8, body: &[u8]) -> McapResult<Record<'_>> {
    let is_complete = fields_length(opcode, body).is_ok_and(|length| length <= body.len() as u64);
    if !is_complete {
        return Err(McapError::UnexpectedEof);
    }
    mcap::parse_record(opcode, body)
}

/// A field of a record, or several.
enum RecordField {
    /// Numbers with this total size in bytes.
    Bytes(u64),
    /// Text or bytes, preceded by their length.
    Text,
    /// Bytes, preceded by their length in eight bytes.
    Data,
    /// Pairs of strings.
    Texts,
    /// Pairs of a channel id and an eight-byte number.
    Numbers,
    /// The rest.
    Rest,
}

/// Error in the fields of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FieldFault {
    /// The specification doesn't define the record, or a length is missing or leads beyond the body.
    Incomplete,
    /// A key or an id is repeated: readers differ in which value they use.
    Repeated,
}

/// The total length of the fields of a record's body; `start` must include all length fields. A longer body contains
/// unread data.
pub(crate) fn fields_length(opcode: u8, start: &[u8]) -> Result<u64, FieldFault> {
    use RecordField::{Bytes, Data, Numbers, Rest, Text, Texts};
    let parts: &[RecordField] = match opcode {
        op::HEADER => &[Text, Text],
        op::FOOTER => &[Bytes(20)],
        op::SCHEMA => &[Bytes(2), Text, Text, Text],
        op::CHANNEL => &[Bytes(4), Text, Text, Texts],
        op::MESSAGE => &[Bytes(22), Rest],
        op::CHUNK => &[Bytes(28), Text, Data],
        op::MESSAGE_INDEX => &[Bytes(2), Text],
        op::CHUNK_INDEX => &[Bytes(32), Numbers, Bytes(8), Text, Bytes(16)],
        op::ATTACHMENT => &[Bytes(16), Text, Text, Data, Bytes(4)],
        op::ATTACHMENT_INDEX => &[Bytes(40), Text, Text],
        op::STATISTICS => &[Bytes(42), Numbers],
        op::METADATA => &[Text, Texts],
        op::METADATA_INDEX => &[Bytes(16), Text],
        op::SUMMARY_OFFSET => &[Bytes(17)],
        op::DATA_END => &[Bytes(4)],
        _ => return Err(FieldFault::Incomplete),
    };
    let mut at = 0_u64;
    for part in parts {
        at = match part {
            Bytes(count) => at.checked_add(*count),
            Text => end_of_text(start, at),
            Data => number_at(start, at).and_then(|length| length.checked_add(at + 8)),
            Texts => Some(end_of_texts(start, at)?),
            Numbers => Some(end_of_numbers(start, at)?),
            Rest => Some(at.max(start.len() as u64)),
        }
        .ok_or(FieldFault::Incomplete)?;
    }
    Ok(at)
}

/// The position after pairs of texts.
fn end_of_texts(start: &[u8], mut at: u64) -> Result<u64, FieldFault> {
    let end = end_of_text(start, at).ok_or(FieldFault::Incomplete)?;
    let (mut keys, mut is_repeated) = (BTreeSet::new(), false);
    at += 4;
    while at < end {
        let value = end_of_text(start, at).ok_or(FieldFault::Incomplete)?;
        let key = bytes_at(start, at, value).ok_or(FieldFault::Incomplete)?;
        is_repeated |= !keys.insert(key);
        at = end_of_text(start, value).ok_or(FieldFault::Incomplete)?;
    }
    match (at == end, is_repeated) {
        (false, _) => Err(FieldFault::Incomplete),
        (true, true) => Err(FieldFault::Repeated),
        (true, false) => Ok(end),
    }
}

/// The position after pairs of a channel id and a number.
fn end_of_numbers(start: &[u8], at: u64) -> Result<u64, FieldFault> {
    let end = end_of_text(start, at).ok_or(FieldFault::Incomplete)?;
    let pairs = bytes_at(start, at + 4, end).ok_or(FieldFault::Incomplete)?;
    let mut ids = BTreeSet::new();
    let are_new = pairs
        .chunks(10)
        .all(|pair| ids.insert(&pair[..pair.len().min(2)]));
    if are_new {
        Ok(end)
    } else {
        Err(FieldFault::Repeated)
    }
}

/// Header of an attachment, and position and length of its data in the record's body.
pub(crate) fn attachment_fields(body: &[u8]) -> Option<(AttachmentHeader, u64, u64)> {
    let name = 16;
    let media_type = end_of_text(body, name)?;
    let length = end_of_text(body, media_type)?;
    let header = AttachmentHeader {
        log_time: number_at(body, 0)?,
        create_time: number_at(body, 8)?,
        name: text_at(body, name)?,
        media_type: text_at(body, media_type)?,
    };
    Some((header, length + 8, number_at(body, length)?))
}

/// Header of a chunk, and position and length of its content in the record's body.
pub(crate) fn chunk_fields(body: &[u8]) -> Option<(ChunkHeader, u64, u64)> {
    let compression = 28;
    let length = end_of_text(body, compression)?;
    let checksum = bytes_at(body, 24, compression)?.try_into().ok()?;
    let header = ChunkHeader {
        message_start_time: number_at(body, 0)?,
        message_end_time: number_at(body, 8)?,
        uncompressed_size: number_at(body, 16)?,
        uncompressed_crc: u32::from_le_bytes(checksum),
        compression: text_at(body, compression)?,
        compressed_size: number_at(body, length)?,
    };
    let content_length = header.compressed_size;
    Some((header, length + 8, content_length))
}

/// The number of eight bytes at a position.
fn number_at(bytes: &[u8], at: u64) -> Option<u64> {
    let number = bytes_at(bytes, at, at + 8)?.try_into().ok()?;
    Some(u64::from_le_bytes(number))
}

/// The text at a position, which is that of its length field.
fn text_at(bytes: &[u8], at: u64) -> Option<String> {
    let text = bytes_at(bytes, at + 4, end_of_text(bytes, at)?)?;
    Some(String::from_utf8_lossy(text).into_owned())
}

/// The position after a text.
fn end_of_text(bytes: &[u8], at: u64) -> Option<u64> {
    let length = bytes_at(bytes, at, at + 4)?.try_into().ok()?;
    Some(at + 4 + u64::from(u32::from_le_bytes(length)))
}

fn bytes_at(bytes: &[u8], from: u64, to: u64) -> Option<&[u8]> {
    bytes.get(usize::try_from(from).ok()?..usize::try_from(to).ok()?)
}
