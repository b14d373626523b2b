//! LZ4 frames, for the chunks of a file and for the readers of the `mcap` crate (without its C library).

use lz4_flex::frame::FrameDecoder;
use mcap::McapResult;
use mcap::sans_io::decompressor::{DecompressResult, Decompressor};
use std::io::{self, Chain, Read};

/// The mark that ends a frame.
const END_MARK: &[u8] = &[0; 4];

/// The magic numbers of a frame with data, and of one that decoders skip; the last four bits of the latter are free.
const DATA: u32 = 0x184d_2204;
const SKIPPED: u32 = 0x184d_2a50;

/// An end mark follows the data; it is read only if the last frame has none.
type FrameReader<'a> = FrameDecoder<Chain<&'a [u8], &'static [u8]>>;

/// Reads the content of LZ4 frames that follow each other.
///
/// Frames that decoders skip may stand among them. Some writers pad the last frame: bytes that start with neither
/// magic number are ignored, as after Zstandard frames.
pub(crate) struct Lz4Frames<'a> {
    rest: &'a [u8],
    decoder: Option<FrameReader<'a>>,
    is_padding_possible: bool,
}

impl<'a> Lz4Frames<'a> {
    pub(crate) fn new(data: &'a [u8]) -> Self {
        Self {
            rest: data,
            decoder: None,
            is_padding_possible: false,
        }
    }

    /// The decoder of the next frame with data; `None` at the end.
    fn next_frame(&mut self) -> io::Result<Option<FrameReader<'a>>> {
        loop {
            let number = self.rest.first_chunk().copied().map(u32::from_le_bytes);
            match number {
                Some(number) if number & !0xf == SKIPPED => self.skip_frame()?,
                Some(DATA) => break,
                _ if self.rest.is_empty() || self.is_padding_possible => return Ok(None),
                // The decoder says what is wrong.
                _ => break,
            }
        }
        Ok(Some(FrameDecoder::new(self.rest.chain(END_MARK))))
    }

    /// Skips a frame without data: its number, its length and as many bytes.
    fn skip_frame(&mut self) -> io::Result<()> {
        let length = self.rest.get(4..8).and_then(|bytes| bytes.try_into().ok());
        self.rest = length
            .and_then(|length| usize::try_from(u32::from_le_bytes(length)).ok())
            .and_then(|length| self.rest.get(8..)?.get(length..))
            .ok_or(io::ErrorKind::UnexpectedEof)?;
        self.is_padding_possible = true;
        Ok(())
    }

    /// Ends a frame that has been read.
    fn end_frame(&mut self, decoder: &FrameReader<'a>) -> io::Result<()> {
        let (rest, end_mark) = decoder.get_ref().get_ref();
        if end_mark.len() < END_MARK.len() {
            // Strict readers reject such a chunk.
            return Err(io::Error::other("an lz4 frame has no end mark"));
        }
        self.rest = rest;
        self.is_padding_possible = true;
        Ok(())
    }

    /// Reads a whole frame with data, if there is one, and what is skipped before it. Returns the content.
    fn read_frame(&mut self) -> io::Result<Vec<u8>> {
        let mut content = Vec::new();
        if let Some(mut decoder) = self.next_frame()? {
            decoder.read_to_end(&mut content)?;
            self.end_frame(&decoder)?;
        }
        Ok(content)
    }
}

impl Read for Lz4Frames<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if buffer.is_empty() {
            return Ok(0);
        }
        loop {
            let mut decoder = match self.decoder.take() {
                Some(decoder) => decoder,
                None => match self.next_frame()? {
                    Some(decoder) => decoder,
                    None => return Ok(0),
                },
            };
            let length = decoder.read(buffer)?;
            if length > 0 {
                self.decoder = Some(decoder);
                return Ok(length);
            }
            self.end_frame(&decoder)?;
        }
    }
}

/// Decompresses chunks for the readers of the `mcap` crate.
#[derive(Debug, Default)]
pub(crate) struct Lz4Decompressor {
    /// Content of the last frame, and how much of it has been returned.
    content: Vec<u8>,
    returned: usize,
}

