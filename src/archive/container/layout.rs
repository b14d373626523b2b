//! The layout of a file.

use super::channels::Channels;
use super::loss::{Loss, Span};
use super::record::{HEAD, RecordSpan, parse};
use super::scan::{Found, Scanner};
use super::section::{Buffers, Section, record_at};
use super::source::Source;
use crate::archive::error::RecordingError;
use crate::archive::format::LIBRARY_PREFIX;
use mcap::MAGIC;
use mcap::records::{Footer, Metadata, Record, op};
use std::io;

/// A file that is damaged in more places than this is not looked through further.
const MOST_LOSSES: usize = 1000;

/// Records outside of chunks are read in sections of about this size.
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
    /// Which conventions it keeps, by its own words.
    pub(crate) profile: String,
    pub(crate) sections: Vec<Section>,
    pub(crate) metadata: Vec<Metadata>,
    pub(crate) attachments: Vec<AttachmentSpan>,
    pub(crate) channels: Channels,
    /// Damage between the records.
    pub(crate) losses: Vec<Loss>,
    /// The end of the data, if the file has it.
    pub(crate) data_end: Option<u64>,
    /// The place of the footer.
    footer: Option<RecordSpan>,
    /// Whether the file ends as an MCAP file does.
    pub(crate) is_ended: bool,
}

impl Layout {
    /// Goes through a file.
    pub(crate) fn read(source: &Source) -> Result<Self, RecordingError> {
        let mut magic = Vec::new();
        source.read(0, MAGIC.len() as u64, &mut magic)?;
        if magic != MAGIC {
            return Err(RecordingError::NotMcap);
        }
        let mut layout = Self::default();
        let mut scanner = Scanner::new(source);
        while let Some(found) = scanner.next()? {
            match found {
                Found::Record(place) => layout.take(&place, source)?,
                Found::Damage(bytes) => {
                    let reason = "no readable record stands here".to_owned();
                    layout.losses.push(layout.loss(bytes, reason));
                    if layout.losses.len() > MOST_LOSSES {
                        break;
                    }
                }
                Found::End => layout.is_ended = true,
                Found::Cut(bytes) if !bytes.is_empty() => {
                    let reason = "the file ends within a record".to_owned();
                    layout.losses.push(layout.loss(bytes, reason));
                }
                Found::Cut(_) => {}
            }
        }
        layout.close_gaps();
        if layout.channels.is_empty() || !layout.summary_is_right(source)? {
            layout.find_channels(source);
        }
        Ok(layout)
    }

    /// Whether the file calls itself written by toprise.
    pub(crate) fn is_ours(&self) -> bool {
        self.library.starts_with(LIBRARY_PREFIX)
    }

    fn take(&mut self, place: &RecordSpan, source: &Source) -> io::Result<()> {
        match place.opcode {
            op::CHUNK => {
                let section = Section::of_chunk(place, source)?;
                self.sections.push(section);
            }
            // Behind the end of the data, schemas and channels are repeated.
            op::MESSAGE | op::SCHEMA | op::CHANNEL if self.data_end.is_none() => {
                self.take_loose(place);
                if place.opcode != op::MESSAGE {
                    self.take_small(place, source)?;
                }
            }
            op::ATTACHMENT => {
                let name = attachment_name(place, source)?;
                let place = place.clone();
                self.attachments.push(AttachmentSpan { name, place });
            }
            // A second one is damage: something else in the summary that has become one.
            op::DATA_END => self.data_end = self.data_end.or(Some(place.offset)),
            op::FOOTER => self.footer = Some(place.clone()),
            op::HEADER | op::SCHEMA | op::CHANNEL | op::METADATA => {
                self.take_small(place, source)?;
            }
            _ => {}
        }
        Ok(())
    }

    /// Adds a record outside of chunks to the section before it, if it continues that.
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

    /// A loss whose time span is not known yet, but for its beginning.
    fn loss(&self, bytes: std::ops::Range<u64>, reason: String) -> Loss {
        let from = self.sections.last().and_then(|section| section.span);
        Loss {
            offset: bytes.start,
            length: bytes.end - bytes.start,
            span: from.map(|(_, end)| Span {
                from_ns: end,
                to_ns: None,
            }),
            is_unread: false,
            reason,
        }
    }

    /// A loss between two chunks ends where the second begins.
    fn close_gaps(&mut self) {
        for loss in &mut self.losses {
            let next = self.sections.partition_point(|s| s.offset <= loss.offset);
            let next = self.sections.get(next);
            let start = next
                .and_then(|section| section.span)
                .map(|(start, _)| start);
            let behind_data = self.data_end.is_some_and(|end| loss.offset >= end);
            loss.span = match (loss.span, start) {
                _ if behind_data => None,
                (Some(span), _) => Some(Span {
                    to_ns: start,
                    ..span
                }),
                (None, Some(start)) => Some(Span {
                    from_ns: 0,
                    to_ns: Some(start),
                }),
                (None, None) => None,
            };
        }
    }

    /// Whether there is a summary that can be believed.
    fn summary_is_right(&self, source: &Source) -> io::Result<bool> {
        let (Some(footer), Some(_)) = (&self.footer, self.data_end) else {
            return Ok(false);
        };
        let Some(found) = read_footer(footer, source)? else {
            return Ok(false);
        };
        Ok(
            found.summary_crc == 0
                || summary_checksum(footer, &found, source)? == found.summary_crc,
        )
    }

    /// Finds the channels in the chunks: ours stand in the first, others' anywhere.
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
            if self.is_ours() && !self.channels.is_empty() {
                return;
            }
        }
        if self.channels.is_empty() {
            self.channels = in_summary;
        }
    }
}

/// Content of a footer, if it can be read.
pub(crate) fn read_footer(place: &RecordSpan, source: &Source) -> io::Result<Option<Footer>> {
    let mut bytes = Vec::new();
    source.read(place.offset, place.length, &mut bytes)?;
    let body = bytes.get(HEAD as usize..).unwrap_or_default();
    Ok(match parse(op::FOOTER, body) {
        Ok(Record::Footer(footer)) => Some(footer),
        _ => None,
    })
}

/// The checksum that the summary before a footer has.
pub(crate) fn summary_checksum(
    place: &RecordSpan,
    footer: &Footer,
    source: &Source,
) -> io::Result<u32> {
    // Opcode, length, and the two offsets belong to what is summed.
    source.checksum(footer.summary_start, place.offset + HEAD + 16)
}

fn attachment_name(place: &RecordSpan, source: &Source) -> io::Result<String> {
    let mut bytes = Vec::new();
    source.read(place.offset + HEAD + 16, 4, &mut bytes)?;
    let length = bytes.as_slice().try_into().map_or(0, u32::from_le_bytes);
    source.read(place.offset + HEAD + 20, u64::from(length), &mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
