//! The checksums of a file's two sections.

use super::loss::Loss;
use super::record::{HEAD, RecordSpan, parse};
use super::source::Source;
use mcap::records::Record;
use std::io;
use std::ops::Range;

/// A stored checksum and the bytes that it covers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Checksum {
    name: &'static str,
    part: Range<u64>,
    stored: u32,
}

impl Checksum {
    /// Checksum of the data section, which `place` ends; `None` if it was not computed.
    pub(crate) fn read_data(place: &RecordSpan, source: &Source) -> io::Result<Option<Self>> {
        let mut bytes = Vec::new();
        Ok(match read(place, source, &mut bytes)? {
            Some(Record::DataEnd(end)) if end.data_section_crc != 0 => Some(Self {
                name: "data",
                part: 0..place.offset,
                stored: end.data_section_crc,
            }),
            _ => None,
        })
    }

    /// Checksum of the summary, from the end of the data to the footer; `None` if it was not computed.
    pub(crate) fn read_summary(
        data_end: &RecordSpan,
        place: &RecordSpan,
        source: &Source,
    ) -> io::Result<Option<Self>> {
        let mut bytes = Vec::new();
        Ok(match read(place, source, &mut bytes)? {
            Some(Record::Footer(footer)) if footer.summary_crc != 0 => {
                // Without a summary the footer itself has a checksum.
                let start = match footer.summary_start {
                    0 => data_end.end(),
                    start => start,
                };
                Some(Self {
                    name: "summary",
                    // It includes the footer's opcode, length and two offsets.
                    part: start..place.offset + HEAD + 16,
                    stored: footer.summary_crc,
                })
            }
            _ => None,
        })
    }

    /// Whether the bytes have this checksum.
    pub(crate) fn matches(&self, source: &Source) -> io::Result<bool> {
        let Range { start, end } = self.part;
        Ok(source.checksum(start, end)? == self.stored)
    }

    /// The covered bytes as damaged ones.
    pub(crate) fn loss(&self) -> Loss {
        Loss {
            offset: self.part.start,
            length: self.part.end.saturating_sub(self.part.start),
            is_suspect: true,
            reason: format!("the checksum of the {} is wrong", self.name),
            ..Loss::default()
        }
    }
}

fn read<'a>(
    place: &RecordSpan,
    source: &Source,
    bytes: &'a mut Vec<u8>,
) -> io::Result<Option<Record<'a>>> {
    source.read(place.offset, place.length, bytes)?;
    let body = bytes.get(HEAD as usize..).unwrap_or_default();
    Ok(parse(place.opcode, body).ok())
}