impl Decompressor for Lz4Decompressor {
    fn next_read_size(&self) -> usize {
        0
    }

    fn decompress(&mut self, src: &[u8], dst: &mut [u8]) -> McapResult<DecompressResult> {
        let mut consumed = 0;
        if self.returned == self.content.len() {
            let mut frames = Lz4Frames::new(src);
            // One frame: after the last there may be padding, which the reader leaves. If a part of a frame is missing, it
            // calls again with more.
            if let Ok(content) = frames.read_frame() {
                consumed = src.len() - frames.rest.len();
                (self.content, self.returned) = (content, 0);
            }
        }
        let rest = &self.content[self.returned..];
        let wrote = rest.len().min(dst.len());
        dst[..wrote].copy_from_slice(&rest[..wrote]);
        self.returned += wrote;
        Ok(DecompressResult { consumed, wrote })
    }

    fn reset(&mut self) -> McapResult<()> {
        *self = Self::default();
        Ok(())
    }

    fn name(&self) -> &'static str {
        "lz4"
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lz4_flex::frame::FrameEncoder;
    use std::io::Write as _;

    fn frame(content: &[u8]) -> Vec<u8> {
        let mut encoder = FrameEncoder::new(Vec::new());
        encoder.write_all(content).unwrap();
        encoder.finish().unwrap()
    }

    fn read(data: &[u8]) -> Result<Vec<u8>, String> {
        let mut content = Vec::new();
        let read = Lz4Frames::new(data).read_to_end(&mut content);
        read.map(|_| content).map_err(|error| error.to_string())
    }

    #[test]
    fn reads_all_frames() {
        let content = vec![7; 300_000];
        let frames = [frame(&content), frame(b"more"), frame(b"")].concat();
        assert_eq!(read(&frames).unwrap(), [&content[..], b"more"].concat());
        assert_eq!(read(b"").unwrap(), b"");
    }

    #[test]
    fn reads_frames_with_trailing_data() {
        let [a, b] = [frame(b"abc"), frame(b"de")];
        let skipped = [&[0x5a, 0x2a, 0x4d, 0x18, 2, 0, 0, 0][..], b"xy"].concat();
        for (name, data, expected) in [
            ("padding", [&a[..], &[0; 3]].concat(), &b"abc"[..]),
            ("longer padding", [&a[..], &[0xff; 40]].concat(), b"abc"),
            ("a skipped frame", [&a[..], &skipped, &b].concat(), b"abcde"),
            ("a skipped frame first", [&skipped[..], &b].concat(), b"de"),
            ("a skipped frame last", [&a[..], &skipped].concat(), b"abc"),
        ] {
            assert_eq!(read(&data).as_deref(), Ok(expected), "{name}");
            assert_eq!(decompressed(&data, expected.len(), 1), expected, "{name}");
        }
        let cut = [&a[..], &skipped[..9]].concat();
        assert!(read(&cut).is_err());
    }

    /// The content as the readers of the `mcap` crate get it, from a growing number of bytes.
    fn decompressed(data: &[u8], length: usize, growth: usize) -> Vec<u8> {
        let mut decompressor = Lz4Decompressor::default();
        let (mut content, mut consumed, mut available) = (Vec::new(), 0, 0);
        while content.len() < length {
            available = data.len().min(available + growth);
            let mut buffer = [0; 2];
            let part = buffer.len().min(length - content.len());
            let result = decompressor
                .decompress(&data[consumed..available], &mut buffer[..part])
                .unwrap();
            consumed += result.consumed;
            content.extend(&buffer[..result.wrote]);
        }
        content
    }

    #[test]
    fn rejects_frames_without_an_end() {
        let whole = frame(b"content");
        for length in 1..whole.len() {
            assert!(read(&whole[..length]).is_err(), "{length} bytes");
        }
        let second = [&frame(b"one")[..], &whole[..whole.len() - 4]].concat();
        assert_eq!(read(&second).unwrap_err(), "an lz4 frame has no end mark");
    }
}
