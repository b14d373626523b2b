//! The layout of a file.

use super::channels::Channels;
use super::loss::Loss;
use super::record::{HEAD, RecordSpan, parse};
use super::scan::{Found, Scanner};
use super::section::{Buffers, Section, record_at};
use super::source::Source;
use crate::archive::error::RecordingError;
use crate::archive::format::LIBRARY_PREFIX;
use mcap::MAGIC;
use mcap::records::{Metadata, Record, op};
use std::io;

/// Maximum number of damaged parts before scanning stops.
const MOST_LOSSES: usize = 1000;

/// Approximate section size for records outside chunks.
const LOOSE_SECTION: u64 = 1 << 20;

/// The place of an attachment, and its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct AttachmentSpan {
    pub(crate) name: String,
    pub(crate) place: RecordSpan,
}

/// The layout of a file.
#[derive(Debug, Default)]
pub(crate) struct Layout {
    /// Name of the library that wrote the file.
    pub(crate) library: String,
    /// The profile in its header.
    pub(crate) profile: String,
    pub(crate) sections: Vec<Section>,
    pub(crate) metadata: Vec<Metadata>,
    pub(crate) attachments: Vec<AttachmentSpan>,
    pub(crate) channels: Channels,
    /// Damage between the records.
    pub(crate) losses: Vec<Loss>,
    /// The end of the data, if the file has it.
    pub(crate) data_end: Option<u64>,
    /// Whether the file has the end magic.
    pub(crate) is_ended: bool,
}

impl Layout {
    /// Scans a file.
    pub(crate) fn read(source: &Source) -> Result<Self, RecordingError> {
        let mut magic = Vec::new();
        source.read(0, MAGIC.len() as u64, &mut magic)?;
        if magic != MAGIC {
            return Err(RecordingError::because(
                "not an MCAP file (wrong magic bytes)",
            ));
        }
        let mut layout = Self::default();
        let mut scanner = Scanner::new(source);
        while let Some(found) = scanner.next()? {
            match found {
                Found::Record(place) => layout.take(&place, source)?,
                Found::Damage(bytes) => {
                    layout.lose(bytes, "no readable record");
                    if layout.losses.len() > MOST_LOSSES {
                        break;
                    }
                }
                Found::End => layout.is_ended = true,
                Found::Cut(bytes) if !bytes.is_empty() => {
                    layout.lose(bytes, "the file ends within a record");
                }
                Found::Cut(_) => {}
            }
        }
        layout.time_losses();
        layout.find_channels(source);
        Ok(layout)
    }

    /// Whether the library field names toprise.
    pub(crate) fn is_ours(&self) -> bool {
        self.library.starts_with(LIBRARY_PREFIX)
    }

    fn take(&mut self, place: &RecordSpan, source: &Source) -> io::Result<()> {
        match place.opcode {
            op::CHUNK => {
                let section = Section::of_chunk(place, source)?;
                self.sections.push(section);
            }
            // The summary repeats schemas and channels.
            op::MESSAGE | op::SCHEMA | op::CHANNEL if self.data_end.is_none() => {
                self.take_loose(place);
            }
            op::ATTACHMENT => {
                let name = attachment_name(place, source)?;
                let place = place.clone();
                self.attachments.push(AttachmentSpan { name, place });
            }
            // A second one is damage in the summary.
            op::DATA_END => self.data_end = self.data_end.or(Some(place.offset)),
            op::HEADER | op::SCHEMA | op::CHANNEL | op::METADATA => {
                self.take_small(place, source)?;
            }
            _ => {}
        }
        Ok(())
    }

    /// Adds a record outside chunks to the preceding section if contiguous.
    fn take_loose(&mut self, place: &RecordSpan) {
        match self.sections.last_mut() {
            Some(last)
                if !last.is_chunk
                    && last.offset + last.length == place.offset
                    && last.length < LOOSE_SECTION =>
            {
                last.length += place.length;
            }
            _ => self.sections.push(Section {
                offset: place.offset,
                length: place.length,
                is_chunk: false,
                span: None,
            }),
        }
    }

    fn take_small(&mut self, place: &RecordSpan, source: &Source) -> io::Result<()> {
        let mut bytes = Vec::new();
        source.read(place.offset, place.length, &mut bytes)?;
        let body = bytes.get(HEAD as usize..).unwrap_or_default();
        match parse(place.opcode, body) {
            Ok(Record::Header(header)) => {
                self.library = header.library;
                self.profile = header.profile;
            }
            Ok(Record::Metadata(record)) => self.metadata.push(record),
            Ok(record) => self.channels.define(record),
            Err(_) => {}
        }
        Ok(())
    }

    /// Records bytes that can't be read.
    fn lose(&mut self, bytes: std::ops::Range<u64>, reason: &str) {
        self.losses.push(Loss {
            offset: bytes.start,
            length: bytes.end - bytes.start,
            reason: reason.to_owned(),
            ..Loss::default()
        });
    }

    /// Finds the times of the losses: from the end of the chunk before it to the start of the next one.
    fn time_losses(&mut self) {
        for loss in &mut self.losses {
            let next = self.sections.partition_point(|s| s.offset <= loss.offset);
            let (before, behind) = self.sections.split_at(next);
            let before = before.last().and_then(|section| section.span);
            let behind = behind.first().and_then(|section| section.span);
            let is_in_data = self.data_end.is_none_or(|end| loss.offset < end);
            if is_in_data && (before.is_some() || behind.is_some()) {
                loss.from_ns = Some(before.map_or(0, |(_, end)| end));
                loss.to_ns = behind.map(|(start, _)| start);
            }
        }
    }

    /// Finds the channels in the data. toprise writes them to the first chunk, so the other chunks are not searched if
    /// the summary has the same channels. Without any, those of the summary are used; its checksum may be missing or
    /// wrong.
    fn find_channels(&mut self, source: &Source) {
        let in_summary = std::mem::take(&mut self.channels);
        let mut buffers = Buffers::default();
        for section in &self.sections {
            if section.load(source, &mut buffers).is_err() {
                continue;
            }
            let mut position = 0;
            while let Some(Ok((inner, next))) = record_at(&buffers.records, position) {
                position = next;
                if matches!(inner.opcode, op::SCHEMA | op::CHANNEL)
                    && let Ok(record) = parse(inner.opcode, inner.body)
                {
                    self.channels.define(record);
                }
            }
            if self.is_ours() && !self.channels.is_empty() && self.channels == in_summary {
                return;
            }
        }
        if self.channels.is_empty() {
            self.channels = in_summary;
        }
    }
}

fn attachment_name(place: &RecordSpan, source: &Source) -> io::Result<String> {
    let mut bytes = Vec::new();
    source.read(place.offset + HEAD + 16, 4, &mut bytes)?;
    let length = bytes.as_slice().try_into().map_or(0, u32::from_le_bytes);
    source.read(place.offset + HEAD + 20, u64::from(length), &mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
