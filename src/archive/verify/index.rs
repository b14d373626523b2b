//! Checks that the index of a file agrees with its data.
//!
//! Viewers find channels, times and messages by the index, so its records must say the same as the data. Writers may
//! leave out all records of a kind, for which viewers then read the data; an index of a part would hide the rest. What
//! readers skip is not checked.

mod channels;
mod equality;

use self::equality::{check_equal, list};
use super::difference::Difference;
use super::error::IndexFault;
use crate::archive::container::record::{HEAD, head, parse};
use crate::archive::container::section::{Buffers, FileSection, MessageRecord, record_at};
use crate::archive::recording::Recording;
use crate::words::plural;
use mcap::Summary;
use mcap::records::{
    AttachmentIndex, ChunkHeader, ChunkIndex, MessageIndexEntry, MetadataIndex, Record, op,
};
use std::collections::BTreeMap;
use std::io;

/// The chunks of a file by their offsets.
pub(super) type Chunks = BTreeMap<u64, Chunk>;

/// A chunk as its content shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Chunk {
    /// Times of the earliest and the latest message, ns; 0 without messages.
    pub(super) first: u64,
    pub(super) last: u64,
    /// Size of the content, bytes.
    pub(super) size: u64,
}

impl Chunk {
    /// A chunk with these messages.
    fn new(entries: &MessageIndexes, size: u64) -> Self {
        let mut span: Option<(u64, u64)> = None;
        for entry in entries.values().flatten() {
            let (first, last) = span.unwrap_or((entry.log_time, entry.log_time));
            span = Some((first.min(entry.log_time), last.max(entry.log_time)));
        }
        // Writers leave the times of an empty chunk 0, as the specification says.
        let (first, last) = span.unwrap_or_default();
        Self { first, last, size }
    }
}

/// Message index entries by channel id.
type MessageIndexes = BTreeMap<u16, Vec<MessageIndexEntry>>;

/// Checks the summary of a file. Returns the chunks.
pub(super) fn check(recording: &Recording, summary: &Summary) -> Result<Chunks, IndexFault> {
    let mut indexes: BTreeMap<u64, &ChunkIndex> = BTreeMap::new();
    for index in &summary.chunk_indexes {
        if indexes.insert(index.chunk_start_offset, index).is_some() {
            let found = Some(chunk_text(index));
            return Err(Difference::new("a chunk that is indexed twice", "", [found, None]).into());
        }
    }
    let mut chunks = Chunks::new();
    let mut buffers = Buffers::default();
    for section in recording.layout.sections.iter().filter(|s| s.is_chunk) {
        section
            .load(&recording.source, &mut buffers)
            .map_err(io::Error::from)?;
        let entries = entries(&buffers.records);
        let chunk = Chunk::new(&entries, buffers.records.len() as u64);
        check_chunk_times(recording, section, chunk)?;
        match indexes.remove(&section.offset) {
            Some(index) => check_chunk_index(recording, section, index, &entries)?,
            None if summary.chunk_indexes.is_empty() || entries.is_empty() => {}
            None => {
                // Readers find no messages in it.
                let expected = Some("the index of a chunk".to_owned());
                return Err(Difference::new("the summary", "", [None, expected]).into());
            }
        }
        chunks.insert(section.offset, chunk);
    }
    if let Some(index) = indexes.values().next() {
        let found = Some(chunk_text(index));
        return Err(Difference::new("the index of a chunk", "", [found, None]).into());
    }
    channels::check(recording, summary)?;
    check_attachments(recording, summary)?;
    check_metadata(recording, summary)?;
    Ok(chunks)
}

fn chunk_text(index: &ChunkIndex) -> String {
    format!(
        "{} bytes at {}, {} from {} to {} bytes, times from {} to {} ns",
        index.chunk_length,
        index.chunk_start_offset,
        match index.compression.as_str() {
            "" => "uncompressed",
            compression => compression,
        },
        index.uncompressed_size,
        index.compressed_size,
        index.message_start_time,
        index.message_end_time
    )
}

/// Compares the index of the messages in a chunk, and names the first channel whose entries differ.
fn check_entries(found: &MessageIndexes, expected: &MessageIndexes) -> Result<(), Difference> {
    let place = "the messages in the index of a chunk";
    for id in expected.keys().chain(found.keys()) {
        let [found, expected] =
            [found, expected].map(|all| all.get(id).cloned().unwrap_or_default());
        let first = found.iter().zip(&expected).position(|(a, b)| a != b);
        check_equal(place, &found, &expected, |entries| {
            let count = plural(entries.len() as u64, "message");
            let entry = first.map_or_else(String::new, |at| {
                let MessageIndexEntry { log_time, offset } = entries[at];
                format!(", number {at} at {log_time} ns and offset {offset}")
            });
            format!("{} {count} of channel {id}{entry}", entries.len())
        })?;
    }
    Ok(())
}

/// The entries that the message indexes of a chunk must have.
fn entries(records: &[u8]) -> MessageIndexes {
    let mut entries = MessageIndexes::new();
    let mut position = 0;
    while let Some(Ok((record, next))) = record_at(records, position) {
        if let Some(message) = MessageRecord::parse(&record) {
            entries
                .entry(message.channel_id)
                .or_default()
                .push(MessageIndexEntry {
                    log_time: message.log_time,
                    offset: position as u64,
                });
        }
        position = next;
    }
    entries
}

