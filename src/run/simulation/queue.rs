//! Queue of the events, nutation cycles and impacts of a step, in time order; [`Queue::pop`] completes them.

use super::event::{Event, EventKind};
use super::record::Record;
use super::tally::Tally;
use crate::physics::dynamics::Motion;
use crate::run::time::nanoseconds;
use std::collections::VecDeque;

/// Pending records in time order, with counts of the emitted ones.
#[derive(Default)]
pub(super) struct Queue {
    /// Events without index, impacts without index and bounce.
    pending: VecDeque<Record>,
    /// Number of emitted events.
    pub(super) events: u32,
    /// Number of emitted nutation cycles.
    pub(super) cycles: u32,
    /// Number of emitted impacts.
    pub(super) impacts: u32,
    /// Emitted impacts since the peg left the table.
    bounces: u32,
    /// Time of the first emitted inversion of a tippe top, s.
    pub(super) inversion: Option<f64>,
}

impl Queue {
    pub(super) fn push(&mut self, pending: Record) {
        self.pending.push_back(pending);
    }

    pub(super) fn extend(&mut self, pending: impl IntoIterator<Item = Record>) {
        self.pending.extend(pending);
    }

    /// Discards records after a time, s.
    pub(super) fn discard_after(&mut self, time: f64) {
        let limit = nanoseconds(time);
        self.pending.retain(|pending| pending.time_ns() <= limit);
    }

    /// Time of the next record, ns.
    pub(super) fn next_time_ns(&self) -> Option<u64> {
        self.pending.front().map(Record::time_ns)
    }

    /// Removes and returns the next record.
    pub(super) fn pop(&mut self) -> Option<Record> {
        let mut record = self.pending.pop_front()?;
        match &mut record {
            Record::Event(event) => {
                if event.kind == EventKind::Landing {
                    self.bounces = 0;
                }
                event.index = self.events;
                self.events += 1;
                if event.kind == EventKind::Inverts {
                    self.inversion.get_or_insert(event.time);
                }
            }
            Record::Impact(impact) => {
                impact.index = self.impacts;
                self.impacts += 1;
                self.bounces += 1;
                impact.bounce = self.bounces;
            }
            Record::Nutation(_) => self.cycles += 1,
            Record::Sample(_) => {}
        }
        Some(record)
    }

    /// Counts all records without emitting them. Returns the time, s, and the motion of the last event.
    pub(super) fn count_all(&mut self, tally: &mut Tally) -> Option<(f64, Motion)> {
        let mut last = None;
        for pending in self.pending.drain(..) {
            match pending {
                Record::Event(event) => {
                    self.events += 1;
                    if event.kind == EventKind::Inverts {
                        self.inversion.get_or_insert(event.time);
                    }
                    tally.count(event.kind, event.time);
                    last = Some((event.time, event.motion));
                }
                Record::Nutation(_) => self.cycles += 1,
                Record::Impact(_) => self.impacts += 1,
                Record::Sample(_) => {}
            }
        }
        last
    }
}

/// An event at a time, s, for the queue.
pub(super) fn event_at(kind: EventKind, time: f64, motion: Motion) -> Record {
    Record::Event(Box::new(Event {
        kind,
        time,
        time_ns: nanoseconds(time),
        index: 0,
        motion,
    }))
}
