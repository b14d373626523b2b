//! The clock of a recording's messages.
//!
//! toprise logs each message at the time of its stamp. Software that plays a recording and records it again logs the
//! messages at other times, but keeps what is in them: they are read by their stamps.

use super::file::Recording;
use crate::archive::container::section::{Buffers, FileSection, MessageRecord, record_at};
use crate::run::time::seconds_and_nanoseconds;
use crate::telemetry::encoding::{Decoder, Row};
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt;

/// Numbers of sections, spread over the file, and of messages in each that decide on the clock. A few times that are wrong
/// are damage, not a clock.
const SECTIONS: usize = 8;
const MESSAGES: usize = 12;

/// Log times that are not the time stamps of the messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Relogged {
    /// Log time minus time stamp of the first message in which they differ, ns.
    pub offset_ns: i64,
}

impl fmt::Display for Relogged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (seconds, nanoseconds) = seconds_and_nanoseconds(self.offset_ns.unsigned_abs());
        let relation = if self.offset_ns < 0 {
            "before"
        } else {
            "after"
        };
        write!(f, "{seconds}.{nanoseconds:09} s {relation} time stamps")
    }
}

impl Relogged {
    /// What it is and what follows, for reports of the recording.
    pub(crate) fn fact(self) -> String {
        format!("{self} (the first that differs); messages are read by their stamps")
    }
}

impl Recording {
    /// How log times differ from the time stamps of the messages, if they do. Messages are then read by their stamps.
    pub fn relogged(&self) -> Option<Relogged> {
        let offset = self.log_offset_ns.get_or_init(|| find_offset(self));
        offset.map(|offset_ns| Relogged { offset_ns })
    }
}

/// The first difference of a log time from its stamp, ns, if most messages of the table have one. A single message is no
/// clock.
fn find_offset(recording: &Recording) -> Option<i64> {
    let offsets = sample_offsets(recording);
    let mut differing = offsets.iter().filter(|offset| **offset != 0);
    let first = differing.next()?;
    let others = differing.count();
    let is_clock = others > 0 && 2 * (1 + others) > offsets.len();
    i64::try_from(*first).ok().filter(|_| is_clock)
}

/// Log time minus stamp of messages of the table, ns: of some in sections that are spread over the file, or else in the
/// first that has any.
fn sample_offsets(recording: &Recording) -> Vec<i128> {
    let mut stamps = Stamps::new(recording, Relogged { offset_ns: 0 });
    if stamps.decoders.iter().all(Option::is_none) {
        return Vec::new();
    }
    let mut buffers = Buffers::default();
    let mut offsets_of = |section: &FileSection| {
        if section.load(&recording.source, &mut buffers).is_err() {
            return Vec::new();
        }
        stamps.offsets(recording, &buffers.records)
    };
    let sections = &recording.layout.sections;
    let stride = sections.len().div_ceil(SECTIONS).max(1);
    let spread: Vec<i128> = sections
        .iter()
        .step_by(stride)
        .flat_map(&mut offsets_of)
        .collect();
    if !spread.is_empty() {
        return spread;
    }
    let mut all = sections.iter().map(offsets_of);
    all.find(|offsets| !offsets.is_empty()).unwrap_or_default()
}

/// Reads the time stamps of messages that were logged at other times.
#[derive(Debug)]
pub(super) struct Stamps {
    relogged: Relogged,
    /// The decoder of each of the file's channels that is in the table.
    decoders: Vec<Option<Decoder>>,
    row: Row,
}

impl Stamps {
    pub(super) fn new(recording: &Recording, relogged: Relogged) -> Self {
        let channels = recording.channels().iter();
        Self {
            relogged,
            decoders: channels.map(|channel| channel.decoder()?.ok()).collect(),
            row: Row::default(),
        }
    }

    /// The time by which a message is read, ns: its stamp, or its log time on the clock of the stamps if it has none.
    pub(super) fn time(&mut self, recording: &Recording, message: &MessageRecord<'_>) -> u64 {
        self.decode(recording, message).unwrap_or_else(|| {
            message
                .log_time
                .saturating_add_signed(self.relogged.offset_ns.saturating_neg())
        })
    }

    /// Log time minus stamp of the first messages of the table among the records of a section, ns.
    fn offsets(&mut self, recording: &Recording, records: &[u8]) -> Vec<i128> {
        let mut offsets = Vec::new();
        let mut position = 0;
        while let Some(Ok((record, end))) = record_at(records, position)
            && offsets.len() < MESSAGES
        {
            position = end;
            if let Some(message) = MessageRecord::parse(&record)
                && let Some(stamp) = self.decode(recording, &message)
            {
                offsets.push(i128::from(message.log_time) - i128::from(stamp));
            }
        }
        offsets
    }

    fn decode(&mut self, recording: &Recording, message: &MessageRecord<'_>) -> Option<u64> {
        let channel = recording.layout.channels.position(message.channel_id)?;
        let decoder = self.decoders[channel].as_ref()?;
        decoder.decode(message.data, &mut self.row).ok()?;
        Some(self.row.time_ns)
    }
}
