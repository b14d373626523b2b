//! Reruns a scenario and yields its encoded messages.

use crate::archive::format::{CONTENT_DIGEST, Entries, end_entries};
use crate::archive::writer::{Header, RunEncoder};
use crate::telemetry::digest::ContentDigest;
use crate::telemetry::{RunError, RunMessages};

/// An expected message.
pub(super) struct Expected {
    /// Index of its channel.
    pub(super) channel: usize,
    pub(super) sequence: u32,
    pub(super) time_ns: u64,
    pub(super) data: Vec<u8>,
    /// Numbers and texts of a message of the table.
    pub(super) values: Option<(Vec<f64>, Vec<String>)>,
}

/// A run that is simulated again.
pub(super) struct Rerun<'h> {
    pub(super) header: &'h Header,
    run: RunMessages,
    encoder: RunEncoder,
    digest: ContentDigest,
}

impl<'h> Rerun<'h> {
    pub(super) fn new(run: RunMessages, header: &'h Header) -> Self {
        // Here a channel's id is its index in the header.
        let ids: Vec<u16> = (0..header.channels.len() as u16).collect();
        Self {
            encoder: RunEncoder::new(header, &ids),
            header,
            run,
            digest: ContentDigest::default(),
        }
    }

    /// Simulates one record and passes its messages to `take`; returns its time in ns, or `None` at the end. An error
    /// ended the original run, too.
    pub(super) fn next(&mut self, mut take: impl FnMut(Expected)) -> Option<u64> {
        let (encoder, digest) = (&mut self.encoder, &mut self.digest);
        let record = self.run.next(|message| {
            encoder.batch.clear();
            encoder.encode(message);
            digest.update(message);
            // The views follow the message.
            let mut values = Some((message.numbers.to_vec(), message.texts.to_vec()));
            for (header, data) in encoder.batch.messages() {
                take(Expected {
                    channel: usize::from(header.channel_id),
                    sequence: header.sequence,
                    time_ns: header.log_time,
                    data: data.to_vec(),
                    values: values.take(),
                });
            }
            Ok::<(), RunError>(())
        });
        Some(record?.ok()?.time_ns())
    }

    /// The entries of the end record, once the run has ended.
    pub(super) fn end(self) -> Entries {
        let mut entries = end_entries(&self.run.end());
        entries.insert(CONTENT_DIGEST.to_owned(), self.digest.finish());
        entries
    }
}
