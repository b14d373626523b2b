//! Going through a file's top-level records by their lengths, past whatever is damaged.
//!
//! A record that contradicts itself, or whose length leads nowhere, is a loss; the next place where a
//! record stands that doesn't is searched byte by byte.

use super::source::Source;
use mcap::records::{Record, op};
use mcap::{MAGIC, McapError, McapResult};
use std::io;
use std::ops::Range;

/// Opcode and length.
pub(crate) const HEAD: u64 = 9;
/// What is read of each record at first.
const PREFIX: u64 = 256;
/// A record that must be read as a whole to be understood is not longer than this.
const LONGEST: u64 = 256 << 20;
/// So much is searched at a time.
const SEARCH_WINDOW: u64 = 1 << 20;
/// What is read beside that to look at what might be records; what is damaged beyond that is not searched.
const SEARCH_LIMIT: u64 = 1 << 28;

/// A top-level record.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    /// Its opcode.
    pub(crate) opcode: u8,
    /// Where it starts.
    pub(crate) offset: u64,
    /// Its length with opcode and length field.
    pub(crate) length: u64,
}

impl Place {
    /// The position behind it.
    pub(crate) fn end(&self) -> u64 {
        self.offset + self.length
    }
}

/// What is found on the way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Found {
    /// A record.
    Record(Place),
    /// Bytes that belong to no record.
    Damage(Range<u64>),
    /// The magic bytes at the end of the file.
    End,
    /// The file ends without them, in these last bytes that belong to no record.
    Cut(Range<u64>),
}

/// The end of the scan can be asked for once.
#[derive(Debug)]
pub(crate) struct Scanner<'a> {
    source: &'a Source,
    position: u64,
    prefix: Vec<u8>,
    /// Bytes that searching has read so far.
    searched: u64,
    done: bool,
}

impl<'a> Scanner<'a> {
    /// Starts behind the magic bytes at the beginning, which the file must have.
    pub(crate) fn new(source: &'a Source) -> Self {
        Self {
            source,
            position: MAGIC.len() as u64,
            prefix: Vec::new(),
            searched: 0,
            done: false,
        }
    }

    /// The next thing in the file; none behind its end.
    pub(crate) fn next(&mut self) -> io::Result<Option<Found>> {
        if self.done {
            return Ok(None);
        }
        if self.at_end_magic(self.position)? {
            self.done = true;
            return Ok(Some(Found::End));
        }
        if let Some(place) = self.record_at(self.position)? {
            self.position = place.end();
            return Ok(Some(Found::Record(place)));
        }
        let from = self.position;
        let found = self.search(from + 1)?;
        Ok(Some(match found {
            Some(next) => {
                self.position = next;
                Found::Damage(from..next)
            }
            None => {
                self.done = true;
                Found::Cut(from..self.source.length())
            }
        }))
    }

    fn at_end_magic(&mut self, position: u64) -> io::Result<bool> {
        if position + MAGIC.len() as u64 != self.source.length() {
            return Ok(false);
        }
        self.source
            .read(position, MAGIC.len() as u64, &mut self.prefix)?;
        Ok(self.prefix == MAGIC)
    }

    /// The record at a position, if there is one that doesn't contradict itself.
    fn record_at(&mut self, offset: u64) -> io::Result<Option<Place>> {
        self.source.read(offset, PREFIX, &mut self.prefix)?;
        let Some((opcode, body_length)) = head(&self.prefix) else {
            return Ok(None);
        };
        let room = self.source.length() - offset - HEAD;
        if body_length > room || !is_known(opcode) {
            return Ok(None);
        }
        let place = Place {
            opcode,
            offset,
            length: HEAD + body_length,
        };
        let known = &self.prefix[HEAD as usize..];
        let consistent = match opcode {
            op::CHUNK => chunk_length(known) == Some(body_length),
            op::MESSAGE_INDEX => message_index_length(known) == Some(body_length),
            op::ATTACHMENT => {
                attachment_length(self.source, offset + HEAD, body_length)? == Some(body_length)
            }
            op::MESSAGE => body_length >= 22,
            _ => body_length <= LONGEST && self.parses(&place)?,
        };
        Ok(consistent.then_some(place))
    }

    fn parses(&mut self, place: &Place) -> io::Result<bool> {
        if place.length > PREFIX {
            self.source
                .read(place.offset, place.length, &mut self.prefix)?;
        }
        let Some(body) = self.prefix.get(HEAD as usize..place.length as usize) else {
            return Ok(false);
        };
        if parse(place.opcode, body).is_err() {
            return Ok(false);
        }
        // Later versions of the format may add fields; else a longer record has swallowed others.
        Ok(is_exact(place.opcode, body) || self.may_begin_at(place.end())?)
    }

