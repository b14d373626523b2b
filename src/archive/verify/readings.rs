//! Reads a file as other software does, with the readers of the `mcap` crate: in the order of the file, and through its
//! index in order of time, as viewers do.
//!
//! All readings must have the same messages. Otherwise others would see something else than what was verified.

use super::difference::Difference;
use super::error::{IndexFault, VerifyError};
use super::fingerprint::Fingerprint;
use super::index::{self, Chunks};
use crate::archive::container::lz4::Lz4Decompressor;
use crate::archive::container::record::{HEAD, head, parse};
use crate::archive::container::source::Source;
use crate::archive::recording::{Recording, Selection};
use mcap::records::Record;
use mcap::sans_io::{
    IndexedReadEvent, IndexedReader, IndexedReaderOptions, LinearReaderOptions, MessageReadEvent,
    MessageReader, SummaryReadEvent, SummaryReader, SummaryReaderOptions,
};
use mcap::{Channel, McapError, McapResult, Schema, Summary};
use std::io::{self, SeekFrom};
use std::sync::Arc;

/// Maximum length of a record, bytes.
const MAX_RECORD: usize = 256 << 20;
/// Maximum size of the chunks that the index reading holds at the same time, MiB.
const MAX_OVERLAP: u64 = 256;

/// The first difference between the readings of a complete file.
pub(super) fn difference(recording: &Recording) -> Result<Option<Difference>, VerifyError> {
    let mut own = Fingerprint::default();
    let mut reader = recording.reader(Selection::default());
    while let Some(message) = reader.next_undecoded() {
        own.add_undecoded(&message);
    }
    let statistics_fault = reader.statistics_fault();
    let found = match read_in_file_order(&recording.source) {
        Ok(linear) => between(recording, "the order of the file", &linear, &own),
        Err(error) => Some(unreadable("the file", &error)),
    };
    if found.is_some() {
        return Ok(found);
    }
    if let Some(fault) = statistics_fault {
        let values = [fault.stated, fault.found].map(|number| Some(number.to_string()));
        return Ok(Some(Difference::new("the statistics", &fault.name, values)));
    }
    if let Some(difference) = check_footer(recording)? {
        return Ok(Some(difference));
    }
    let summary = match read_summary(&recording.source) {
        Ok(Some(summary)) => summary,
        // The summary repeats channels without their schemas: those are found in the data.
        Err(McapError::UnknownSchema(..)) => collect_summary(recording)?,
        // Readers then use the order of the file.
        Ok(None) => return Ok(None),
        Err(error) => return Ok(Some(unreadable("the summary", &error))),
    };
    let chunks = match index::check(recording, &summary) {
        Ok(chunks) => chunks,
        Err(IndexFault::Contradiction(difference)) => return Ok(Some(difference)),
        Err(IndexFault::Io(error)) => return Err(error.into()),
    };
    // Without an index of chunks viewers, too, read in the order of the file.
    if summary.chunk_indexes.is_empty() {
        return Ok(None);
    }
    check_overlap(&chunks, MAX_OVERLAP)?;
    Ok(match read_through_index(&recording.source, &summary) {
        Ok((indexed, true)) => between(recording, "the index", &indexed, &own),
        Ok((_, false)) => {
            let texts = ["not by time", "by time"].map(|text| Some(text.to_owned()));
            Some(Difference::new("the index", "order of messages", texts))
        }
        Err(error) => Some(unreadable("the index", &error)),
    })
}

/// Checks that the footer leads to the start of the summary, which follows the data. The summary's records were found from
/// there, so its reader meets no others.
fn check_footer(recording: &Recording) -> Result<Option<Difference>, VerifyError> {
    let layout = &recording.layout;
    let (Some(end), Some(start)) = (&layout.data_end, layout.summary_start(&recording.source)?)
    else {
        return Ok(None);
    };
    let texts = [start, end.end()].map(|offset| Some(offset.to_string()));
    Ok((start != end.end()).then(|| Difference::new("the footer", "start of the summary", texts)))
}

fn unreadable(place: &str, error: &McapError) -> Difference {
    let readable = "what other software can read".to_owned();
    Difference::new(place, "", [error.to_string(), readable].map(Some))
}

/// The first channel that has other messages when it is read in another way.
fn between(
    recording: &Recording,
    reading: &str,
    other: &Fingerprint,
    own: &Fingerprint,
) -> Option<Difference> {
    let (channel, both) = other.first_difference(own, recording.channels())?;
    let counts = both.map(|channel| channel.messages);
    let texts = match counts {
        [other, own] if other != own => counts.map(|count| format!("{count} messages")),
        [count, _] => [
            format!("{count} other messages"),
            format!("{count} messages"),
        ],
    };
    let field = format!("messages read through {reading}");
    Some(Difference::new(&channel.topic, &field, texts.map(Some)))
}

fn read_in_file_order(source: &Source) -> McapResult<Fingerprint> {
    let options = LinearReaderOptions::default()
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(MAX_RECORD);
    let mut reader = MessageReader::new_with_options(options);
    reader.add_decompressor(Lz4Decompressor::default())?;
    let mut found = Fingerprint::default();
    let mut bytes = Vec::new();
    let mut position = 0;
    while let Some(event) = reader.next_event() {
        match event? {
            MessageReadEvent::ReadRequest(length) => {
                source.read(position, length as u64, &mut bytes)?;
                reader.insert(bytes.len()).copy_from_slice(&bytes);
                reader.notify_read(bytes.len());
                position += bytes.len() as u64;
            }
            MessageReadEvent::Message(message) => found.add_message(&message),
        }
    }
    Ok(found)
}

