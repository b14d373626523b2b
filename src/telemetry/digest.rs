//! The content digest: a hash of the recorded data, independent of encoding and compression.

use super::message::Message;
use super::table::channels;
use sha2::{Digest as _, Sha256};

/// Accumulates the content digest of a recording.
///
/// Each channel has a SHA-256 over its messages: sequence (u32) and time in ns (u64), the numbers as the 64 bits of
/// their doubles, then each text after its length in bytes (u64), all little-endian. The content digest is the SHA-256
/// over topic, a zero byte, number of messages (u64) and digest of each channel that has messages, in table order. The
/// digest depends only on the data, not on encoding, compression, chunks, or the order of messages of different
/// channels.
#[derive(Clone, Debug)]
pub struct ContentDigest {
    channels: Vec<(Sha256, u64)>,
}

impl Default for ContentDigest {
    fn default() -> Self {
        Self {
            channels: vec![(Sha256::new(), 0); channels().len()],
        }
    }
}

/// Appends to `bytes` the parts of a message that the digest covers.
pub fn append_content(message: &Message<'_>, bytes: &mut Vec<u8>) {
    bytes.extend_from_slice(&message.sequence.to_le_bytes());
    bytes.extend_from_slice(&message.time_ns.to_le_bytes());
    for number in message.numbers {
        bytes.extend_from_slice(&number.to_bits().to_le_bytes());
    }
    for text in message.texts {
        // Without the length, the end of one text could move to the beginning of the next unnoticed.
        bytes.extend_from_slice(&(text.len() as u64).to_le_bytes());
        bytes.extend_from_slice(text.as_bytes());
    }
}

impl ContentDigest {
    /// Adds the next message of its channel.
    pub fn update(&mut self, message: &Message<'_>) {
        let mut content = Vec::new();
        append_content(message, &mut content);
        self.absorb(message.channel, &content);
    }

    /// Adds the next message of a channel, as written by [`append_content`].
    pub fn absorb(&mut self, channel: usize, content: &[u8]) {
        let (hash, count) = &mut self.channels[channel];
        hash.update(content);
        *count += 1;
    }

    /// The digest in hexadecimal.
    pub fn finish(&self) -> String {
        let mut whole = Sha256::new();
        for (channel, (hash, count)) in channels().iter().zip(&self.channels) {
            // Whether a channel without messages is declared depends on the software that wrote the file.
            if *count > 0 {
                whole.update(channel.topic.as_bytes());
                whole.update([0]);
                whole.update(count.to_le_bytes());
                whole.update(hash.clone().finalize());
            }
        }
        format!("{:x}", whole.finalize())
    }
}
