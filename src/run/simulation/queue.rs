//! Queue of the events of a step, in time order.

use super::event::{Event, EventKind};
use super::free::ImpactRecord;
use super::nutation::NutationCycle;
use super::record::Record;
use super::tally::Tally;
use crate::physics::dynamics::Motion;
use crate::physics::top::Top;
use std::collections::VecDeque;

/// A pending record; times in s.
pub(super) enum Pending {
    Event(EventKind, f64, Motion),
    Nutation(NutationCycle),
    Impact(ImpactRecord),
}

impl Pending {
    fn time_ns(&self) -> u64 {
        match self {
            Self::Event(_, time, _) => to_nanoseconds(*time),
            Self::Nutation(cycle) => cycle.time_ns,
            Self::Impact(landing) => landing.time_ns,
        }
    }
}

/// Pending records in time order, with counts of the emitted ones.
#[derive(Default)]
pub(super) struct Queue {
    pending: VecDeque<Pending>,
    /// Number of emitted events.
    pub(super) events: u32,
    /// Number of emitted nutation cycles.
    pub(super) cycles: u32,
    /// Number of emitted impacts.
    pub(super) impacts: u32,
    /// Emitted impacts since the peg left the table.
    bounces: u32,
    /// Time at which a tippe top inverted, s.
    pub(super) inversion: Option<f64>,
}

impl Queue {
    pub(super) fn push(&mut self, pending: Pending) {
        self.pending.push_back(pending);
    }

    pub(super) fn extend(&mut self, pending: impl IntoIterator<Item = Pending>) {
        self.pending.extend(pending);
    }

    /// Records the first inversion of a tippe top, at this time, s.
    pub(super) fn record_inversion(&mut self, time: f64) {
        self.inversion.get_or_insert(time);
    }

    /// Discards records after a time, s.
    pub(super) fn discard_after(&mut self, time: f64) {
        let limit = to_nanoseconds(time);
        self.pending.retain(|pending| pending.time_ns() <= limit);
    }

    /// Time of the next record, ns.
    pub(super) fn next_time_ns(&self) -> Option<u64> {
        self.pending.front().map(Pending::time_ns)
    }

    /// Removes and returns the next record.
    pub(super) fn pop(&mut self, top: &Top) -> Option<Record> {
        Some(match self.pending.pop_front()? {
            Pending::Event(kind, time, motion) => {
                let mut description = kind.describe(top, &motion);
                if kind == EventKind::Landing {
                    description += &match std::mem::take(&mut self.bounces) {
                        1 => " After 1 impact.".to_owned(),
                        bounces => format!(" After {bounces} impacts."),
                    };
                }
                let index = self.events;
                self.events += 1;
                Record::Event(Box::new(Event {
                    kind,
                    time,
                    time_ns: to_nanoseconds(time),
                    index,
                    motion,
                    description,
                }))
            }
            Pending::Impact(impact) => {
                let index = self.impacts;
                self.impacts += 1;
                self.bounces += 1;
                Record::Impact(Box::new(ImpactRecord {
                    index,
                    bounce: self.bounces,
                    ..impact
                }))
            }
            Pending::Nutation(cycle) => {
                self.cycles += 1;
                Record::Nutation(Box::new(cycle))
            }
        })
    }

    /// Counts all records without emitting them. Returns the time, s, and the motion of the last event.
    pub(super) fn count_all(&mut self, tally: &mut Tally) -> Option<(f64, Motion)> {
        let mut last = None;
        for pending in self.pending.drain(..) {
            match pending {
                Pending::Event(kind, time, motion) => {
                    self.events += 1;
                    tally.count(kind, time);
                    last = Some((time, motion));
                }
                Pending::Nutation(_) => self.cycles += 1,
                Pending::Impact(_) => self.impacts += 1,
            }
        }
        last
    }
}

/// The nearest whole number of nanoseconds to a time that is not negative.
pub(super) fn to_nanoseconds(time: f64) -> u64 {
    (time * 1e9).round() as u64
}
