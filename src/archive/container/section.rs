//! The parts of a file that hold messages: chunks, and records outside chunks.

use super::lz4::Lz4Frames;
use super::record::{HEAD, RecordSpan, chunk_fields, head};
use super::source::Source;
use super::zstd::ZstdFrames;
use mcap::records::{ChunkHeader, op};
use std::io::{self, Read};
use std::ops::Range;
use thiserror::Error;

/// Maximum size of a chunk, bytes, compressed and not; larger chunks are treated as damage.
const MAX_CHUNK_SIZE: u64 = 256 << 20;

/// Larger chunks are decompressed in pieces of this size, and their compressed data are not kept.
const PIECE: u64 = 1 << 22;

/// Maximum length of the fields before a chunk's content, bytes. Only the name of its compression has no fixed length.
const MAX_FIELDS: u64 = 1 << 12;

/// A part of a file that holds messages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct FileSection {
    /// Start in the file.
    pub(crate) offset: u64,
    /// Length, bytes.
    pub(crate) length: u64,
    /// Whether it is a chunk; otherwise consecutive records outside chunks.
    pub(crate) is_chunk: bool,
    /// The times of its first and last message, ns; unknown outside of chunks.
    pub(crate) span: Option<(u64, u64)>,
}

/// The reason why a section can't be read.
#[derive(Debug, Error)]
pub(crate) enum SectionError {
    #[error(transparent)]
    Io(#[from] io::Error),
    #[error("a {what} of {length} bytes is larger than the limit of {} MiB", MAX_CHUNK_SIZE >> 20)]
    TooLarge { what: &'static str, length: u64 },
    #[error("truncated")]
    Truncated,
    #[error("unreadable header")]
    Header,
    #[error("unsupported compression {0:?} (supported: \"zstd\", \"lz4\", and \"\" for none)")]
    Compression(String),
    #[error("decompression failed: {0}")]
    Decompression(#[source] io::Error),
    /// The content has something else where a record should start, at this byte.
    #[error("invalid record at byte {0} of the chunk")]
    Record(usize),
    /// There is more content than this number of bytes.
    #[error("more content than the {0} bytes in its header")]
    Excess(u64),
    #[error("{found} bytes of content, expected {expected}")]
    Short { found: u64, expected: u64 },
    #[error("checksum {found:08x}, expected {expected:08x}")]
    Checksum { found: u32, expected: u32 },
}

impl From<SectionError> for io::Error {
    fn from(error: SectionError) -> Self {
        match error {
            SectionError::Io(error) => error,
            error => Self::other(error),
        }
    }
}

/// Reusable buffers of a section.
#[derive(Debug, Default)]
pub(crate) struct Buffers {
    /// Bytes as they stand in the file.
    pub(crate) raw: Vec<u8>,
    /// The section's records.
    pub(crate) records: Vec<u8>,
}

impl FileSection {
    /// The section of a chunk. Only the two times at the start of the chunk are read.
    pub(crate) fn read_chunk(place: &RecordSpan, source: &Source) -> io::Result<Self> {
        let mut times = Vec::new();
        source.read(place.offset + HEAD, 16, &mut times)?;
        let (numbers, _) = times.as_chunks::<8>();
        let span = match numbers {
            [first, last] => (u64::from_le_bytes(*first), u64::from_le_bytes(*last)),
            // The scanner has seen the whole header, unless the file has become shorter since.
            _ => (0, 0),
        };
        Ok(Self {
            offset: place.offset,
            length: place.length,
            is_chunk: true,
            span: Some(span),
        })
    }

    /// Reads, decompresses and checks the section.
    pub(crate) fn load(&self, source: &Source, buffers: &mut Buffers) -> Result<(), SectionError> {
        check_size(self.length, if self.is_chunk { "chunk" } else { "record" })?;
        if !self.is_chunk {
            // Records outside of chunks have no checksum but that of the whole data.
            source.read(self.offset, self.length, &mut buffers.records)?;
            return if buffers.records.len() as u64 == self.length {
                Ok(())
            } else {
                Err(SectionError::Truncated)
            };
        }
        let (header, content) = self.read_fields(source, &mut buffers.raw)?;
        let (from, size) = (content.start, header.uncompressed_size);
        check_size(size, "chunk")?;
        if header.compression.is_empty() {
            // Without a copy: a chunk may be as large as the memory that is meant for it. One extra byte to detect excess
            // data.
            let length = (content.end - from).min(size + 1);
            source.read(from, length, &mut buffers.records)?;
        } else {
            source.read(from, content.end - from, &mut buffers.raw)?;
            decompress(&header, &buffers.raw, &mut buffers.records)?;
            if buffers.raw.capacity() as u64 > PIECE {
                buffers.raw = Vec::new();
            }
        }
        check_content(&header, &buffers.records)
    }

    /// Header and place of the content of a chunk.
    fn read_fields(
        &self,
        source: &Source,
        bytes: &mut Vec<u8>,
    ) -> Result<(ChunkHeader, Range<u64>), SectionError> {
        let start = self.offset + HEAD;
        let body_length = self
            .length
            .checked_sub(HEAD)
            .ok_or(SectionError::Truncated)?;
        source.read(start, body_length.min(MAX_FIELDS), bytes)?;
        chunk_fields(bytes)
            .filter(|(_, at, length)| at.saturating_add(*length) <= body_length)
            .map(|(header, at, length)| (header, start + at..start + at + length))
            .ok_or(SectionError::Header)
    }
}

/// Refuses a record that is too large; `what` names it.
fn check_size(length: u64, what: &'static str) -> Result<(), SectionError> {
    if length > MAX_CHUNK_SIZE {
        return Err(SectionError::TooLarge { what, length });
    }
    Ok(())
}

fn decompress(
    header: &ChunkHeader,
    data: &[u8],
    records: &mut Vec<u8>,
) -> Result<(), SectionError> {
    let size = header.uncompressed_size;
    match header.compression.as_str() {
        // Encoders write no frame for an empty chunk.
        _ if size == 0 && data.is_empty() => {
            records.clear();
            Ok(())
        }
        // The default of 128 MiB would refuse large chunks that `zstd --long` compressed.
        "zstd" => read_pieces(ZstdFrames::new(data, MAX_CHUNK_SIZE.ilog2()), size, records),
        "lz4" => read_pieces(Lz4Frames::new(data), size, records),
        other => Err(SectionError::Compression(other.to_owned())),
    }
}

/// Checks length and checksum of a chunk's content.
fn check_content(header: &ChunkHeader, records: &[u8]) -> Result<(), SectionError> {
    let (length, size) = (records.len() as u64, header.uncompressed_size);
    if length > size {
        return Err(SectionError::Excess(size));
    }
    if length < size {
        return Err(SectionError::Short {
            found: length,
            expected: size,
        });
    }
    // Zero means that no checksum was computed.
    let found = crc32fast::hash(records);
    let expected = header.uncompressed_crc;
    if expected != 0 && found != expected {
        return Err(SectionError::Checksum { found, expected });
    }
    Ok(())
}

/// Decompresses in pieces up to the maximum chunk size (decompression bombs).
fn read_pieces(decoder: impl Read, size: u64, records: &mut Vec<u8>) -> Result<(), SectionError> {
    records.clear();
    // One extra byte to detect excess data.
    let mut content = decoder.take(size + 1);
    let mut next = 0;
    loop {
        let length = content
            .by_ref()
            .take(PIECE)
            .read_to_end(records)
            .map_err(SectionError::Decompression)?;
        if (length as u64) < PIECE {
            return Ok(());
        }
        while let Some((opcode, length)) = records.get(next..).and_then(head) {
            // Readers skip unknown records, but 0 is no opcode.
            if opcode == 0 || HEAD + length > size {
                return Err(SectionError::Record(next));
            }
            let length = usize::try_from(HEAD + length).unwrap_or(usize::MAX);
            next = next.saturating_add(length);
        }
    }
}

/// A record within a section.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InnerRecord<'a> {
    pub(crate) opcode: u8,
    pub(crate) body: &'a [u8],
}

impl InnerRecord<'_> {
    /// The id of the channel with which a channel or message record begins; `None` if the record is too short.
    pub(crate) fn channel_id(&self) -> Option<u16> {
        self.body.first_chunk().copied().map(u16::from_le_bytes)
    }
}

/// The record at `position` of a section's bytes, and its end; `None` at the end.
#[inline]
pub(crate) fn record_at(
    records: &[u8],
    position: usize,
) -> Option<Result<(InnerRecord<'_>, usize), &'static str>> {
    let rest = records.get(position..).filter(|rest| !rest.is_empty())?;
    let found = head(rest).and_then(|(opcode, length)| {
        let end = usize::try_from(HEAD + length).ok()?;
        let body = rest.get(HEAD as usize..end)?;
        Some((InnerRecord { opcode, body }, position + end))
    });
    Some(found.ok_or("a record exceeds its chunk"))
}

/// A message record's head and data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct MessageRecord<'a> {
    pub(crate) channel_id: u16,
    pub(crate) sequence: u32,
    pub(crate) log_time: u64,
    pub(crate) publish_time: u64,
    /// The time by which it is read, ns: its log time, unless a reader knows better.
    pub(crate) time_ns: u64,
    pub(crate) data: &'a [u8],
}

impl<'a> MessageRecord<'a> {
    /// Reads the body of a message record.
    #[inline]
    pub(crate) fn parse(inner: &InnerRecord<'a>) -> Option<Self> {
        if inner.opcode != op::MESSAGE {
            return None;
        }
        let (channel_id, rest) = inner.body.split_first_chunk()?;
        let (sequence, rest) = rest.split_first_chunk()?;
        let (log_time, rest) = rest.split_first_chunk()?;
        let (publish_time, data) = rest.split_first_chunk()?;
        let log_time = u64::from_le_bytes(*log_time);
        Some(Self {
            channel_id: u16::from_le_bytes(*channel_id),
            sequence: u32::from_le_bytes(*sequence),
            log_time,
            time_ns: log_time,
            publish_time: u64::from_le_bytes(*publish_time),
            data,
        })
    }
}