    /// Whether a record may begin at a position, or the file ends there.
    fn may_begin_at(&mut self, position: u64) -> io::Result<bool> {
        self.source.read(position, HEAD, &mut self.prefix)?;
        let room = self.source.length() - position;
        let begins =
            head(&self.prefix).is_some_and(|(opcode, length)| is_known(opcode) && length < 1 << 40);
        Ok(begins || room <= MAGIC.len() as u64)
    }

    /// The first position from `from` on where a record or the end magic stands.
    fn search(&mut self, from: u64) -> io::Result<Option<u64>> {
        let mut window = Vec::new();
        let mut start = from;
        // Most often the next record is near.
        let mut size = SEARCH_WINDOW >> 6;
        while start < self.source.length() {
            self.source.read(start, size + HEAD, &mut window)?;
            for at in 0..window.len().min(size as usize) {
                let position = start + at as u64;
                let room = self.source.length() - position;
                let plausible = head(&window[at..])
                    .is_some_and(|(opcode, length)| is_known(opcode) && length + HEAD <= room);
                // A lone message can't be told from chance, nor a short unknown record.
                let telling = window[at] != op::MESSAGE && window[at] < 0x80;
                if plausible && telling && self.searched < SEARCH_LIMIT {
                    self.searched += self.cost_at(position, &window[at..]);
                    if self.record_at(position)?.is_some_and(|p| p.length > HEAD) {
                        return Ok(Some(position));
                    }
                }
                if self.at_end_magic(position)? {
                    return Ok(Some(position));
                }
            }
            start += size;
            size = SEARCH_WINDOW;
        }
        Ok(None)
    }

    /// How much must be read to tell whether a record stands at a position.
    fn cost_at(&self, position: u64, bytes: &[u8]) -> u64 {
        let telling_by_head = matches!(bytes[0], op::CHUNK | op::MESSAGE_INDEX | op::ATTACHMENT);
        match head(bytes) {
            Some((_, length)) if !telling_by_head => {
                PREFIX + length.min(self.source.length() - position)
            }
            _ => PREFIX,
        }
    }
}

/// Opcode and length of the body.
fn head(bytes: &[u8]) -> Option<(u8, u64)> {
    let length = bytes.get(1..9)?.try_into().ok()?;
    let length = u64::from_le_bytes(length);
    (length < 1 << 62).then_some((bytes[0], length))
}

/// Opcodes of the specification, and those left to applications.
fn is_known(opcode: u8) -> bool {
    (op::HEADER..=op::DATA_END).contains(&opcode) || opcode >= 0x80
}

/// Reads a record.
///
/// `mcap` takes memory for a text before it looks whether the text is there, up to 4 GiB of it, and panics
/// at an attachment that ends behind its head: such records are refused before.
pub(crate) fn parse(opcode: u8, body: &[u8]) -> McapResult<Record<'_>> {
    match behind_texts(opcode, body) {
        Some(_) => mcap::parse_record(opcode, body),
        None => Err(McapError::UnexpectedEof),
    }
}

/// Whether a record ends where its last field of the specification ends.
fn is_exact(opcode: u8, body: &[u8]) -> bool {
    let Some(rest) = behind_texts(opcode, body) else {
        return false;
    };
    let has_length = |at: usize| u32_at(rest, at).map(|length| at as u64 + 4 + length);
    let expected = match opcode {
        op::HEADER | op::CHANNEL | op::METADATA | op::METADATA_INDEX | op::ATTACHMENT_INDEX => {
            Some(0)
        }
        op::SCHEMA => has_length(0),
        op::CHUNK_INDEX => Some(16),
        op::STATISTICS => has_length(42),
        op::SUMMARY_OFFSET => Some(17),
        op::DATA_END => Some(4),
        op::FOOTER => Some(20),
        _ => None,
    };
    expected == Some(rest.len() as u64)
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

/// What stands behind the last text of a record; none if a text or what must follow is not there.
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
fn chunk_length(body: &[u8]) -> Option<u64> {
    let name = u32_at(body, 28)?;
    let size = u64_at(body, usize::try_from(32 + name).ok()?)?;
    size.checked_add(40 + name)
}

fn message_index_length(body: &[u8]) -> Option<u64> {
    Some(u32_at(body, 2)? + 6)
}

/// The length of an attachment's body that its fields add up to.
fn attachment_length(source: &Source, body: u64, limit: u64) -> io::Result<Option<u64>> {
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