/// Compares the times in the header of a chunk with those of its messages.
fn check_chunk_times(
    recording: &Recording,
    section: &FileSection,
    chunk: Chunk,
) -> Result<(), IndexFault> {
    let Some(header) = chunk_header(recording, section)? else {
        return Ok(());
    };
    check_equal(
        "the times of a chunk",
        &(header.message_start_time, header.message_end_time),
        &(chunk.first, chunk.last),
        |(first, last)| format!("{first} to {last} ns"),
    )?;
    Ok(())
}

/// Compares the index of a chunk with its header and its messages.
fn check_chunk_index(
    recording: &Recording,
    section: &FileSection,
    index: &ChunkIndex,
    entries: &MessageIndexes,
) -> Result<(), IndexFault> {
    let Some(header) = chunk_header(recording, section)? else {
        return Ok(());
    };
    let expected = ChunkIndex {
        message_start_time: header.message_start_time,
        message_end_time: header.message_end_time,
        chunk_start_offset: section.offset,
        chunk_length: section.length,
        message_index_offsets: index.message_index_offsets.clone(),
        message_index_length: index.message_index_length,
        compression: header.compression,
        compressed_size: header.compressed_size,
        uncompressed_size: header.uncompressed_size,
    };
    check_equal("the index of a chunk", index, &expected, chunk_text)?;
    // Without message indexes readers search the chunk.
    if !index.message_index_offsets.is_empty() {
        let found = message_indexes(recording, section, index)?;
        check_entries(&found, entries)?;
    }
    Ok(())
}

fn chunk_header(recording: &Recording, section: &FileSection) -> io::Result<Option<ChunkHeader>> {
    let mut bytes = Vec::new();
    recording
        .source
        .read(section.offset, section.length, &mut bytes)?;
    let body = bytes.get(HEAD as usize..).unwrap_or_default();
    Ok(match parse(op::CHUNK, body) {
        Ok(Record::Chunk { header, .. }) => Some(header),
        _ => None,
    })
}

/// The entries of the message indexes after a chunk, found by their offsets.
fn message_indexes(
    recording: &Recording,
    section: &FileSection,
    index: &ChunkIndex,
) -> io::Result<MessageIndexes> {
    let start = section.offset + section.length;
    let mut bytes = Vec::new();
    recording
        .source
        .read(start, index.message_index_length, &mut bytes)?;
    let mut found = MessageIndexes::new();
    for (channel, offset) in &index.message_index_offsets {
        let entries = offset
            .checked_sub(start)
            .and_then(|at| bytes.get(at as usize..))
            .and_then(|record| read_message_index(record, *channel))
            .unwrap_or_default();
        if !entries.is_empty() {
            found.insert(*channel, entries);
        }
    }
    Ok(found)
}

fn read_message_index(record: &[u8], channel: u16) -> Option<Vec<MessageIndexEntry>> {
    let (opcode, length) = head(record)?;
    let body = record.get(HEAD as usize..(HEAD + length) as usize)?;
    match parse(opcode, body).ok()? {
        Record::MessageIndex(index) if index.channel_id == channel => {
            let mut entries = index.records;
            // Some writers sort them by time.
            entries.sort_unstable_by_key(|entry| entry.offset);
            Some(entries)
        }
        _ => None,
    }
}

fn check_attachments(recording: &Recording, summary: &Summary) -> Result<(), Difference> {
    if summary.attachment_indexes.is_empty() {
        return Ok(());
    }
    let attachments = recording.layout.attachments.iter();
    let expected = attachments.map(|attachment| AttachmentIndex {
        offset: attachment.place.offset,
        length: attachment.place.length,
        log_time: attachment.header.log_time,
        create_time: attachment.header.create_time,
        data_size: attachment.data_length,
        name: attachment.header.name.clone(),
        media_type: attachment.header.media_type.clone(),
    });
    let mut found = summary.attachment_indexes.clone();
    found.sort_by_key(|index| index.offset);
    check_equal(
        "the index of attachments",
        &found,
        &expected.collect(),
        |indexes| list(indexes.iter().map(attachment_text)),
    )
}

fn attachment_text(index: &AttachmentIndex) -> String {
    format!(
        "{:?} ({:?}) of {} bytes at {}, times {} and {} ns",
        index.name,
        index.media_type,
        index.data_size,
        index.offset,
        index.log_time,
        index.create_time
    )
}

fn check_metadata(recording: &Recording, summary: &Summary) -> Result<(), Difference> {
    if summary.metadata_indexes.is_empty() {
        return Ok(());
    }
    let metadata = recording.layout.metadata.iter();
    let expected = metadata.map(|(place, record)| MetadataIndex {
        offset: place.offset,
        length: place.length,
        name: record.name.clone(),
    });
    let mut found = summary.metadata_indexes.clone();
    found.sort_by_key(|index| index.offset);
    check_equal(
        "the index of metadata",
        &found,
        &expected.collect(),
        |indexes| {
            list(
                indexes
                    .iter()
                    .map(|index| format!("{:?} at {}", index.name, index.offset)),
            )
        },
    )
}
