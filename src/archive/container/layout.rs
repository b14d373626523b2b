//! The layout of a file.

use super::attachment::Attachment;
use super::channels::Channels;
use super::checksum::Checksum;
use super::loss::{Loss, Losses};
use super::record::{HEAD, RecordSpan, is_specified, parse};
use super::scan::{Found, Scanner};
use super::section::{Buffers, FileSection, record_at};
use super::source::Source;
use crate::archive::error::RecordingError;
use crate::archive::format::LIBRARY_PREFIX;
use mcap::MAGIC;
use mcap::records::{Metadata, Record, Statistics, op};
use std::collections::BTreeSet;
use std::io;
use std::mem;
use std::ops::Range;

/// Maximum number of damaged parts before scanning stops.
const MAX_LOSSES: u64 = 1000;

/// Approximate section size for records outside chunks.
const LOOSE_SECTION: u64 = 1 << 20;

/// The layout of a file.
#[derive(Debug, Default)]
pub(crate) struct Layout {
    /// Name of the library that wrote the file.
    pub(crate) library: String,
    /// The profile in its header.
    pub(crate) profile: String,
    pub(crate) sections: Vec<FileSection>,
    /// Metadata records with their places.
    pub(crate) metadata: Vec<(RecordSpan, Metadata)>,
    pub(crate) attachments: Vec<Attachment>,
    pub(crate) channels: Channels,
    /// Damage between the records, and damaged attachments.
    pub(crate) losses: Losses,
    /// Damage that only the checksums of data and summary show.
    pub(crate) wrong_checksums: Vec<Loss>,
    /// The record that ends the data, if the file has it.
    pub(crate) data_end: Option<RecordSpan>,
    /// The statistics in the summary, if the file has them. Of several, readers use the last.
    pub(crate) statistics: Option<Statistics>,
    /// The footer, if the file has it.
    pub(crate) footer: Option<RecordSpan>,
    /// Whether the file is complete: end of the data, footer and end magic.
    pub(crate) is_ended: bool,
    /// Start of the part at the end of a file that is cut off.
    pub(crate) cut: Option<u64>,
    /// The first record that the specification doesn't define. Readers skip such records.
    unspecified: Option<RecordSpan>,
}

