//! Attachments: their headers, and their data read in constant memory.

use super::record::{HEAD, RecordSpan, attachment_fields};
use super::source::Source;
use sha2::{Digest as _, Sha256};
use std::io;

/// Maximum length of an attachment's names, bytes; longer ones are truncated.
pub(crate) const MAX_NAMES: u64 = 1 << 16;

/// Number of bytes that are read at a time.
const PIECE: u64 = 1 << 20;

/// Header of an attachment.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct AttachmentHeader {
    pub(crate) name: String,
    pub(crate) media_type: String,
    /// Time of logging, ns.
    pub(crate) log_time: u64,
    /// Time of creation, ns.
    pub(crate) create_time: u64,
}

/// An attachment of a file, without its data.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Attachment {
    pub(crate) place: RecordSpan,
    pub(crate) header: AttachmentHeader,
    /// Start of the data in the file.
    data_start: u64,
    /// Length of the data, bytes.
    pub(crate) data_length: u64,
    /// Whether the checksum is missing (0) or correct.
    pub(crate) is_intact: bool,
}

impl Attachment {
    /// Reads an attachment's header and checks its checksum.
    pub(crate) fn read(place: &RecordSpan, source: &Source) -> io::Result<Self> {
        let mut bytes = Vec::new();
        let length = place.length.min(HEAD + MAX_NAMES);
        source.read(place.offset, length, &mut bytes)?;
        let body = bytes.get(HEAD as usize..).unwrap_or_default();
        let (header, start, data_length) =
            attachment_fields(body).ok_or(io::ErrorKind::UnexpectedEof)?;
        let data_start = place.offset + HEAD + start;
        let data_end = data_start.saturating_add(data_length);
        source.read(data_end, 4, &mut bytes)?;
        let expected = bytes.as_slice().try_into().map_or(0, u32::from_le_bytes);
        // Zero means that no checksum was computed.
        let is_intact =
            expected == 0 || source.checksum(place.offset + HEAD, data_end)? == expected;
        Ok(Self {
            place: place.clone(),
            header,
            data_start,
            data_length,
            is_intact,
        })
    }

    /// Reads the data.
    pub(crate) fn data(&self, source: &Source) -> io::Result<Vec<u8>> {
        let mut data = Vec::new();
        source.read(self.data_start, self.data_length, &mut data)?;
        Ok(data)
    }

    /// Media type, size, SHA-256 and times in words.
    pub(crate) fn describe(&self, source: &Source) -> io::Result<String> {
        let mut hasher = Sha256::new();
        let (mut at, end) = (self.data_start, self.data_start + self.data_length);
        let mut bytes = Vec::new();
        while at < end {
            source.read(at, PIECE.min(end - at), &mut bytes)?;
            if bytes.is_empty() {
                return Err(io::ErrorKind::UnexpectedEof.into());
            }
            hasher.update(&bytes);
            at += bytes.len() as u64;
        }
        let digest = format!("{:x}", hasher.finalize());
        let checked = if self.is_intact {
            ""
        } else {
            ", with a wrong checksum"
        };
        Ok(self.header.describe(self.data_length, &digest) + checked)
    }
}

impl AttachmentHeader {
    /// The header and a SHA-256 of the data in words.
    pub(crate) fn describe(&self, length: u64, sha256: &str) -> String {
        format!(
            "{} of {length} bytes (SHA-256 {sha256}), logged at {} ns, created at {} ns",
            self.media_type, self.log_time, self.create_time
        )
    }
}
