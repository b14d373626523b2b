//! Zstandard frames of the chunks of a file.

use std::io::{self, Read};
use zstd::stream::read::Decoder;

/// The numbers with which a frame starts: data, and data that decoders skip, of which the last four bits are free.
const DATA: u32 = 0xfd2f_b528;
const SKIPPED: u32 = 0x184d_2a50;

/// Reads the content of Zstandard frames that follow each other, each to its end and with its checksum.
///
/// Some writers pad the last frame; what starts with none of the numbers is ignored.
pub(crate) struct ZstdFrames<'a> {
    rest: &'a [u8],
    decoder: Option<Decoder<'a, &'a [u8]>>,
    max_window: u32,
    is_padding_possible: bool,
}

impl<'a> ZstdFrames<'a> {
    /// The frames in `data`, whose windows have at most 2 to the power of `max_window` bytes.
    pub(crate) fn new(data: &'a [u8], max_window: u32) -> Self {
        Self {
            rest: data,
            decoder: None,
            max_window,
            is_padding_possible: false,
        }
    }

    /// The decoder of the next frame; `None` at the end.
    fn next_frame(&self) -> io::Result<Option<Decoder<'a, &'a [u8]>>> {
        let is_frame = self.rest.first_chunk().is_some_and(|bytes| {
            let number = u32::from_le_bytes(*bytes);
            number == DATA || number & !0xf == SKIPPED
        });
        if self.rest.is_empty() || (self.is_padding_possible && !is_frame) {
            return Ok(None);
        }
        let mut decoder = Decoder::with_buffer(self.rest)?.single_frame();
        decoder.window_log_max(self.max_window)?;
        Ok(Some(decoder))
    }
}

impl Read for ZstdFrames<'_> {
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
            self.rest = decoder.finish();
            self.is_padding_possible = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn content(data: &[u8]) -> Result<Vec<u8>, String> {
        let mut content = Vec::new();
        let mut frames = ZstdFrames::new(data, 27);
        let read = frames.read_to_end(&mut content);
        read.map(|_| content).map_err(|error| error.to_string())
    }

    fn frame(content: &[u8]) -> Vec<u8> {
        let mut encoder = zstd::stream::write::Encoder::new(Vec::new(), 1).unwrap();
        encoder.include_checksum(true).unwrap();
        io::Write::write_all(&mut encoder, content).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn reads_frames_with_trailing_data() {
        let [a, b] = [frame(b"abc"), frame(b"de")];
        let skipped = [&[0x5a, 0x2a, 0x4d, 0x18, 2, 0, 0, 0][..], b"xy"].concat();
        for (name, data, expected) in [
            ("nothing", vec![], &b""[..]),
            ("one frame", a.clone(), b"abc"),
            ("two frames", [a.clone(), b.clone()].concat(), b"abcde"),
            ("padding", [&a[..], &[0; 3]].concat(), b"abc"),
            (
                "a skipped frame",
                [a.clone(), skipped, b].concat(),
                b"abcde",
            ),
        ] {
            assert_eq!(content(&data).as_deref(), Ok(expected), "{name}");
        }
    }

    #[test]
    fn rejects_damaged_frames() {
        let whole = frame(b"abc");
        for length in 1..whole.len() {
            assert!(content(&whole[..length]).is_err(), "{length} bytes");
        }
        let mut wrong = whole.clone();
        *wrong.last_mut().unwrap() ^= 1;
        assert!(content(&wrong).is_err(), "checksum");
        let cut_after_another = [&whole[..], &whole[..whole.len() - 1]].concat();
        assert!(content(&cut_after_another).is_err());
    }
}