impl Layout {
    /// Scans a file.
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
                Found::Record(place) => {
                    layout.add(&place, source)?;
                    // A file that is part of a longer one ends here: readers stop at the first footer, too.
                    if place.opcode == op::FOOTER && source.has_magic_at(place.end())? {
                        layout.end_at(place.end(), source);
                        break;
                    }
                }
                Found::Damage(bytes, damage) => {
                    layout.report_loss(bytes, &damage.to_string());
                    // A file of noise would be searched for hours.
                    if layout.losses.count() > MAX_LOSSES {
                        break;
                    }
                }
                Found::End => layout.end_at(source.length() - MAGIC.len() as u64, source),
                Found::Cut(bytes) => {
                    layout.cut = Some(bytes.start);
                    if !bytes.is_empty() {
                        layout.report_loss(bytes, "the file ends within a record");
                    }
                }
            }
        }
        layout.find_loss_times();
        layout.find_channels(source);
        layout.report_damaged_attachments();
        layout.check_unspecified(source)?;
        layout.wrong_checksums = layout.find_wrong_checksums(source)?;
        Ok(layout)
    }

    /// Whether the library field names toprise.
    pub(crate) fn is_ours(&self) -> bool {
        self.library.starts_with(LIBRARY_PREFIX)
    }

    /// Adds a record, in the order of the file.
    fn add(&mut self, place: &RecordSpan, source: &Source) -> io::Result<()> {
        if self.footer.is_some() {
            self.report_loss(place.offset..place.end(), "a record after the footer");
        }
        match place.opcode {
            op::CHUNK => {
                let section = FileSection::read_chunk(place, source)?;
                self.sections.push(section);
            }
            // The summary repeats schemas and channels.
            op::MESSAGE | op::SCHEMA | op::CHANNEL if self.data_end.is_none() => {
                self.add_record_outside_chunks(place);
            }
            op::MESSAGE => self.report_loss(
                place.offset..place.end(),
                "a message after the end of the data",
            ),
            op::ATTACHMENT => self.attachments.push(Attachment::read(place, source)?),
            // A second one is damage in the summary.
            op::DATA_END => {
                self.data_end.get_or_insert_with(|| place.clone());
            }
            op::FOOTER => self.footer = Some(place.clone()),
            op::HEADER | op::SCHEMA | op::CHANNEL | op::METADATA | op::STATISTICS => {
                self.read_record(place, source)?;
            }
            opcode if !is_specified(opcode) => {
                self.unspecified.get_or_insert_with(|| place.clone());
            }
            // Message indexes and the rest of the summary.
            _ => {}
        }
        Ok(())
    }

    /// Processes the magic bytes that end the file. What follows them is not read.
    fn end_at(&mut self, magic: u64, source: &Source) {
        let end = magic + MAGIC.len() as u64;
        self.is_ended = self.data_end.is_some() && self.footer.is_some();
        if !self.is_ended {
            self.report_loss(magic..end, "no end of the data or no footer before the end");
        }
        if end < source.length() {
            self.losses.push(Loss {
                offset: end,
                length: source.length() - end,
                is_unread: true,
                reason: "bytes after the end of the file".to_owned(),
                ..Loss::default()
            });
        }
    }

    /// Adds a record outside chunks to the preceding section if contiguous.
    fn add_record_outside_chunks(&mut self, place: &RecordSpan) {
        match self.sections.last_mut() {
            Some(last)
                if !last.is_chunk
                    && last.offset + last.length == place.offset
                    && last.length + place.length <= LOOSE_SECTION =>
            {
                last.length += place.length;
            }
            _ => self.sections.push(FileSection {
                offset: place.offset,
                length: place.length,
                is_chunk: false,
                span: None,
            }),
        }
    }

    /// Reads a record of the header or the summary, or the metadata of a run.
    fn read_record(&mut self, place: &RecordSpan, source: &Source) -> io::Result<()> {
        let mut bytes = Vec::new();
        source.read(place.offset, place.length, &mut bytes)?;
        let body = bytes.get(HEAD as usize..).unwrap_or_default();
        match parse(place.opcode, body) {
            Ok(Record::Header(header)) => {
                self.library = header.library;
                self.profile = header.profile;
            }
            Ok(Record::Statistics(record)) => self.statistics = Some(record),
            Ok(Record::Metadata(record)) => self.metadata.push((place.clone(), record)),
            Ok(record) => self.channels.define(record),
            // The scanner has parsed it already.
            Err(_) => {}
        }
        Ok(())
    }

    /// Reports bytes that can't be read.
    fn report_loss(&mut self, bytes: Range<u64>, reason: &str) {
        self.losses.push(Loss {
            offset: bytes.start,
            length: bytes.end - bytes.start,
            reason: reason.to_owned(),
            ..Loss::default()
        });
    }

    /// Finds the times of the losses: from the end of the chunk before it to the start of the next one. They are unknown
    /// where chunks don't follow each other in time.
    fn find_loss_times(&mut self) {
        let chunks: Vec<_> = self
            .sections
            .iter()
            // Both times of a chunk without messages are 0.
            .filter(|section| section.span != Some((0, 0)))
            .collect();
        for loss in self.losses.iter_mut() {
            let (earlier, later) =
                chunks.split_at(chunks.partition_point(|s| s.offset <= loss.offset));
            let previous = earlier.last().and_then(|section| section.span);
            let next = later.first().and_then(|section| section.span);
            if let (Some((_, end)), Some((start, _))) = (previous, next)
                && end > start
            {
                continue;
            }
            // The summary has no messages.
            let is_in_data = self
                .data_end
                .as_ref()
                .is_none_or(|end| loss.offset < end.offset);
            if is_in_data && (previous.is_some() || next.is_some()) {
                loss.from_ns = Some(previous.map_or(0, |(_, end)| end));
                loss.to_ns = next.map(|(start, _)| start);
            }
        }
    }

    /// Reports attachments with wrong checksums.
    fn report_damaged_attachments(&mut self) {
        for attachment in self.attachments.iter().filter(|a| !a.is_intact) {
            self.losses.push(Loss {
                offset: attachment.place.offset,
                length: attachment.place.length,
                reason: format!(
                    "the attachment {:?} has a wrong checksum",
                    attachment.header.name
                ),
                ..Loss::default()
            });
        }
    }

    /// Checks that records with unknown opcodes are not damaged ones, by the checksum of the data. If its writer computed
    /// none, they are skipped, as the specification demands: they may be private, or from a later version of the format.
    /// toprise itself writes no such records, so they are damage where its own file was cut off before the checksum.
    fn check_unspecified(&mut self, source: &Source) -> io::Result<()> {
        let Some(place) = self.unspecified.clone() else {
            return Ok(());
        };
        let is_explained = match self.data_checksum(source)? {
            Some(checksum) => checksum.matches(source)?,
            None => !self.is_ours() || self.data_end.is_some(),
        };
        if !is_explained {
            let reason = format!("a record with the unknown opcode {:#04x}", place.opcode);
            self.report_loss(place.offset..place.end(), &reason);
        }
        Ok(())
    }

    /// The checksum of the data; `None` if it was not computed.
    fn data_checksum(&self, source: &Source) -> io::Result<Option<Checksum>> {
        match &self.data_end {
            Some(data_end) => Checksum::read_data(data_end, source),
            None => Ok(None),
        }
    }

    /// Damage that only the checksums show: wherever other damage is known, they are wrong for that reason.
    fn find_wrong_checksums(&self, source: &Source) -> io::Result<Vec<Loss>> {
        let mut wrong = Vec::new();
        for checksum in self.checksums(source)? {
            if !checksum.matches(source)? {
                wrong.push(checksum.loss());
            }
        }
        Ok(wrong)
    }

    /// The checksums of the data and of the summary, as far as they were computed.
    pub(crate) fn checksums(&self, source: &Source) -> io::Result<Vec<Checksum>> {
        let mut checksums = Vec::from_iter(self.data_checksum(source)?);
        if let (Some(data_end), Some(footer)) = (&self.data_end, &self.footer) {
            checksums.extend(Checksum::read_summary(data_end, footer, source)?);
        }
        Ok(checksums)
    }

    /// Start of the summary according to the footer; `None` without a summary.
    pub(crate) fn summary_start(&self, source: &Source) -> io::Result<Option<u64>> {
        let Some(place) = &self.footer else {
            return Ok(None);
        };
        let mut bytes = Vec::new();
        source.read(place.offset + HEAD, 8, &mut bytes)?;
        let start = bytes.as_slice().try_into().map_or(0, u64::from_le_bytes);
        Ok((start != 0).then_some(start))
    }

    /// Finds the channels in the data, and further ones in the summary, whose checksum may be missing or wrong. toprise
    /// writes them to the first chunk, so the other chunks are not searched if the summary has the same channels.
    fn find_channels(&mut self, source: &Source) {
        let in_summary = mem::take(&mut self.channels);
        let mut buffers = Buffers::default();
        // The ids of channels with messages.
        let mut used = BTreeSet::new();
        for section in &self.sections {
            if section.load(source, &mut buffers).is_err() {
                // Readers of messages report the damage.
                continue;
            }
            let mut position = 0;
            while let Some(Ok((inner, next))) = record_at(&buffers.records, position) {
                position = next;
                match inner.opcode {
                    op::MESSAGE => used.extend(inner.channel_id()),
                    op::SCHEMA | op::CHANNEL => {
                        if let Ok(record) = parse(inner.opcode, inner.body) {
                            self.channels.define(record);
                        }
                    }
                    _ => {}
                }
            }
            if self.is_ours() && !self.channels.is_empty() && self.channels == in_summary {
                return;
            }
        }
        if self.is_ours() && !self.channels.is_empty() {
            // toprise defines all channels in the data. `verify` compares its summary with them.
            return;
        }
        if let Some(conflict) = self.channels.merge(&in_summary, &used)
            && let (Some(data_end), Some(footer)) = (&self.data_end, &self.footer)
        {
            self.losses.push(Loss {
                offset: data_end.end(),
                // In a damaged file the footer may come first.
                length: footer.offset.saturating_sub(data_end.end()),
                is_suspect: true,
                reason: format!("in the summary, {conflict}"),
                ..Loss::default()
            });
        }
    }
}
