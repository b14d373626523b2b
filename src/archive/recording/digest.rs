//! Compares the messages of a recording with the content digest in its end record.

use super::contradiction::Contradiction;
use super::file::Recording;
use super::missing::is_in_every_sample;
use crate::archive::format::{CONTENT_DIGEST, Entries, SAMPLE_PERIOD, STOP_TIME};
use crate::run::time::nanoseconds;
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
    /// Time of the last sample, ns; `None` without a topic that every sample has.
    last_sample_ns: Option<u64>,
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
            last_sample_ns: None,
            content: Vec::new(),
        })
    }

    /// Takes the next message, and the number of earlier ones of its topic.
    pub(super) fn take(&mut self, message: &Message<'_>, earlier: u64) {
        if is_in_every_sample(message.topic()) {
            self.last_sample_ns = Some(message.time_ns);
        }
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

    /// What in an end record contradicts these messages.
    pub(super) fn contradiction(&self, end: &Entries) -> Option<Contradiction> {
        let stated = end.get(CONTENT_DIGEST);
        let mut digests = [Some(&self.digest), self.numbered.as_ref()]
            .into_iter()
            .flatten();
        if !digests.any(|digest| Some(&digest.finish()) == stated) {
            return Some(Contradiction::Digest);
        }
        let stop_time: f64 = end.get(STOP_TIME)?.parse().ok()?;
        let last_ns = self.last_sample_ns?;
        // The next sample would have come after the stop, which is known to more digits than nanoseconds.
        let possible = last_ns..=last_ns.saturating_add(self.period_ns.get());
        (!possible.contains(&nanoseconds(stop_time))).then_some(Contradiction::StopTime)
    }
}
