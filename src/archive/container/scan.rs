//! Scanner of top-level records that skips damaged parts.
//!
//! An inconsistent record, or one whose length leads to invalid data, is a loss. If another record follows where its length
//! leads, it is lost as a whole; otherwise the next valid record is searched byte by byte.

use super::attachment::MAX_NAMES;
use super::record::{FieldFault, HEAD, RecordSpan, fields_length, head, is_specified, parse};
use super::source::Source;
use mcap::MAGIC;
use mcap::records::op;
use std::fmt;
use std::io;
use std::ops::Range;

/// Number of bytes read initially per record.
const PREFIX: u64 = 256;
/// Maximum length of a record that must be read completely.
const MAX_LENGTH: u64 = 256 << 20;
/// Bytes that are searched at a time for the next record.
const SEARCH_WINDOW: u64 = 1 << 20;
/// Total search limit, bytes.
const SEARCH_LIMIT: u64 = 1 << 28;

/// A scan result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Found {
    /// A record.
    Record(RecordSpan),
    /// Bytes that belong to no valid record.
    Damage(Range<u64>, Damage),
    /// The magic bytes at the end of the file.
    End,
    /// The file is truncated; these bytes belong to no record.
    Cut(Range<u64>),
}

/// Damage of bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Damage {
    /// They are no record.
    Unreadable,
    /// A record of this opcode, in which a key or an id is repeated.
    Repeated(u8),
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match self {
            Self::Unreadable => return f.write_str("no readable record"),
            Self::Repeated(op::METADATA) => "a metadata record has a key",
            Self::Repeated(op::CHANNEL) => "the metadata of a channel record have a key",
            Self::Repeated(_) => "a record of the summary has an id",
        };
        write!(
            f,
            "{what} twice: readers differ in which of its values they use"
        )
    }
}

/// A scan in progress; its end is returned only once.
#[derive(Debug)]
pub(crate) struct Scanner<'a> {
    source: &'a Source,
    position: u64,
    prefix: Vec<u8>,
    /// Bytes read by searches so far.
    searched: u64,
    is_done: bool,
}

impl<'a> Scanner<'a> {
    /// Starts after the magic bytes.
    pub(crate) fn new(source: &'a Source) -> Self {
        Self {
            source,
            position: MAGIC.len() as u64,
            prefix: Vec::new(),
            searched: 0,
            is_done: false,
        }
    }

