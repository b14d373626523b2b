//! Queue of the events, nutation cycles and impacts of a step, in time order; [`Queue::pop`] completes them.

use super::event::{Event, EventKind};
use super::record::Record;
use super::tally::Tally;
use crate::physics::dynamics::Motion;
use crate::run::time::nanoseconds;
use std::collections::VecDeque;

/// A motion at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct TimedMotion {
    /// Time, s.
    pub time: f64,
    pub motion: Motion,
}

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

    /// Adds an event at a time, s.
    pub(super) fn push_event(&mut self, kind: EventKind, time: f64, motion: Motion) {
        self.push(Record::Event(Box::new(Event {
            kind,
            time,
            time_ns: nanoseconds(time),
            // Set when the event is emitted: a later one may be discarded.
            index: 0,
            motion,
        })));
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
                // The impact that ends a flight is emitted before its landing, so it is still one of its bounces.
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

    /// Counts all records without emitting them. Returns the motion at the last event.
    pub(super) fn count_all(&mut self, tally: &mut Tally) -> Option<TimedMotion> {
        let mut last = None;
        for pending in self.pending.drain(..) {
            match pending {
                Record::Event(event) => {
                    self.events += 1;
                    if event.kind == EventKind::Inverts {
                        self.inversion.get_or_insert(event.time);
                    }
                    tally.record(event.kind, event.time);
                    last = Some(TimedMotion {
                        time: event.time,
                        motion: event.motion,
                    });
                }
                Record::Nutation(_) => self.cycles += 1,
                Record::Impact(_) => self.impacts += 1,
                Record::Sample(_) => {}
            }
        }
        last
    }
}
