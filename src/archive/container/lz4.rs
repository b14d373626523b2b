//! LZ4 frames, for the chunks of a file and for the readers of the `mcap` crate (without its C library).

use lz4_flex::frame::FrameDecoder;
use mcap::McapResult;
use mcap::sans_io::decompressor::{DecompressResult, Decompressor};
use std::io::{self, Chain, Read};

/// The mark that ends a frame.
const END_MARK: &[u8] = &[0; 4];

/// Reads the content of LZ4 frames that follow each other.
pub(crate) struct Lz4Frames<'a> {
    /// Behind the data there is an end mark, which is read only if the last frame has none.
    decoder: FrameDecoder<Chain<&'a [u8], &'static [u8]>>,
    is_in_frame: bool,
}

impl<'a> Lz4Frames<'a> {
    pub(crate) fn new(data: &'a [u8]) -> Self {
        Self {
            decoder: FrameDecoder::new(data.chain(END_MARK)),
            is_in_frame: false,
        }
    }
}

impl Read for Lz4Frames<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            let (data, _) = self.decoder.get_ref().get_ref();
            if data.is_empty() && !self.is_in_frame {
                return Ok(0);
            }
            self.is_in_frame = true;
            let read = self.decoder.read(buffer)?;
            if read > 0 || buffer.is_empty() {
                return Ok(read);
            }
            self.is_in_frame = false;
            let (_, end_mark) = self.decoder.get_ref().get_ref();
            if end_mark.len() < END_MARK.len() {
                // Strict readers reject such a chunk.
                return Err(io::Error::other("an lz4 frame has no end mark"));
            }
        }
    }
}

/// Decompresses chunks for the readers of the `mcap` crate.
#[derive(Debug, Default)]
pub(crate) struct Lz4Decompressor {
    /// Content of the last frames, and how much of it has been returned.
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
            let mut content = Vec::new();
            // If a part of a frame is missing, the reader calls again with more.
            if Lz4Frames::new(src).read_to_end(&mut content).is_ok() {
                consumed = src.len();
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
    fn rejects_frames_without_an_end() {
        let whole = frame(b"content");
        for length in 1..whole.len() {
            assert!(read(&whole[..length]).is_err(), "{length} bytes");
        }
        let second = [&frame(b"one")[..], &whole[..whole.len() - 4]].concat();
        assert_eq!(read(&second).unwrap_err(), "an lz4 frame has no end mark");
    }
}
