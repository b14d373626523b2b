//! The records of a section: its messages, and what is wrong with the others.

use super::position::Position;
use super::{Loader, MAX_GROWTH, MIN_CONTENT};
use crate::archive::container::loss::Loss;
use crate::archive::container::record::{is_specified, parse};
use crate::archive::container::section::{FileSection, InnerRecord, MessageRecord, record_at};
use mcap::records::op;
use std::mem;
use std::ops::Range;

impl Loader<'_> {
    /// Calls `take` with time and place of each selected message among the records of a section, and reports the others.
    pub(super) fn scan_records(
        &mut self,
        section: &FileSection,
        records: &[u8],
        mut take: impl FnMut(u64, Range<usize>),
    ) {
        let mut position = 0;
        while let Some(next) = record_at(records, position) {
            let (record, end) = match next {
                Ok(found) => found,
                Err(reason) => return self.report_loss(section, reason.to_owned()),
            };
            let place = mem::replace(&mut position, end)..end;
            if record.opcode != op::MESSAGE {
                self.check_definition(section, &place, record);
                continue;
            }
            let Some(message) = MessageRecord::parse(&record) else {
                self.report_lost_record(
                    section,
                    &place,
                    None,
                    "truncated message header".to_owned(),
                );
                continue;
            };
            // Windows read sections again.
            if self.is_first_pass {
                self.tally
                    .count_message(message.channel_id, message.log_time);
            }
            let time = match &mut self.stamps {
                Some(stamps) => stamps.time(self.recording, &message),
                None => message.log_time,
            };
            let Some(channel) = self.recording.layout.channels.position(message.channel_id) else {
                let reason = format!("undefined channel {}", message.channel_id);
                self.report_lost_record(section, &place, Some(time), reason);
                continue;
            };
            if self.is_redefined(channel, section, place.start) {
                let reason = format!("channel {} is ambiguous here", message.channel_id);
                self.report_lost_record(section, &place, Some(time), reason);
                continue;
            }
            if self.is_wanted[channel] && self.selection.wants_span((time, time)) {
                take(time, place);
            }
        }
    }

    /// Checks a record of a section that is not a message.
    fn check_definition(
        &mut self,
        section: &FileSection,
        place: &Range<usize>,
        record: InnerRecord<'_>,
    ) {
        if !is_specified(record.opcode) {
            return;
        }
        if !matches!(record.opcode, op::SCHEMA | op::CHANNEL) {
            let reason = format!("a record with the opcode {:#04x} in a chunk", record.opcode);
            return self.report_lost_record(section, place, None, reason);
        }
        // Other readers fail at an invalid definition, whether it is used or not.
        let Ok(parsed) = parse(record.opcode, record.body) else {
            return self.report_lost_record(section, place, None, "an invalid record".to_owned());
        };
        let channels = &self.recording.layout.channels;
        if let Some(conflict) = channels.conflict(&parsed) {
            let position = Position {
                section: section.offset,
                start: place.start,
            };
            for channel in channels.affected_by(conflict) {
                let first = self.redefined.entry(channel).or_insert(position);
                *first = position.min(*first);
            }
            self.report_lost_record(section, place, None, conflict.to_string());
        }
    }

    /// Whether the channel has a second definition before a place in a section. Which one a message follows is
    /// uncertain, because the writer may not have noticed that the id was in use.
    fn is_redefined(&self, channel: usize, section: &FileSection, start: usize) -> bool {
        let position = Position {
            section: section.offset,
            start,
        };
        self.redefined
            .get(&channel)
            .is_some_and(|first| *first < position)
    }

    /// Reports the loss of a record of a section. A record within a chunk has no place of its own in the file, so
    /// the place of the chunk is reported.
    fn report_lost_record(
        &mut self,
        section: &FileSection,
        place: &Range<usize>,
        time_ns: Option<u64>,
        reason: String,
    ) {
        if section.is_chunk {
            return self.report_loss(section, reason);
        }
        // Windows read sections again.
        if self.is_first_pass {
            self.losses.push_adjacent(Loss {
                offset: section.offset + place.start as u64,
                length: place.len() as u64,
                from_ns: time_ns,
                to_ns: time_ns,
                is_unread: false,
                is_suspect: false,
                reason,
            });
        }
    }

    /// Reports a loss in a section, at most one per section.
    pub(super) fn report_loss(&mut self, section: &FileSection, reason: String) {
        if self.lost.insert(section.offset) {
            self.losses.push(Loss {
                offset: section.offset,
                length: section.length,
                from_ns: section.span.map(|(from, _)| from),
                to_ns: section.span.map(|(_, to)| to),
                is_unread: false,
                is_suspect: false,
                reason,
            });
        }
    }

    /// Reports that the file is not read from this section on, once.
    pub(super) fn report_rest(&mut self, section: &FileSection) {
        if self.losses.list().iter().any(|loss| loss.is_unread) {
            return;
        }
        self.losses.push(Loss {
            offset: section.offset,
            length: self.recording.size() - section.offset,
            is_unread: true,
            reason: format!(
                "the content before it already exceeds the limit of {} MiB and {MAX_GROWTH} times the file size",
                MIN_CONTENT >> 20
            ),
            ..Loss::default()
        });
    }
}