    /// The next scan result; `None` at the end.
    pub(crate) fn next(&mut self) -> io::Result<Option<Found>> {
        if self.is_done {
            return Ok(None);
        }
        if self.at_end_magic(self.position)? {
            self.is_done = true;
            return Ok(Some(Found::End));
        }
        if let Some(place) = self.record_at(self.position)? {
            self.position = place.end();
            return Ok(Some(Found::Record(place)));
        }
        let from = self.position;
        if let Some((next, damage)) = self.invalid_record_at(from)? {
            self.position = next;
            return Ok(Some(Found::Damage(from..next, damage)));
        }
        let is_cut_chunk = self.is_cut_chunk(from)?;
        let found = self.search(from + 1, !is_cut_chunk)?;
        Ok(Some(if let Some(next) = found {
            self.position = next;
            Found::Damage(from..next, Damage::Unreadable)
        } else {
            self.is_done = true;
            Found::Cut(from..self.source.length())
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

    /// The record at a position, if it is consistent.
    fn record_at(&mut self, offset: u64) -> io::Result<Option<RecordSpan>> {
        self.source.read(offset, PREFIX, &mut self.prefix)?;
        let Some((opcode, body_length)) = head(&self.prefix) else {
            return Ok(None);
        };
        let room = self.source.length() - offset - HEAD;
        // Padding with zeros would be a series of empty records otherwise.
        if body_length > room || opcode == 0 {
            return Ok(None);
        }
        let place = RecordSpan {
            opcode,
            offset,
            length: HEAD + body_length,
        };
        let length = HEAD + checked_length(opcode, body_length);
        if length > MAX_LENGTH {
            return Ok(None);
        }
        if length > PREFIX {
            self.source.read(offset, length, &mut self.prefix)?;
        }
        self.prefix.truncate(length as usize);
        let body = self.prefix.get(HEAD as usize..).unwrap_or_default();
        let fields = fields_length(opcode, body).ok();
        let is_readable = match opcode {
            op::MESSAGE => body_length >= 22,
            // Their content is too long to be read here.
            op::CHUNK | op::MESSAGE_INDEX | op::ATTACHMENT => {
                fields.is_some_and(|length| length <= body_length)
            }
            opcode if is_specified(opcode) => parse(opcode, body).is_ok(),
            _ => true,
        };
        // A newer version of the format may add fields or records. As a damaged length looks the same, another record
        // must follow.
        let is_familiar = opcode == op::MESSAGE || fields == Some(body_length);
        let is_consistent = is_readable && (is_familiar || self.may_begin_at(place.end())?);
        Ok(is_consistent.then_some(place))
    }

    /// The end of a record with invalid fields, and what is wrong with it, if its length leads to another record.
    ///
    /// Such a record is not searched for others, because the data of an attachment or a message may be a file as well. What
    /// is in a chunk belongs to this file.
    fn invalid_record_at(&mut self, offset: u64) -> io::Result<Option<(u64, Damage)>> {
        self.source.read(offset, PREFIX, &mut self.prefix)?;
        let Some((opcode, body_length)) = head(&self.prefix) else {
            return Ok(None);
        };
        let end = offset + HEAD + body_length;
        if opcode == op::CHUNK || body_length == 0 || end > self.source.length() {
            return Ok(None);
        }
        let length = checked_length(opcode, body_length);
        let mut damage = Damage::Unreadable;
        if is_specified(opcode) && length <= MAX_LENGTH {
            self.source.read(offset + HEAD, length, &mut self.prefix)?;
            if fields_length(opcode, &self.prefix) == Err(FieldFault::Repeated) {
                damage = Damage::Repeated(opcode);
            }
        }
        Ok(self.leads_to_record(end)?.then_some((end, damage)))
    }

    /// Whether there is a record of the specification at a position, or the end of the file.
    fn leads_to_record(&mut self, position: u64) -> io::Result<bool> {
        if self.at_end_magic(position)? {
            return Ok(true);
        }
        self.source.read(position, HEAD, &mut self.prefix)?;
        match head(&self.prefix) {
            // A single message could be random data.
            Some((op::MESSAGE, _)) => self.are_records_at(position, 3),
            Some((opcode, _)) if is_specified(opcode) => self.are_records_at(position, 1),
            _ => Ok(false),
        }
    }

    /// Whether a record may begin at a position, or the file ends there.
    fn may_begin_at(&mut self, position: u64) -> io::Result<bool> {
        self.source.read(position, HEAD, &mut self.prefix)?;
        let room = self.source.length() - position;
        let begins =
            head(&self.prefix).is_some_and(|(opcode, length)| opcode != 0 && length < 1 << 40);
        Ok(begins || room <= MAGIC.len() as u64)
    }

    /// Whether there is a chunk that the file ends within. Its messages are no messages outside of chunks.
    fn is_cut_chunk(&mut self, position: u64) -> io::Result<bool> {
        self.source.read(position, HEAD, &mut self.prefix)?;
        let room = self.source.length() - position;
        Ok(head(&self.prefix)
            .is_some_and(|(opcode, length)| opcode == op::CHUNK && HEAD + length > room))
    }

    /// The first record or end magic at or after `from`. A message counts only if `accepts_messages`.
    fn search(&mut self, from: u64, accepts_messages: bool) -> io::Result<Option<u64>> {
        let mut window = Vec::new();
        let mut start = from;
        // The next record is usually near.
        let mut size = SEARCH_WINDOW >> 6;
        while start < self.source.length() {
            self.source.read(start, size + HEAD, &mut window)?;
            // The window overlaps the next one by a head, so that a head on the border is found, too.
            let opcodes = window.iter().take(size as usize).enumerate();
            for (at, opcode) in opcodes.filter(|(_, opcode)| is_specified(**opcode)) {
                let position = start + at as u64;
                let room = self.source.length() - position;
                let is_possible =
                    head(&window[at..]).is_some_and(|(_, length)| length + HEAD <= room);
                let is_message = *opcode == op::MESSAGE;
                let is_wanted = is_possible && (accepts_messages || !is_message);
                if is_wanted && self.searched < SEARCH_LIMIT {
                    // A single message could be random data.
                    let count = if is_message { 3 } else { 1 };
                    if self.are_records_at(position, count)? {
                        return Ok(Some(position));
                    }
                }
            }
            start += size;
            size = SEARCH_WINDOW;
        }
        let end = self.source.length().saturating_sub(MAGIC.len() as u64);
        Ok((from <= end && self.at_end_magic(end)?).then_some(end))
    }

    /// Whether this many consistent records follow each other from a position on, as far as the file goes.
    fn are_records_at(&mut self, mut position: u64, count: usize) -> io::Result<bool> {
        for _ in 0..count {
            if self.at_end_magic(position)? {
                return Ok(true);
            }
            self.source.read(position, HEAD, &mut self.prefix)?;
            let Some((opcode, length)) = head(&self.prefix) else {
                return Ok(false);
            };
            self.searched += PREFIX + checked_length(opcode, length.min(self.source.length()));
            // No record of the specification is empty, but zeros in a length are common.
            let Some(place) = self.record_at(position)?.filter(|p| p.length > HEAD) else {
                return Ok(false);
            };
            position = place.end();
        }
        Ok(true)
    }
}

/// The number of bytes of a body that are checked to recognise a record.
fn checked_length(opcode: u8, length: u64) -> u64 {
    let most = match opcode {
        op::CHUNK | op::MESSAGE_INDEX | op::MESSAGE => PREFIX - HEAD,
        op::ATTACHMENT => MAX_NAMES,
        opcode if is_specified(opcode) => u64::MAX,
        _ => 0,
    };
    length.min(most)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sections found in a file whose only record is a message with a claimed length that is this much too large.
    fn found(excess: u64) -> Vec<Found> {
        const BODY: u64 = 30;
        let path = tempfile::NamedTempFile::new().unwrap().into_temp_path();
        let mut bytes = MAGIC.to_vec();
        bytes.push(op::MESSAGE);
        bytes.extend_from_slice(&(BODY + excess).to_le_bytes());
        bytes.resize(bytes.len() + BODY as usize, 0);
        std::fs::write(&path, bytes).unwrap();
        let source = Source::open(&path).unwrap();
        let mut scanner = Scanner::new(&source);
        std::iter::from_fn(|| scanner.next().unwrap()).collect()
    }

    #[test]
    fn rejects_records_beyond_the_end_of_the_file() {
        let record = RecordSpan {
            opcode: op::MESSAGE,
            offset: 8,
            length: 39,
        };
        assert_eq!(found(0), [Found::Record(record), Found::Cut(47..47)]);
        assert_eq!(found(1), [Found::Cut(8..47)]);
    }

    /// Whatever is read of a candidate counts, also if it is no record: otherwise a search could take hours.
    #[test]
    fn search_counts_the_bytes_of_false_records() {
        const LENGTH: u64 = 4096;
        let mut bytes = MAGIC.to_vec();
        // No record, and then the head of a header whose texts are too long.
        bytes.push(0);
        bytes.push(op::HEADER);
        bytes.extend_from_slice(&LENGTH.to_le_bytes());
        bytes.resize(bytes.len() + LENGTH as usize, 0xff);
        let path = tempfile::NamedTempFile::new().unwrap().into_temp_path();
        std::fs::write(&path, bytes).unwrap();
        let source = Source::open(&path).unwrap();
        let mut scanner = Scanner::new(&source);
        while scanner.next().unwrap().is_some() {}
        assert!(scanner.searched >= LENGTH, "{}", scanner.searched);
    }
}
