//! Sets of messages, compared independently of their order.

use crate::archive::recording::{FileChannel, Undecoded};
use mcap::Message;
use mcap::records::MessageHeader;
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;

/// Messages of each channel: their number and a digest.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Fingerprint {
    channels: BTreeMap<u16, ChannelFingerprint>,
}

/// Number of messages of a channel, and a digest that doesn't depend on their order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct ChannelFingerprint {
    pub(super) messages: u64,
    /// Sum of the messages' SHA-256, truncated to 128 bits.
    digest: u128,
}

impl ChannelFingerprint {
    /// Adds a message's SHA-256.
    fn add(&mut self, digest: Sha256) {
        let mut half = [0; 16];
        half.copy_from_slice(&digest.finalize()[..16]);
        self.messages += 1;
        // A sum, unlike an exclusive or, counts messages that are repeated.
        self.digest = self.digest.wrapping_add(u128::from_le_bytes(half));
    }

    /// Adds the data of a message, whatever its head is.
    pub(super) fn add_data(&mut self, data: &[u8]) {
        self.add(Sha256::new_with_prefix(data));
    }
}

impl Fingerprint {
    pub(super) fn add(&mut self, header: &MessageHeader, data: &[u8]) {
        let mut hasher = Sha256::new();
        hasher.update(header.sequence.to_le_bytes());
        hasher.update(header.log_time.to_le_bytes());
        hasher.update(header.publish_time.to_le_bytes());
        hasher.update(data);
        self.channels
            .entry(header.channel_id)
            .or_default()
            .add(hasher);
    }

    pub(super) fn add_undecoded(&mut self, message: &Undecoded<'_>) {
        let header = MessageHeader {
            channel_id: message.channel.id,
            sequence: message.sequence,
            log_time: message.log_time,
            publish_time: message.publish_time,
        };
        self.add(&header, message.data);
    }

    pub(super) fn add_message(&mut self, message: &Message<'_>) {
        let header = MessageHeader {
            channel_id: message.channel.id,
            sequence: message.sequence,
            log_time: message.log_time,
            publish_time: message.publish_time,
        };
        self.add(&header, &message.data);
    }

    /// The first of the channels whose messages differ, with its fingerprints in both sets.
    pub(super) fn first_difference<'c>(
        &self,
        other: &Self,
        channels: &'c [FileChannel],
    ) -> Option<(&'c FileChannel, [ChannelFingerprint; 2])> {
        channels.iter().find_map(|channel| {
            let both =
                [self, other].map(|set| set.channels.get(&channel.id).copied().unwrap_or_default());
            (both[0] != both[1]).then_some((channel, both))
        })
    }
}
