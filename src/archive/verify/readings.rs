//! Reads a file as other software does, with the readers of the `mcap` crate: in the order of the file, and through its
//! index in order of time, as viewers do.
//!
//! All readings must have the same messages. Otherwise others would see something else than what was verified.

use super::difference::Difference;
use super::error::{IndexFault, VerifyError};
use super::fingerprint::Fingerprint;
use super::index::{self, Chunks};
use crate::archive::container::lz4::Lz4Decompressor;
use crate::archive::container::source::Source;
use crate::archive::recording::{Recording, Selection};
use mcap::sans_io::{
    IndexedReadEvent, IndexedReader, IndexedReaderOptions, LinearReaderOptions, MessageReadEvent,
    MessageReader, SummaryReadEvent, SummaryReader, SummaryReaderOptions,
};
use mcap::{McapResult, Summary};
use std::io::{self, SeekFrom};

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
    let found = match read_in_file_order(&recording.source) {
        Ok(linear) => between(recording, "the order of the file", &linear, &own),
        Err(error) => Some(unreadable("the file", &error)),
    };
    if found.is_some() {
        return Ok(found);
    }
    if let Some(difference) = check_footer(recording)? {
        return Ok(Some(difference));
    }
    let summary = match read_summary(&recording.source) {
        Ok(Some(summary)) => summary,
        // Readers then use the order of the file.
        Ok(None) => return Ok(None),
        Err(error) => return Ok(Some(unreadable("the summary", &error))),
    };
    let chunks = match index::check(recording, &summary, &own) {
        Ok(chunks) => chunks,
        Err(IndexFault::Contradiction(difference)) => return Ok(Some(difference)),
        Err(IndexFault::Io(error)) => return Err(error.into()),
    };
    if summary.chunk_indexes.is_empty() && chunks.is_empty() {
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

/// Checks that the footer leads to the start of the summary: behind the data. The summary's records were found from
/// there, so its reader meets no others.
fn check_footer(recording: &Recording) -> Result<Option<Difference>, VerifyError> {
    let layout = &recording.layout;
    let (Some(end), Some(start)) = (&layout.data_end, layout.summary_start(&recording.source)?)
    else {
        return Ok(None);
    };
    let texts = [start, end.end()].map(|offset| Some(offset.to_string()));
    let is_right = start == end.end();
    Ok((!is_right).then(|| Difference::new("the footer", "start of the summary", texts)))
}

fn unreadable(place: &str, error: &mcap::McapError) -> Difference {
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
