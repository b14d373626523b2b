//! Compares the messages of a recording with the content digest in its end record.

use super::file::Recording;
use crate::archive::format::{CONTENT_DIGEST, Entries, SAMPLE_PERIOD};
use crate::telemetry::Message;
use crate::telemetry::digest::{ContentDigest, append_content};
use std::num::NonZeroU64;

/// The content digest of the messages that have been read, in order of time.
#[derive(Debug)]
pub(super) struct DigestCheck {
    /// Time between samples, ns.
    period_ns: NonZeroU64,
    digest: ContentDigest,
    /// The digest with the sequence numbers of toprise, from the first message on that has another: other software may
    /// number messages anew, which changes none of the data.
    numbered: Option<ContentDigest>,
    /// Memory for the content of a message.
    content: Vec<u8>,
}

impl DigestCheck {
    /// A check of all messages; `None` if other telemetry was recorded, whose digest covers other fields.
    pub(super) fn new(recording: &Recording) -> Option<Self> {
        if !recording.has_this_telemetry() {
            return None;
        }
        let period_ns = recording.run()?.get(SAMPLE_PERIOD)?.parse().ok()?;
        Some(Self {
            period_ns,
            digest: ContentDigest::default(),
            numbered: None,
            content: Vec::new(),
        })
    }

    /// Takes the next message, and the number of earlier ones of its topic.
    pub(super) fn take(&mut self, message: &Message<'_>, earlier: u64) {
        let number = self.number(message, earlier);
        if self.numbered.is_none() && number != message.sequence {
            self.numbered = Some(self.digest.clone());
        }
        if let Some(numbered) = &mut self.numbered {
            let original = Message {
                sequence: number,
                ..*message
            };
            self.content.clear();
            append_content(&original, &mut self.content);
            numbered.absorb(message.channel, &self.content);
        }
        self.content.clear();
        append_content(message, &mut self.content);
        self.digest.absorb(message.channel, &self.content);
    }

    /// The sequence number with which toprise records a message. Those of samples follow from the time, because some
    /// topics don't have every sample.
    fn number(&self, message: &Message<'_>, earlier: u64) -> u32 {
        let number = if message.topic().info().is_sampled {
            // The last sample of a run may come before its time.
            message.time_ns.div_ceil(self.period_ns.get())
        } else {
            earlier
        };
        number as u32
    }

    /// Whether an end record has the digest of these messages.
    pub(super) fn is_of(&self, end: &Entries) -> bool {
        // Without a digest there is nothing to contradict.
        let Some(stated) = end.get(CONTENT_DIGEST) else {
            return true;
        };
        let mut digests = [Some(&self.digest), self.numbered.as_ref()]
            .into_iter()
            .flatten();
        digests.any(|digest| digest.finish() == *stated)
    }
}