fn read_summary(source: &Source) -> McapResult<Option<Summary>> {
    let options = SummaryReaderOptions::default()
        .with_file_size(source.length())
        .with_record_length_limit(MAX_RECORD);
    let mut reader = SummaryReader::new_with_options(options);
    let mut bytes = Vec::new();
    let mut position = 0;
    while let Some(event) = reader.next_event() {
        match event? {
            SummaryReadEvent::ReadRequest(length) => {
                source.read(position, length as u64, &mut bytes)?;
                reader.insert(bytes.len()).copy_from_slice(&bytes);
                reader.notify_read(bytes.len());
                position += bytes.len() as u64;
            }
            SummaryReadEvent::SeekRequest(target) => {
                position = match target {
                    SeekFrom::Start(position) => position,
                    SeekFrom::End(offset) => source.length().saturating_add_signed(offset),
                    SeekFrom::Current(offset) => position.saturating_add_signed(offset),
                };
                reader.notify_seeked(position);
            }
        }
    }
    Ok(reader.finish())
}

/// Reads a summary whose channels have their schemas in the data.
fn collect_summary(recording: &Recording) -> io::Result<Summary> {
    let layout = &recording.layout;
    let mut summary = Summary::default();
    let mut channels = Vec::new();
    let mut bytes = Vec::new();
    let mut position = layout.summary_start(&recording.source)?.unwrap_or(u64::MAX);
    let end = layout.footer.as_ref().map_or(0, |footer| footer.offset);
    while position < end {
        recording.source.read(position, HEAD, &mut bytes)?;
        let (opcode, length) = head(&bytes).ok_or(io::ErrorKind::UnexpectedEof)?;
        recording.source.read(position + HEAD, length, &mut bytes)?;
        position += HEAD + length;
        // Opening the file has found invalid records already.
        match parse(opcode, &bytes) {
            Ok(Record::ChunkIndex(index)) => summary.chunk_indexes.push(index),
            Ok(Record::AttachmentIndex(index)) => summary.attachment_indexes.push(index),
            Ok(Record::MetadataIndex(index)) => summary.metadata_indexes.push(index),
            Ok(Record::Channel(channel)) => channels.push(channel),
            _ => {}
        }
    }
    for channel in channels {
        let schema = layout.channels.schema(channel.schema_id).map(|schema| {
            Arc::new(Schema {
                id: channel.schema_id,
                name: schema.name.clone(),
                encoding: schema.encoding.clone(),
                data: schema.data.clone().into(),
            })
        });
        let channel = Channel {
            id: channel.id,
            topic: channel.topic,
            schema,
            message_encoding: channel.message_encoding,
            metadata: channel.metadata,
        };
        summary.channels.insert(channel.id, Arc::new(channel));
    }
    Ok(summary)
}

/// Reads the messages through the index; also returns whether they came in order of time.
fn read_through_index(source: &Source, summary: &Summary) -> McapResult<(Fingerprint, bool)> {
    let options = IndexedReaderOptions::new().with_record_length_limit(MAX_RECORD);
    let mut reader = IndexedReader::new_with_options(summary, options)?;
    reader.add_decompressor(Lz4Decompressor::default())?;
    let mut found = Fingerprint::default();
    let mut bytes = Vec::new();
    let (mut last, mut is_in_order) = (0, true);
    while let Some(event) = reader.next_event() {
        match event? {
            IndexedReadEvent::ReadChunkRequest { offset, length } => {
                source.read(offset, length as u64, &mut bytes)?;
                if bytes.len() < length {
                    return Err(io::Error::from(io::ErrorKind::UnexpectedEof).into());
                }
                reader.insert_chunk_record_data(offset, &bytes)?;
            }
            IndexedReadEvent::Message { header, data } => {
                is_in_order &= last <= header.log_time;
                last = header.log_time;
                found.add(&header, data);
            }
        }
    }
    Ok((found, is_in_order))
}

/// Checks that reading the chunks in order of time takes at most `limit` MiB of memory.
fn check_overlap(chunks: &Chunks, limit: u64) -> Result<(), VerifyError> {
    // A chunk is in memory from its first message to its last.
    let mut changes: Vec<(u64, bool, u64)> = Vec::new();
    for chunk in chunks.values() {
        changes.push((chunk.first, false, chunk.size));
        changes.push((chunk.last, true, chunk.size));
    }
    // At one time starts come before ends, since a chunk that ends there is still needed.
    changes.sort_unstable();
    let (mut size, mut most) = (0, 0);
    for (_, is_end, of_chunk) in changes {
        if is_end {
            size -= of_chunk;
        } else {
            size += of_chunk;
            most = most.max(size);
        }
    }
    let needed = most.div_ceil(1 << 20);
    if needed > limit {
        return Err(VerifyError::Overlap { needed, limit });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::index::Chunk;
    use super::*;

    fn chunks(times: [(u64, u64); 3]) -> Chunks {
        let size = 3 << 20;
        let chunk = |(first, last)| Chunk { first, last, size };
        (0..).zip(times.map(chunk)).collect()
    }

    #[test]
    fn refuses_chunks_that_overlap_too_much() {
        let followed = chunks([(0, 9), (10, 19), (20, 29)]);
        assert!(check_overlap(&followed, 3).is_ok());
        assert!(check_overlap(&followed, 2).is_err());
        // Two of three overlap, in an instant or longer.
        for times in [[(0, 9), (9, 19), (20, 29)], [(0, 25), (10, 19), (20, 29)]] {
            assert!(check_overlap(&chunks(times), 6).is_ok());
            let error = check_overlap(&chunks(times), 5).unwrap_err().to_string();
            assert!(error.contains("takes 6 MiB of memory"), "{error}");
            assert!(error.contains("sort it by log time first"), "{error}");
        }
    }
}
