//! Attachments: their headers, and their data read in constant memory.

use super::record::{HEAD, RecordSpan, attachment_fields};
use super::source::Source;
use mcap::records::AttachmentHeader;
use mcap::{McapResult, Writer};
use sha2::{Digest as _, Sha256};
use std::io::{self, Seek, Write};

/// Maximum length of an attachment's names, bytes; longer ones are truncated.
pub(crate) const MAX_NAMES: u64 = 1 << 16;

/// Number of bytes that are read at a time.
const PIECE: u64 = 1 << 20;

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
        // The data may be gigabytes long, and is not needed here.
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
        self.read_pieces(source, |piece| {
            hasher.update(piece);
            Ok::<(), io::Error>(())
        })?;
        let digest = format!("{:x}", hasher.finalize());
        let checked = if self.is_intact {
            ""
        } else {
            ", with a wrong checksum"
        };
        Ok(describe(&self.header, self.data_length, &digest) + checked)
    }

    /// Writes the attachment into another file.
    pub(crate) fn copy<W: Write + Seek>(
        &self,
        source: &Source,
        writer: &mut Writer<W>,
    ) -> McapResult<()> {
        writer.start_attachment(self.data_length, self.header.clone())?;
        self.read_pieces(source, |piece| writer.put_attachment_bytes(piece))?;
        writer.finish_attachment()
    }

    /// Reads the data piece by piece.
    fn read_pieces<E: From<io::Error>>(
        &self,
        source: &Source,
        mut take: impl FnMut(&[u8]) -> Result<(), E>,
    ) -> Result<(), E> {
        let (mut at, end) = (self.data_start, self.data_start + self.data_length);
        let mut bytes = Vec::new();
        while at < end {
            source.read(at, PIECE.min(end - at), &mut bytes)?;
            if bytes.is_empty() {
                return Err(io::Error::from(io::ErrorKind::UnexpectedEof).into());
            }
            take(&bytes)?;
            at += bytes.len() as u64;
        }
        Ok(())
    }
}

/// The header of an attachment and a SHA-256 of its data in words.
pub(crate) fn describe(header: &AttachmentHeader, length: u64, sha256: &str) -> String {
    format!(
        "{} of {length} bytes (SHA-256 {sha256}), logged at {} ns, created at {} ns",
        header.media_type, header.log_time, header.create_time
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use mcap::records::op;

    /// A file that is a large attachment, with another checksum if it is damaged.
    fn attachment(data: &[u8], is_damaged: bool) -> (Attachment, String) {
        let mut body = [7_u64.to_le_bytes(), 8_u64.to_le_bytes()].concat();
        for name in ["a.bin", "image/x"] {
            body.extend((name.len() as u32).to_le_bytes());
            body.extend(name.as_bytes());
        }
        body.extend((data.len() as u64).to_le_bytes());
        body.extend(data);
        let checksum = crc32fast::hash(&body) ^ u32::from(is_damaged);
        body.extend(checksum.to_le_bytes());
        // What a newer version of the format may add.
        body.extend([1, 2, 3]);
        let path = tempfile::NamedTempFile::new().unwrap().into_temp_path();
        let length = body.len() as u64;
        let record = [&[op::ATTACHMENT], &length.to_le_bytes()[..], &body].concat();
        std::fs::write(&path, &record).unwrap();
        let source = Source::open(&path).unwrap();
        let place = RecordSpan {
            opcode: op::ATTACHMENT,
            offset: 0,
            length: record.len() as u64,
        };
        let attachment = Attachment::read(&place, &source).unwrap();
        assert_eq!(attachment.data(&source).unwrap(), data);
        let description = attachment.describe(&source).unwrap();
        (attachment, description)
    }

    #[test]
    fn reads_large_attachments_in_pieces() {
        let mut data = vec![9; 2 * PIECE as usize + 1];
        let digest = format!("{:x}", Sha256::digest(&data));
        let (whole, description) = attachment(&data, false);
        assert_eq!(whole.header.name, "a.bin");
        assert!(whole.is_intact);
        let length = data.len();
        let expected = format!(
            "image/x of {length} bytes (SHA-256 {digest}), logged at 7 ns, created at 8 ns"
        );
        assert_eq!(description, expected);
        // The last byte counts.
        data[2 * PIECE as usize] ^= 1;
        assert_ne!(attachment(&data, false).1, expected);
        assert!(!attachment(&data, true).0.is_intact);
    }
}
